"""Columns and numbers of mechanisms in results: joints, drives, bodies, contacts and travel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from granular_contact.mechanics import joint_history
from granular_contact.mechanics.joint_history import JointForces
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.reactions import reactions
from granular_contact.results import series
from granular_contact.results.energy import accumulate, work
from granular_contact.results.interpolation import Track, at_times, each_above_zero, positive_part
from granular_contact.results.summary import Driving, drive_numbers, stride_numbers
from granular_contact.scene.signal_tables import period
from granular_contact.scene.types import Joint, Scene, Vector

OVERLOAD = 1e-3  # relative excess over a limit of an actuator that is not reported: torques are known no better
LEAST_ALONG = 1e-9  # least component of a slider's axis along the direction of travel
# Of the effort limit and the rate limit of an actuator, by the kind of its joint: key of the number in `drive_numbers`,
# quantity, unit, and name of the limit.
_LIMITED = {
    "hinge": (("largest_torque_Nm", "torque", "N m", "effort"), ("largest_rate_rad_s", "rate", "rad/s", "rate")),
    "slider": (("largest_force_N", "force", "N", "effort"), ("largest_rate_m_s", "speed", "m/s", "speed")),
}
Driven = dict[str, Driving]  # by joint


def label(body: str) -> str:
    """Name of a body in columns: the name of its first part; "tip_body" for "tip", as columns of the tip begin so."""
    first = body.split("+")[0]
    return f"{first}_body" if first == "tip" else first


# ---- columns ----


def joint_columns(motion: Kinematics) -> series.Series:
    """Coordinate and rate of every hinge and slider, and of every ball joint with forces."""
    columns: series.Series = {}
    for joint in motion.scene.joints:
        if joint.has_coordinate:
            ends = motion.reported(joint.child), None if joint.parent is None else motion.reported(joint.parent)
            arguments = joint.name, *ends, *motion.coordinate(joint)
            hinge = joint.kind == "hinge"
            columns |= series.joint(*arguments, in_space=motion.scene.in_space) if hinge else series.slider(*arguments)
        elif not joint.law.is_idle:
            columns |= series.ball(joint.name, joint.child, joint.parent, *motion.coordinate(joint))
    return columns


def drive_columns(scene: Scene, driven: Driven) -> series.Series:
    """Torque or force and power of every drive."""
    columns: series.Series = {}
    for name, drive in driven.items():
        hinge = scene.joint(name).kind == "hinge"
        columns |= series.drive(name, hinge, drive.force, drive.power, in_space=scene.in_space)
    return columns


def body_columns(motion: Kinematics, forces: Mapping[str, Vector], depths: Mapping[str, list[Track]]) -> series.Series:
    """Motion of every body (centre of mass; angle, of a flexible link at its root), and force of the medium on it.

    forces: of the medium by body, (n, 3): x, y (N) and moment about the origin (N m); depths (m) of its points.
    """
    columns: series.Series = {}
    for body in motion.scene.bodies if motion.scene.body_columns else ():
        center, velocity = motion.center(body.name)
        angle, rate = motion.angle(body.name, np.zeros(2))
        columns |= series.body(label(body.name), center, -angle, velocity, -rate)
        if body.name in forces:
            columns |= series.body_force(label(body.name), forces[body.name], center)
            if tracks := depths.get(body.name):
                columns |= series.body_depth(label(body.name), np.max([track.values for track in tracks], axis=0))
    return columns


# ---- forces in joints ----


def drive_forces(motion: Kinematics) -> Driven:
    """Force, power and work of every drive, by its joint."""
    driven, prescribed, time = {}, reactions(motion), motion.trajectory.time
    for drive in motion.scene.drives:
        if drive.kind == "motion":
            driven[drive.joint] = prescribed[drive.joint]
            continue
        s, rate = motion.coordinate(motion.scene.joint(drive.joint))
        force = joint_history.drive_history(drive, time, s, rate, motion.trajectory.set_to.get(drive.joint))
        driven[drive.joint] = Driving(force, force * rate, work(time, force, rate))
    return driven


def joint_forces(motion: Kinematics) -> dict[str, JointForces]:
    """Forces in joints except drives, by joint; joints without forces are left out.

    The dampers of ball joints are left out: they act on the angular velocity, and the rate of the angle jumps at 0.
    """
    anchors = {name: load.first_anchor for name, load in motion.system.loads.items()}
    return {
        joint.name: joint_history.joint_forces(
            joint.law if joint.has_coordinate else replace(joint.law, damping=0.0),
            anchors.get(joint.name, 0.0),
            *motion.coordinate(joint),
        )
        for joint in motion.scene.joints
        if not joint.law.is_idle
    }


def joint_energies(motion: Kinematics, driven: Driven) -> dict[str, Vector]:
    """Energies stored in joints, and work done in them; only of elements that the mechanism has."""
    joints, forces = [joint for joint in motion.scene.joints if not joint.law.is_idle], joint_forces(motion)
    time = motion.trajectory.time
    works = [forces[j.name].done(time, motion.coordinate(j)[1]) for j in joints]
    laws = [joint.law for joint in joints]
    energies = {}
    if any(law.stiffness > 0.0 or law.has_stops for law in laws):
        energies["spring_J"] = np.sum([stored for stored, _, _ in works], axis=0)
    if any(law.damping > 0.0 or law.dissipation > 0.0 for law in laws):
        energies["joint_damping_work_J"] = np.sum([damping for _, damping, _ in works] + motion.damped_balls(), axis=0)
    if any(law.friction > 0.0 for law in laws):
        energies["friction_work_J"] = np.sum([friction for _, _, friction in works], axis=0)
    if driven:
        energies["drive_work_J"] = np.sum([drive.work for drive in driven.values()], axis=0)
    return energies


# ---- key numbers ----


def contacts(time: Vector, bodies: Sequence[str], depths: Mapping[str, list[Track]]) -> dict[str, list[list[float]]]:
    """Intervals [on, off] (s) in which bodies are in the medium; the last one may end with the run."""
    spans = each_above_zero(time, [depths.get(body, []) for body in bodies])
    return {label(body): [list(span) for span in each] for body, each in zip(bodies, spans, strict=True)}


def travels(scene: Scene, joint: Joint) -> bool:
    """Return whether a joint with the ground lets the mechanism travel in the direction of `output.travel`."""
    if joint.parent is not None or joint.kind == "free" or joint.axis is None:
        return joint.parent is None and joint.kind == "free"
    horizontal = np.asarray(joint.axis[:-1])
    along = np.linalg.norm(horizontal) if scene.travel is None else abs(horizontal @ np.asarray(scene.travel))
    return float(along) > LEAST_ALONG


def advance(motion: Kinematics) -> tuple[Vector, Vector]:
    """Distance (n,) m that the common centre of mass travelled along `output.travel`, and its speed (n,) m/s."""
    position, velocity = (vectors[:, :-1] for vectors in motion.common_center)  # horizontal components
    if (ahead := motion.scene.travel) is not None:
        return position @ np.asarray(ahead), velocity @ np.asarray(ahead)
    speed = np.linalg.norm(velocity, axis=1)
    return accumulate(motion.trajectory.time, speed), speed


def travel(motion: Kinematics, driven: Driven) -> dict[str, float | None]:
    """Distance travelled by the common centre of mass along `output.travel`, its mean speed, and the cost of transport.

    The mean speed of the second half of the time is given too, when a gait has set in. cost_of_transport: positive work
    of the drives over weight times distance; None where the distance is none but by round-off (`least_path`).
    """
    time, scene = motion.trajectory.time, motion.scene
    x, speed = advance(motion)
    put_in = sum(positive_part(time, drive.power) for drive in driven.values())
    duration, middle = float(time[-1] - time[0]), 0.5 * (time[0] + time[-1])
    distance, later = float(x[-1] - x[0]), float(x[-1] - at_times(time, x, speed, np.array([middle]))[0])
    weight = scene.mass * abs(scene.gravity)
    return {
        "drive_work_put_in_J": put_in,
        "distance_m": distance,
        "forward_speed_m_s": distance / duration if duration > 0.0 else None,
        "forward_speed_second_half_m_s": later / (0.5 * duration) if duration > 0.0 else None,
        "cost_of_transport": put_in / (weight * abs(distance)) if weight and abs(distance) > scene.least_path else None,
    }


def drives(motion: Kinematics, driven: Driven) -> dict[str, dict[str, float]]:
    """Torque or force, rate, power and work of every drive, by its joint."""
    numbers = {}
    for name, drive in driven.items():
        joint = motion.scene.joint(name)
        rate = motion.coordinate(joint)[1]
        numbers[name] = drive_numbers(motion.trajectory.time, drive, rate, rotary=joint.kind == "hinge")
    return numbers


def strides(motion: Kinematics, driven: Driven) -> dict[str, Any] | None:
    """Means over whole strides of a travelling mechanism, if all periodic drives have the same period; else None."""
    scene, time = motion.scene, motion.trajectory.time
    periods = [time_s for drive in scene.drives if (time_s := period(drive.signal)) is not None]
    if not periods or max(periods) > (1.0 + 1e-9) * min(periods):
        return None
    torques = [drive.force for name, drive in driven.items() if scene.joint(name).kind == "hinge"]
    powers = [drive.power for drive in driven.values()]
    weight = scene.mass * abs(scene.gravity)
    return stride_numbers(time, advance(motion)[0], powers, torques, weight, periods[0])


def largest_torque(scene: Scene, driven: Driven) -> dict[str, float]:
    """Greatest torque (N m) of any drive of a hinge at any step; empty without such drives."""
    torques = [drive.largest for name, drive in driven.items() if scene.joint(name).kind == "hinge"]
    return {"largest_drive_torque_Nm": max(torques)} if torques else {}


def overloads(scene: Scene, numbers: Mapping[str, Mapping[str, float]]) -> Iterator[str]:
    """Yield a sentence for each drive beyond the effort limit or the rate limit of its joint, as a robot file gives it.

    numbers: key numbers of the drives by joint, see `drives`.
    """
    for name, of_drive in numbers.items():
        joint = scene.joint(name)
        limits = (joint.effort_limit, joint.rate_limit)
        for (key, what, unit, kind), limit in zip(_LIMITED[joint.kind], limits, strict=True):
            if of_drive[key] > (1.0 + OVERLOAD) * limit:
                said = f"the drive of {name} needs a {what} of up to {of_drive[key]:.4g} {unit}, more than the {kind}"
                yield f"{said} limit of this joint, {limit:.4g} {unit}: the actuator could not follow"
