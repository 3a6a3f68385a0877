"""Trajectory -> Observation, in the generalised coordinates of the engine."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.laws.law import term_names
from granular_contact.mechanics import mechanism
from granular_contact.mechanics.accuracy import accuracy_warnings, greatest_energy
from granular_contact.mechanics.drive_error import drive_warnings
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.strains import stress_numbers, yielding
from granular_contact.mechanics.system import System, Trajectory
from granular_contact.mechanics.wheels import add_wheels, wheel_histories
from granular_contact.results import energy
from granular_contact.results.accuracy import AccuracyWarning
from granular_contact.results.interpolation import Track, rates
from granular_contact.results.limits import Reach
from granular_contact.results.observation import Observation, pictures
from granular_contact.results.series import Series
from granular_contact.results.stopping import Stop, Touch, find_rest, find_stop, find_touch, find_turn
from granular_contact.scene.bed import Bed
from granular_contact.scene.types import Joint, Vector

if TYPE_CHECKING:
    from granular_contact.sand.history import LoadHistory

STATIONS = 16  # size of a body over the distance of points on its sides where the surface is not level


def observe(system: System, trajectory: Trajectory) -> Observation:
    """Observation of a run, from which its results are made."""
    motion = Kinematics(system, trajectory)
    with np.errstate(over="ignore", invalid="ignore"):  # as in a run that diverged
        depths, forces = depths_by_body(motion), forces_of(trajectory)
        fields = observed(motion, forces, depths, all_depths(motion, depths))
        fields["motion"] |= mechanism.body_columns(motion, forces, depths)
        add_wheels(fields, wheel_histories(motion, forces))
        return Observation(**fields)


def forces_of(trajectory: Trajectory) -> dict[str, Vector]:
    """Wrench of the medium on each body: force (N) and moment (N m) about the origin, (n, 3), in space (n, 6)."""
    load = trajectory.load
    return {} if load is None else {name: load.bodies[:, i] for i, name in enumerate(load.body_names)}


def depths_by_body(motion: Kinematics) -> dict[str, list[Track]]:
    """Depth (m) of every corner and node that the medium may touch, by body; negative above the surface.

    A surface that is not level can touch a body between its corners; then points between them are added.
    """
    tracks: dict[str, list[Track]] = {}
    bed = motion.scene.bed
    if bed is None:
        return tracks
    for name, handle in motion.system.rigid.items():
        for shape in (shape for shape in handle.body.shapes if shape.in_sand):
            points = shape.points if bed.level else _between(shape.points)
            of_shape = map(Track, *_depth(bed, *motion.positions(name, np.asarray(points)), shape.drop))
            tracks[name] = [*tracks.get(name, []), *of_shape]
    q, v = motion.trajectory.q, motion.trajectory.v
    for name in motion.system.links:
        tracks[name] = [_depth(bed, q[:, node[:2]], v[:, node[:2]]) for node in motion.nodes(name)]
    return tracks


def _between(corners: Vector) -> Vector:
    """Corners (k, 2) of a line with points between them, no farther apart than a share of its size."""
    spacing = float(np.linalg.norm(np.ptp(corners, axis=0))) / STATIONS
    counts = [math.ceil(float(np.linalg.norm(b - a)) / spacing - 1e-9) for a, b in pairwise(corners)]
    sides = [np.linspace(*ends, count, endpoint=False) for ends, count in zip(pairwise(corners), counts, strict=True)]
    return np.concatenate([*sides, corners[-1:]])


def _depth(bed: Bed, position: Vector, velocity: Vector, drop: float = 0.0) -> Track:
    """Depth of a point from its positions and velocities (..., 2); drop (m): how much lower the body reaches there."""
    x, y = position[..., 0], position[..., 1]
    slope = 0.0 if bed.level else bed.slope_at(x)
    return Track(bed.height(x) - y + drop, slope * velocity[..., 0] - velocity[..., 1])


def all_depths(motion: Kinematics, by_body: dict[str, list[Track]]) -> list[Track]:
    """Depths of all points, and of the load's stations where these are deeper, as on a bent link."""
    points = [track for tracks in by_body.values() for track in tracks]
    load, time = motion.trajectory.load, motion.trajectory.time
    if load is None or not len(load.depth):
        return points
    known = np.max([track.values for track in points], axis=0) if points else np.full(len(time), -np.inf)
    deeper = load.depth > known + 1e-9
    if not deeper.any():
        return points
    # Cubic interpolation only where stations are the deepest at both ends of a step; elsewhere other points are.
    flat = ~(deeper & np.roll(deeper, 1) & np.roll(deeper, -1))
    slopes = rates(time, load.depth)
    slopes[flat] = 0.0
    return [*points, Track(np.where(deeper, load.depth, known), slopes)]


