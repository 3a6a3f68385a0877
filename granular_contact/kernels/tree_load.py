"""Right-hand side of a tree of rigid bodies in the medium.

State y: angles (n,), rates (n,), work of the medium so far (J).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from granular_contact.kernels import batches
from granular_contact.kernels.compiled import part
from granular_contact.kernels.tree import Motion, accelerate, place


class TreeArrays(NamedTuple):
    """What the kernels of a tree read, and their room to work in.

    bodies (n,) records of `tree`, gravity (1,) m/s2, motion; the rest is a batch of `batches` with all contact
    lines on the bodies: its system coordinates are those of `Motion.pose`; columns (lines, 3) as in `batches.accept`.
    """

    bodies: Any
    gravity: Any
    motion: Motion
    nowhere: Any
    active: Any
    ends: Any
    places: Any
    geometry: Any
    lines: Any
    profile: Any
    medium: Any
    anchors: Any
    room: Any
    body: Any
    columns: Any
    proximity: Any


@part
def rates(y, w, dy):
    """Fill dy with y'."""
    n = w.bodies.shape[0]
    motion = w.motion
    place(y[:n], y[n : 2 * n], w.bodies, motion)
    motion.force[:] = 0.0
    power = 0.0
    if w.lines.shape[0] > 0:
        batches.force(
            motion.pose.ravel(), motion.twist.ravel(), w.nowhere, w.active, w.ends, w.places, w.geometry, w.lines,
            w.profile, w.medium, w.anchors, w.room, w.body, motion.force.ravel(),
        )  # fmt: skip
        for i in range(n):
            for k in range(3):
                power += motion.force[i, k] * motion.twist[i, k]
    for i in range(n):
        motion.force[i, 1] -= w.gravity[0] * w.bodies[i].mass
        dy[i] = y[n + i]
    accelerate(y[n : 2 * n], w.bodies, motion, dy[n : 2 * n])
    dy[2 * n] = power


@part
def accept(y, w, row, begins):
    """End of a step at y: the anchors follow, forces of the medium and depth go into a history row.

    begins: whether a motion begins here instead, without any stretched bristle.
    """
    n = w.bodies.shape[0]
    motion = w.motion
    place(y[:n], y[n : 2 * n], w.bodies, motion)
    if w.lines.shape[0] > 0:
        batches.accept(
            motion.pose.ravel(), motion.twist.ravel(), w.nowhere, w.ends, w.places, w.geometry, w.lines, w.profile,
            w.medium, w.anchors, w.room, w.body, row, w.columns, w.proximity, begins,
        )  # fmt: skip


@part
def fastest(w):
    """Greatest speed (m/s) of any body as it was placed last: of its centre of mass, or of its rim about that."""
    speed = 0.0
    for i in range(w.bodies.shape[0]):
        twist = w.motion.twist[i]
        speed = max(speed, abs(twist[0]), abs(twist[1]), w.bodies[i].radius * abs(twist[2]))
    return speed
