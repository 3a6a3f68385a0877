"""What mechanisms have in their results beyond a pendulum: joints, drives and bodies, contacts, and how far it got."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact import series
from granular_contact.energy import accumulate, work
from granular_contact.multibody.joint_history import drive_history, joint_history
from granular_contact.multibody.medium_work import medium_works
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


def joint_energies(observer: Observer) -> dict[str, Vector]:
    """What joints store, and the work done in them; only of what the mechanism has."""
    joints, t = [joint for joint in observer.scene.connections if not joint.law.is_idle], observer.trajectory
    held = {name: load.first_anchor for name, load in observer.system.loads.items()}
    done = [joint_history(j.law, held.get(j.name, 0.0), t.time, *observer.coordinate(j)) for j in joints]
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
    numbers: dict[str, Any] = {}
    if observer.scene.body_columns and observer.trajectory.load is not None:
        numbers["contacts"] = {label(name): _contacts(observer, f) for name, f in _body_forces(observer).items()}
    if observer.scene.drives and any(_travels(joint) for joint in observer.scene.connections):
        numbers |= _travel(observer)
    return numbers


def _contacts(observer: Observer, force: Vector) -> list[list[float]]:
    """Intervals [on, off] (s) over which the medium acts on a body; the last may last until the end of the run."""
    time, touches = observer.trajectory.time, np.any(force != 0.0, axis=1)
    change = np.diff(touches.astype(int), prepend=0)
    on = np.flatnonzero(change == 1)
    off = np.append(np.flatnonzero(change == -1), len(time) - 1)[: len(on)]
    return [[float(time[a]), float(time[b])] for a, b in zip(on, off, strict=True)]


def _travels(joint: Connection) -> bool:
    """Whether a joint lets all that hangs on it move along the surface."""
    along = joint.axis is not None and abs(joint.axis[0]) > LEAST_ALONG
    return joint.parent is None and (joint.kind == "free" or along)


def _travel(observer: Observer) -> dict[str, float | None]:
    """Way of the common centre of mass, its mean speed (of the second half too, when a gait has set in), and the cost.

    cost_of_transport: work that the drives put in (what they take back is not counted) over weight times way.
    """
    time, scene = observer.trajectory.time, observer.scene
    x = np.sum([body.mass * observer.center(body.name)[0][:, 0] for body in scene.bodies], axis=0) / scene.mass
    put_in = sum(accumulate(time, np.maximum(power, 0.0))[-1] for _, power in observer.drive_forces.values())
    way, middle = float(x[-1] - x[0]), len(time) // 2
    lasted, later = float(time[-1] - time[0]), float(time[-1] - time[middle])
    weight = scene.mass * abs(scene.gravity)
    return {
        "drive_work_put_in_J": float(put_in),
        "distance_m": way,
        "forward_speed_m_s": way / lasted if lasted > 0.0 else None,
        "forward_speed_second_half_m_s": float((x[-1] - x[middle]) / later) if later > 0.0 else None,
        "cost_of_transport": float(put_in) / (weight * abs(way)) if weight * abs(way) > 0.0 else None,
    }