def observed(
    motion: Kinematics, forces: dict[str, Vector], by_body: dict[str, list[Track]], depths: list[Track]
) -> dict[str, Any]:
    """Fields of an observation, by name, that are computed alike in the plane and in space."""
    trajectory, scene, load = motion.engine, motion.scene, motion.trajectory.load
    driven, links, system = mechanism.drive_forces(motion), motion.system.links, motion.system
    terms = term_names(scene.media) if load is None or not scene.media else load.term_names
    strains, time = motion.strains(), trajectory.time
    strain_columns: Series = {}
    for name, strain in strains.items():
        strain_columns |= strain.columns(name)
    no_forces = np.zeros((len(trajectory.time), len(terms), 6 if scene.in_space else 3))
    numbers = key_numbers(motion, driven, by_body, depths)
    overloads = mechanism.overloads(scene, numbers.get("drives", {}))
    return {
        "scene": scene,
        "status": trajectory.status,
        "cost": trajectory.cost,
        "time": trajectory.time,
        "motion": mechanism.joint_columns(motion) | mechanism.drive_columns(scene, driven) | strain_columns,
        "mean_rate": None if scene.pivot is None else motion.mean_rate[0],
        "tip": motion.position(*scene.tip)[0],
        "deflection": motion.bend(list(links)[-1]) if links else None,
        "depths": depths,
        "terms": terms,
        "term_forces": no_forces if load is None else load.terms,
        "moments_about": motion.common_center[0] if scene.pivot is None else scene.pivot.parent_point,
        "body_forces": forces,
        "energies": energies(motion, driven),
        "stop": lambda touch: stop(motion, touch),
        "outlines": motion.outlines,
        "pictures": lambda at: pictures(lambda sampled: type(motion)(system, sampled).outlines, trajectory, at),
        "reach": _reach(motion),
        "more": numbers | stress_numbers(strains, time),
        "accuracy": accuracy(motion, driven),
        "notices": (*trajectory.notices, *yielding(strains, time), *overloads),
    }


def _reach(motion: Kinematics) -> Reach | None:
    """Extremes of the immersed parts over the run; None without a granular load."""
    load = motion.trajectory.load
    if load is None:
        return None
    axes = load.reached.shape[1] // 2
    return Reach(
        speed=float(load.speed.max()),
        depth=float(load.depth.max()),
        lowest=float(load.lowest.min()),
        least=tuple(load.reached[:, :axes].min(axis=0).tolist()),
        greatest=tuple(load.reached[:, axes:].max(axis=0).tolist()),
        sizes=tuple(sorted({(kind, width) for _, kind, width in load.immersed})),
    )


def energies(motion: Kinematics, driven: mechanism.Driven) -> Series:
    """Columns of stored energies, and of the work done since the start."""
    t, scene = motion.trajectory, motion.scene
    kinetic = 0.5 * np.sum((t.v @ t.mass) * t.v, axis=1)
    gravity = scene.gravity * motion.lifted()
    elastic, damping, work = (np.zeros_like(kinetic) for _ in range(3))
    links = motion.elastic()
    for stored, dissipated in links:
        elastic += stored
        damping -= energy.accumulate(t.time, dissipated)
    joints = mechanism.joint_energies(motion, driven)
    if t.load is not None:
        work, at_floor = medium_works(motion, t.load)
        if scene.bed is not None and scene.bed.floor is not None:
            joints["floor_work_J"] = at_floor
    return energy.columns(kinetic, gravity - gravity[0], elastic if links else None, work, damping, joints)


def medium_works(motion: Kinematics, load: LoadHistory) -> tuple[Vector, Vector]:
    """Work (n,) J of all media and of the floor since the start, corrected by the motion (see `sand.work`).

    The correction of a step in which the floor was touched goes to the floor, which is far stiffer.
    """
    if not motion.scene.media:
        return load.work, load.floor_work
    correction = motion.work_beyond
    steps = np.diff(correction, prepend=0.0)
    touched = np.diff(load.floor_work, prepend=0.0) != 0.0
    at_floor = np.cumsum(np.where(touched, steps, 0.0))
    return load.work + correction - at_floor, load.floor_work + at_floor


