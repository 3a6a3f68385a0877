"""Trajectory -> Observation in space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from granular_contact.geometry import rotations
from granular_contact.mechanics import mechanism
from granular_contact.mechanics.observe import forces_of, observed
from granular_contact.mechanics.space import facet_sizes
from granular_contact.mechanics.space.kinematics import SpatialKinematics
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.space.wheels import wheel_histories
from granular_contact.mechanics.strip_error import strip_error
from granular_contact.mechanics.system import Trajectory
from granular_contact.mechanics.wheels import add_wheels
from granular_contact.results import in_space, series
from granular_contact.results.frames import resample
from granular_contact.results.in_space import SpatialObservation
from granular_contact.results.interpolation import Track, at_times
from granular_contact.results.motion import Motion, Part
from granular_contact.sand.work import wrenches_about
from granular_contact.scene.space.types import Vector
from granular_contact.scene.types import link_of


def observe(system: SpatialSystem, trajectory: Trajectory) -> SpatialObservation:
    """Observation of a run, from which its results are made."""
    motion = SpatialKinematics(system, trajectory)
    error = strip_error(motion)
    if trajectory.strip_error is None:  # a run that is observed before its end has no estimate yet
        motion = SpatialKinematics(system, replace(trajectory, strip_error=error))
    with np.errstate(over="ignore", invalid="ignore"):  # as in a run that diverged
        depths, on_bodies = motion.depths(), forces_of(trajectory)
        forces = as_reported(on_bodies)
        fields = observed(motion, forces, depths, [track for tracks in depths.values() for track in tracks])
        fields["motion"] |= body_columns(motion, forces, depths)
        add_wheels(fields, wheel_histories(motion, forces))
        fields["notices"] += (*_left_map(motion, on_bodies),)
        if trajectory.load is not None and (facets := facet_sizes.numbers(motion, error)):
            fields["more"]["facets"] = facets
        for beam in motion.beams.values():
            fields["motion"] |= beam.columns()
            fields["deflection"] = beam.bend()
        motion_at = partial(moved, system, trajectory, on_bodies)
        return SpatialObservation(**fields, moved=motion_at)


def _left_map(motion: SpatialKinematics, forces: Mapping[str, Vector]) -> Iterator[str]:
    """Yield a sentence if bodies on which the medium acts left the map of heights on which they began.

    forces: wrenches (n, 6) of the medium by body.
    """
    heights = None if motion.scene.bed is None else motion.scene.bed.heights
    if heights is None:
        return
    low, high = heights.extent
    left: dict[str, float] = {}
    for body, wrench in forces.items():
        place = motion.center(body)[0][:, :2]
        beyond = np.maximum(low - place, place - high).max(axis=1)
        farthest = float(beyond[wrench.any(axis=1)].max(initial=0.0))
        if beyond[0] <= 0.0 < farthest:
            left[link_of(body)] = max(farthest, left.get(link_of(body), 0.0))
    if left:
        name = max(left, key=lambda body: left[body])
        yield f"{name} left the map of heights by {left[name]:.3g} m; {heights.place}"


def as_reported(forces: Mapping[str, Vector]) -> dict[str, Vector]:
    """Wrenches (n, 6) of the medium by reported body; those of the elements of a flexible link are added up."""
    reported: dict[str, Vector] = {}
    for body, wrench in forces.items():
        name = link_of(body)
        reported[name] = reported[name] + wrench if name in reported else wrench
    return reported


def body_columns(
    motion: SpatialKinematics, forces: Mapping[str, Vector], depths: Mapping[str, list[Track]]
) -> series.Series:
    """Columns of every body: motion, wrench of the medium, depth; forces (n, 6): moments about the origin."""
    columns: series.Series = {}
    for body in motion.scene.reported if motion.scene.body_columns else ():
        name, (center, velocity) = mechanism.label(body), motion.center(body)
        rpy = np.unwrap(rotations.rpy_of(motion.rotation(body)), axis=0)
        columns |= in_space.body(name, center, rpy, velocity, motion.spin(body))
        if body in forces:
            columns |= in_space.body_force(name, forces[body], center)
            if tracks := depths.get(body):
                columns |= series.body_depth(name, np.max([track.values for track in tracks], axis=0))
    return columns


def moved(system: SpatialSystem, trajectory: Trajectory, forces: Mapping[str, Vector], at: Vector) -> Motion:
    """Motion at times (k,) s for drawing: shapes, poses, arrows; forces (n, 6): of the medium, by body."""
    t = trajectory
    sampled = replace(t, time=at, q=at_times(t.time, t.q, t.v, at), v=resample(t.time, t.v, at))
    motion = SpatialKinematics(system, sampled)
    parts, poses = [], []
    for name, handle in system.rigid.items():
        pose = np.concatenate([motion.center(name)[0], motion.quaternion(name)], axis=1)
        for part in handle.body.parts:
            points, faces = np.unique(part.triangles.reshape(-1, 3), axis=0, return_inverse=True)
            parts.append(Part(part.name, points, faces.reshape(-1, 3)))
            poses.append(pose)
    drawn: dict[str, list[tuple[Vector, Vector]]] = {}
    for name, wrench in forces.items():
        radius = system.scene.radius(system.scene.body(name))
        arrow = _arrow(resample(t.time, wrench, at), motion.center(name)[0], radius)
        drawn.setdefault(mechanism.label(link_of(name)), []).append(arrow)
    arrows = {name: _sum(parts) for name, parts in drawn.items()}
    shown = np.stack(poses, axis=1) if poses else np.zeros((len(at), 0, 7))
    return Motion(at, tuple(parts), shown, {}, arrows)


def _sum(arrows: list[tuple[Vector, Vector]]) -> tuple[Vector, Vector]:
    """Mean position (k, 3) m of forces (k, 3) N, weighted with their sizes, and their sum."""
    places, forces = (np.array(part) for part in zip(*arrows, strict=True))
    sizes = np.linalg.norm(forces, axis=2, keepdims=True) + 1e-300
    mean: Vector = np.sum(sizes * places, axis=0) / np.sum(sizes, axis=0)
    total: Vector = np.sum(forces, axis=0)
    return mean, total


def _arrow(wrench: Vector, center: Vector, radius: float) -> tuple[Vector, Vector]:
    """Point (k, 3) m of a force's line of action nearest to the centre of mass, and the force (k, 3) N.

    A point farther than the radius (m) of the body from the centre of mass is drawn in to that distance.
    """
    force, moment = np.hsplit(wrenches_about(wrench, center), 2)
    square = np.sum(force * force, axis=1, keepdims=True)
    off = np.divide(rotations.vector_products(force, moment), square, out=np.zeros_like(force), where=square > 0.0)
    far = np.linalg.norm(off, axis=1, keepdims=True)
    return center + off * np.minimum(1.0, radius / np.maximum(far, 1e-300)), force
