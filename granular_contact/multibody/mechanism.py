"""What mechanisms have in their results beyond a pendulum: joints, drives and bodies, contacts, and how far it got."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.multibody.joint_history import JointForces, drive_history, joint_forces, joint_history
from granular_contact.multibody.medium_work import medium_works
from granular_contact.results import series
from granular_contact.results.energy import work
from granular_contact.results.interpolation import above_zero, at_times, positive_part
from granular_contact.scene.types import Connection, Drive, Vector

if TYPE_CHECKING:
    from granular_contact.multibody.observe import Observer

LEAST_ALONG = 1e-9  # x component of the axis of a slider that is not upright


def label(body: str) -> str:
    """Name of a body in columns: that of its first part; one that is called as the tip's columns are gets a tail."""
    first = body.split("+")[0]
    return f"{first}_body" if first == "tip" else first


def joint_columns(observer: Observer) -> series.Series:
    """Coordinate and rate of every hinge and slider."""
    columns: series.Series = {}
    for joint in observer.scene.connections:
        if joint.has_coordinate:
            made = series.joint if joint.kind == "hinge" else series.slider
            columns |= made(joint.name, joint.child, joint.parent, *observer.coordinate(joint))
    return columns


def _drive_work(observer: Observer, drive: Drive) -> Vector:
    force, _ = observer.drive_forces[drive.joint]
    return work(observer.trajectory.time, force, observer.coordinate(_joint(observer, drive.joint))[1])


def _joint(observer: Observer, name: str) -> Connection:
    return next(joint for joint in observer.scene.connections if joint.name == name)


def drive_force(observer: Observer, drive: Drive) -> tuple[Vector, Vector]:
    """Torque or force (n,) of a drive, and its power (n,) W."""
    s, rate = observer.coordinate(_joint(observer, drive.joint))
    if drive.kind == "motion":
        force = observer.trajectory.reactions[drive.joint]
    else:
        force = drive_history(drive, observer.trajectory.time, s, rate)
    return force, force * rate


def drive_columns(observer: Observer) -> series.Series:
    """Torque or force, and power of every drive."""
    columns: series.Series = {}
    for name, (force, power) in observer.drive_forces.items():
        columns |= series.drive(name, _joint(observer, name).kind == "hinge", force, power)
    return columns


def body_columns(observer: Observer) -> series.Series:
    """Motion of every body's centre of mass and frame (of a link that bends, its root), and the sand's force on it."""
    columns: series.Series = {}
    if not observer.scene.body_columns:
        return columns
    forces = _body_forces(observer)
    for body in observer.scene.bodies:
        center, velocity = observer.center(body.name)
        angle, rate = observer.angle(body.name, np.zeros(2))
        columns |= series.body(label(body.name), center, -angle, velocity, -rate)
        if body.name in forces:
            columns |= series.body_force(label(body.name), forces[body.name], center)
    return columns


def _body_forces(observer: Observer) -> dict[str, Vector]:
    """Resultant x, y (N) and moment about the origin (N m) of the medium on every body that can reach it, (n, 3)."""
    load = observer.trajectory.load
    return {} if load is None else {name: load.bodies[:, i] for i, name in enumerate(load.body_names)}


def all_joint_forces(observer: Observer) -> dict[str, JointForces]:
    """What acts in every joint, by its name, but for drives; only of joints in which something does."""
    held = {name: load.first_anchor for name, load in observer.system.loads.items()}
    return {
        joint.name: joint_forces(joint.law, held.get(joint.name, 0.0), *observer.coordinate(joint))
        for joint in observer.scene.connections
        if not joint.law.is_idle
    }


def joint_energies(observer: Observer) -> dict[str, Vector]:
    """What joints store, and the work done in them; only of what the mechanism has."""
    joints, t = [joint for joint in observer.scene.connections if not joint.law.is_idle], observer.trajectory
    done = [joint_history(observer.joint_forces[j.name], t.time, observer.coordinate(j)[1]) for j in joints]
    laws = [joint.law for joint in joints]
    energies = {}
    if any(law.stiffness > 0.0 or law.has_stops for law in laws):
        energies["spring_J"] = np.sum([one.stored for one in done], axis=0)
    if any(law.damping > 0.0 or law.dissipation > 0.0 for law in laws):
        energies["joint_damping_work_J"] = np.sum([one.damping for one in done], axis=0)
    if any(law.friction > 0.0 for law in laws):
        energies["friction_work_J"] = np.sum([one.friction for one in done], axis=0)
    load, bed = t.load, observer.scene.bed
    if load is not None and bed is not None and bed.floor is not None:
        energies["floor_work_J"] = medium_works(observer)[1]
    if observer.drive_forces:
        energies["drive_work_J"] = np.sum([_drive_work(observer, drive) for drive in observer.scene.drives], axis=0)
    return energies


# ---- key numbers ----


def key_numbers(observer: Observer) -> dict[str, Any]:
    """Contacts of every body whose motion is reported; of what is driven and can travel, how far and at what cost."""
    from granular_contact.multibody.stop import penetration_time

    numbers: dict[str, Any] = {}
    if (sinking := penetration_time(observer)) is not None:
        numbers["penetration_time_s"] = sinking
    load = observer.trajectory.load
    if observer.scene.body_columns and load is not None:
        numbers["contacts"] = {label(name): _contacts(observer, name) for name in load.body_names}
    if observer.scene.drives and any(_travels(joint) for joint in observer.scene.connections):
        numbers |= _travel(observer)
    return numbers


def _contacts(observer: Observer, body: str) -> list[list[float]]:
    """Intervals [on, off] (s) over which a body is in the medium; the last may last until the end of the run."""
    return [[float(a), float(b)] for a, b in above_zero(observer.trajectory.time, observer.depths.get(body, []))]


def _travels(joint: Connection) -> bool:
    """Whether a joint lets all that hangs on it move along the surface."""
    along = joint.axis is not None and abs(joint.axis[0]) > LEAST_ALONG
    return joint.parent is None and (joint.kind == "free" or along)


def _travel(observer: Observer) -> dict[str, float | None]:
    """Way of the common centre of mass, its mean speed, and the cost.

    The mean of the second half of the time is given too, as a gait sets in. cost_of_transport: work that
    the drives put in (what they take back is not counted) over weight times way.
    """
    time, scene = observer.trajectory.time, observer.scene
    x, speed = (along[:, 0] for along in observer.common_center)
    put_in = sum(positive_part(time, power) for _, power in observer.drive_forces.values())
    lasted, middle = float(time[-1] - time[0]), 0.5 * (time[0] + time[-1])
    way, later = float(x[-1] - x[0]), float(x[-1] - at_times(time, x, speed, np.array([middle]))[0])
    weight = scene.mass * abs(scene.gravity)
    return {
        "drive_work_put_in_J": put_in,
        "distance_m": way,
        "forward_speed_m_s": way / lasted if lasted > 0.0 else None,
        "forward_speed_second_half_m_s": later / (0.5 * lasted) if lasted > 0.0 else None,
        "cost_of_transport": put_in / (weight * abs(way)) if weight * abs(way) > 0.0 else None,
    }