# ---- stopping ----


def stop(motion: Kinematics, touch: Touch) -> Stop | None:
    """Stop of the mechanism after the touch; None where it did not stop, or has drives."""
    scene, time = motion.scene, motion.trajectory.time
    if _never_stops(motion):
        return None
    if scene.pendulum is not None:
        return _stop_about(motion, scene.pendulum, slice(touch.index, None))
    instant = find_rest(time, motion.speeds, touch.index, scene.solver.rest_speed_m_s, scene.solver.rest_time_s)
    if instant is None:
        return None
    angle = None
    if len(scene.bodies) == 1 and not scene.in_space:
        angle = float(np.interp(instant, time, -motion.angle(*scene.tip)[0]))
    return Stop(instant, angle, None)


def _never_stops(motion: Kinematics) -> bool:
    """Return whether a stop has no meaning: the mechanism has drives, or did not move."""
    return bool(motion.scene.drives) or motion.path_length <= motion.scene.least_path


def _stop_about(motion: Kinematics, pivot: Joint, after: slice) -> Stop | None:
    """Stop of a pendulum: first zero of its mean rate in the rows `after`, with the pivot's angle there."""
    rate, inertia = motion.mean_rate
    moment, load = motion.weight_moment(), motion.trajectory.load
    if load is not None:
        fx, fy, moment_at_origin = load.terms.sum(axis=1).T
        x, y = pivot.parent_point
        moment = moment + moment_at_origin - (x * fy - y * fx)
    angle, angle_rate = motion.angle(pivot.child, pivot.child_point)
    histories = motion.trajectory.time, rate, -moment / inertia, -angle, -angle_rate
    return find_stop(*(values[after] for values in histories))


def _penetration_time(motion: Kinematics, depths: list[Track]) -> float | None:
    """Time (s) from touch to the first zero of the vertical velocity of the lower end of a falling body."""
    scene, time = motion.scene, motion.trajectory.time
    if _never_stops(motion) or scene.floating is None:
        return None
    touch = find_touch(time, depths)
    if touch is None:
        return None
    falling = motion.position(*scene.tip)[1][:, -1]
    angle, rate = (0.0 * falling, 0.0 * falling) if scene.in_space else motion.angle(*scene.tip)
    histories = time, falling, -angle, -rate
    turn = find_turn(*(values[touch.index :] for values in histories))
    return None if turn is None else turn - touch.time


# ---- key numbers and warnings ----


def key_numbers(
    motion: Kinematics, driven: mechanism.Driven, by_body: dict[str, list[Track]], depths: list[Track]
) -> dict[str, Any]:
    """Numbers of the summary: penetration time, contacts of bodies, travel and its cost, drives, strips."""
    numbers: dict[str, Any] = {}
    scene, load = motion.scene, motion.trajectory.load
    if (sinking := _penetration_time(motion, depths)) is not None:
        numbers["penetration_time_s"] = sinking
    if scene.body_columns and load is not None:
        names = list(dict.fromkeys(motion.reported(name) for name in load.body_names))
        numbers["contacts"] = mechanism.contacts(motion.trajectory.time, names, by_body)
    if scene.drives and any(mechanism.travels(scene, joint) for joint in scene.joints):
        numbers |= mechanism.travel(motion, driven)
        if (strides := mechanism.strides(motion, driven)) is not None:
            numbers["strides"] = strides
    if driven:
        numbers["drives"] = mechanism.drives(motion, driven)
    numbers |= mechanism.largest_torque(scene, driven)
    # With step-size control strips are chosen by their error too.
    if scene.solver.accuracy is not None and load is not None and not scene.in_space:
        chosen = {"per_rigid_part": scene.load.strips_per_rigid_part, "per_element": scene.load.strips_per_element}
        numbers["strips"] = chosen
    return numbers


def accuracy(motion: Kinematics, driven: mechanism.Driven) -> list[AccuracyWarning]:
    """Accuracy warnings of a run."""
    with np.errstate(all="ignore"):  # as in a run that diverged
        time = motion.trajectory.time
        drives = drive_warnings(motion.scene, driven, greatest_energy(motion), float(time[-1] - time[0]))
        return [*accuracy_warnings(motion), *drives]
