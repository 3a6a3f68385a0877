"""What joints stored, lost and were given over a run, from the accepted steps: energies, works, torques of drives."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.results.energy import work
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Drive, Vector


@dataclass(frozen=True)
class JointForces:
    """What each element of a joint does along its coordinate (rad clockwise, or m), (n,) each.

    Torques (N m) or forces (N) by element; elastic: of these the part that is stored; stored (J) in each of them. The
    power of an element is its force times the rate of the coordinate; of what is not elastic it is never positive.
    """

    force: dict[str, Vector]
    elastic: dict[str, Vector]
    stored: dict[str, Vector]

    def lost(self, name: str, rate: Vector) -> Vector:
        """Power (n,) W of an element less that of its elastic part."""
        return (self.force[name] - self.elastic.get(name, 0.0)) * rate

    def done(self, time: Vector, rate: Vector) -> tuple[Vector, Vector, Vector]:
        """Energy stored (n,) J, and work (n,) J done so far by dampers and stops, and by friction, at a rate (n,)."""
        nothing = np.zeros_like(rate)
        lossy = [
            force - self.elastic.get(name, nothing)
            for name, force in self.force.items()
            if name not in ("spring", "friction")
        ]
        stored = sum(self.stored.values(), nothing)
        return stored, work(time, sum(lossy, nothing), rate), work(time, self.force.get("friction", nothing), rate)


def joint_forces(law: JointLaw, anchor: float, s: Vector, rate: Vector) -> JointForces:
    """Forces in a joint with coordinate s (n,) rad or m and its rate (n,), its bristle held at the anchor at first."""
    force, elastic, stored = {}, {}, {}
    if law.stiffness > 0.0:
        elastic["spring"] = force["spring"] = -law.stiffness * (s - law.rest)
        stored["spring"] = 0.5 * law.stiffness * (s - law.rest) ** 2
    if law.damping > 0.0:
        force["damper"] = -law.damping * rate
    if law.has_stops:
        from granular_contact.mechanics.kernels.joint_laws import stops

        part, whole = stops(_record(law), s, rate)
        for name, depth in (("lower_stop", law.lower - s), ("upper_stop", s - law.upper)):
            there = depth > 0.0
            elastic[name], force[name] = np.where(there, part, 0.0), np.where(there, whole, 0.0)
            stored[name] = 0.5 * law.stop_stiffness * np.maximum(depth, 0.0) ** 2
    if law.friction > 0.0:
        from granular_contact.mechanics.kernels.joint_laws import frictions

        force["friction"] = frictions(_record(law), s, rate, anchor)
    return JointForces(force, elastic, stored)


def drive_history(drive: Drive, time: Vector, s: Vector, rate: Vector, set_to: Vector | None = None) -> Vector:
    """Torque or force (n,) of a drive that is no prescribed motion; set_to (n,): of one that is set from outside."""
    from granular_contact.mechanics.joint_loads import held, setpoint
    from granular_contact.mechanics.kernels.joint_laws import drive_forces

    if set_to is None:
        targets = [setpoint(drive, t) for t in time.tolist()]
    else:
        targets = [held(drive, value) for value in set_to.tolist()]
    forces: Vector = drive_forces(_record(JointLaw(), drive), np.array(targets), s, rate)
    return forces


def _record(law: JointLaw, drive: Drive | None = None) -> NDArray[np.void]:
    """Record (1,) as kernels read it."""
    from granular_contact.mechanics.joint_loads import fill
    from granular_contact.mechanics.kernels.joint_loads import JOINT

    record = np.zeros(1, JOINT)
    fill(record, law, drive)
    return record
