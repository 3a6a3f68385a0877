"""Histories of joints over a run, from the accepted steps: stored energies, works, torques of drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.results.energy import work
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Drive, Vector


@dataclass(frozen=True)
class JointForces:
    """Forces of the elements of a joint along its coordinate (rad clockwise, or m), (n,) each, by element.

    force: torque (N m) or force (N); elastic: its conservative part; stored (J): energy of that part. The power of an
    element is its force times the rate of the coordinate; the power of its dissipative part is never positive.
    """

    force: dict[str, Vector]
    elastic: dict[str, Vector]
    stored: dict[str, Vector]

    def lost(self, name: str, rate: Vector) -> Vector:
        """Power (n,) W of the dissipative part of an element."""
        return (self.force[name] - self.elastic.get(name, 0.0)) * rate

    def done(self, time: Vector, rate: Vector) -> tuple[Vector, Vector, Vector]:
        """Stored energy (n,) J, work (n,) J of dampers and stops, and work (n,) J of friction since the start."""
        zeros = np.zeros_like(rate)
        dissipative = [
            force - self.elastic.get(name, zeros)
            for name, force in self.force.items()
            if name not in ("spring", "friction")
        ]
        stored, friction = sum(self.stored.values(), zeros), self.force.get("friction", zeros)
        return stored, work(time, sum(dissipative, zeros), rate), work(time, friction, rate)


def joint_forces(law: JointLaw, anchor: float, s: Vector, rate: Vector) -> JointForces:
    """Forces in a joint with coordinate s (n,) rad or m and rate (n,); anchor: of its bristle at the start."""
    force, elastic, stored = {}, {}, {}
    if law.stiffness > 0.0:
        elastic["spring"] = force["spring"] = -law.stiffness * (s - law.rest)
        stored["spring"] = 0.5 * law.stiffness * (s - law.rest) ** 2
    if law.damping > 0.0:
        force["damper"] = -law.damping * rate
    if law.has_stops:
        from granular_contact.mechanics.kernels.joint_laws import stops

        conservative, whole = stops(_record(law), s, rate)
        for name, depth in (("lower_stop", law.lower - s), ("upper_stop", s - law.upper)):
            touches = depth > 0.0
            elastic[name], force[name] = np.where(touches, conservative, 0.0), np.where(touches, whole, 0.0)
            stored[name] = 0.5 * law.stop_stiffness * np.maximum(depth, 0.0) ** 2
    if law.friction > 0.0:
        from granular_contact.mechanics.kernels.joint_laws import frictions

        force["friction"] = frictions(_record(law), s, rate, anchor)
    return JointForces(force, elastic, stored)


def targets(drive: Drive, time: Vector, set_to: Vector | None = None) -> Vector:
    """Target and target rate (n, 2) of a drive at n times; set_to (n,): targets of one that is set from outside."""
    from granular_contact.mechanics.joint_loads import held, setpoint

    if set_to is None:
        return np.array([setpoint(drive, t) for t in time.tolist()])
    return np.array([held(drive, value) for value in set_to.tolist()])


def drive_history(drive: Drive, time: Vector, s: Vector, rate: Vector, set_to: Vector | None = None) -> Vector:
    """Torque or force (n,) of a drive without prescribed motion; set_to (n,): targets of one set from outside."""
    from granular_contact.mechanics.kernels.joint_laws import drive_forces

    forces: Vector = drive_forces(_record(JointLaw(), drive), targets(drive, time, set_to), s, rate)
    return forces


def _record(law: JointLaw, drive: Drive | None = None) -> NDArray[np.void]:
    """Record (1,) of JOINT with a law and a drive."""
    from granular_contact.mechanics.joint_loads import fill
    from granular_contact.mechanics.kernels.joint_loads import JOINT

    record = np.zeros(1, JOINT)
    fill(record, law, drive)
    return record
