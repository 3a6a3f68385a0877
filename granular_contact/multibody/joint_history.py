"""What joints stored, lost and were given over a run, from the accepted steps: energies, works, torques of drives."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from granular_contact.energy import work
from granular_contact.multibody.joint_loads import drive_force, follow, friction, stop, wanted
from granular_contact.scene.types import Drive, JointLaw, Vector


@dataclass(frozen=True)
class JointHistory:
    """Energy stored (n,) J in springs and stops, and work (n,) J done so far by dampers and stops, and by friction."""

    stored: Vector
    damping: Vector
    friction: Vector


def joint_history(law: JointLaw, anchor: float, time: Vector, s: Vector, rate: Vector) -> JointHistory:
    """History of a joint with coordinate s (n,) rad or m and its rate (n,), its bristle held at the anchor at first."""
    stored = 0.5 * law.stiffness * (s - law.rest) ** 2 if law.stiffness > 0.0 else np.zeros_like(s)
    damping = -law.damping * rate
    if law.has_stops:
        depth = np.maximum(s - law.upper, 0.0) + np.maximum(law.lower - s, 0.0)
        stored = stored + 0.5 * law.stop_stiffness * depth**2
        forces = [stop(law, *state) for state in zip(s.tolist(), rate.tolist(), strict=True)]
        damping = damping + np.array([whole.value - elastic for elastic, whole in forces])
    return JointHistory(stored, work(time, damping, rate), work(time, _friction(law, anchor, s, rate), rate))


def _friction(law: JointLaw, anchor: float, s: Vector, rate: Vector) -> Vector:
    """Dry friction (n,), with its anchor led along as in the run."""
    if law.friction == 0.0:
        return np.zeros_like(s)
    forces = []
    for place, speed in zip(s.tolist(), rate.tolist(), strict=True):
        forces.append(friction(law, place, speed, anchor).value)
        anchor = follow(law, place, anchor)
    return np.array(forces)


def drive_history(drive: Drive, time: Vector, s: Vector, rate: Vector) -> Vector:
    """Torque or force (n,) of a drive that is no prescribed motion."""
    states: Iterable[tuple[float, float, float]] = zip(time.tolist(), s.tolist(), rate.tolist(), strict=True)
    return np.array([drive_force(drive, *wanted(drive, t), place, speed).value for t, place, speed in states])
