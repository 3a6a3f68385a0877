"""Right-hand side of a tree of rigid bodies in the medium, with all that acts in its joints.

State y: coordinates (n,), their rates (n,), work of the media so far, and that of the floor (J).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from granular_contact.kernels import planar_sand
from granular_contact.kernels.compiled import part
from granular_contact.kernels.joint_laws import CONTROL, LOAD, RATE_CONTROL, follow, total
from granular_contact.kernels.joint_loads import ANCHOR, RATE, VALUE
from granular_contact.kernels.memory import clear, rows
from granular_contact.kernels.signal_tables import look_up
from granular_contact.kernels.tree import Motion, accelerate, place


class TreeArrays(NamedTuple):
    """What the kernels of a tree read, and their room to work in.

    nodes (n,) records of `tree`, gravity (1,) m/s2, motion. sand: as in `planar_sand`, with the coordinates of
    `Motion.pose` as those of the system; its first `floors` (1,) batches are the floor's. laws (n,): records of
    `joint_loads.JOINT`, of what acts along each coordinate; state (n, 5): see there; signals (n,): which signal a
    joint's drive follows, -1 of none; knots, pieces: see `signal_tables`; wanted (signals, 3): their values, rates and
    accelerations at present.
    """

    nodes: Any
    gravity: Any
    motion: Motion
    sand: Any
    floors: Any
    laws: Any
    state: Any
    signals: Any
    knots: Any
    pieces: Any
    wanted: Any


@part
def follow_signals(t, y, w):
    """Let drives want what their signals say at t (s), and prescribed coordinates of y be there."""
    if w.wanted.shape[0] == 0:
        return
    look_up(t, w.knots, w.pieces, w.wanted)
    n = w.nodes.shape[0]
    for i in range(n):
        k = w.signals[i]
        if k < 0:
            continue
        value, rate, kind = w.wanted[k, 0], w.wanted[k, 1], w.laws[i].drive
        if w.nodes[i].prescribed:
            y[i], y[n + i] = value, rate
        elif kind == LOAD:
            w.state[i, VALUE] = value
        elif kind == CONTROL:
            w.state[i, VALUE], w.state[i, RATE] = value, rate
        elif kind == RATE_CONTROL:
            w.state[i, VALUE], w.state[i, RATE] = value, value


@part
def power_of(motion):
    """Power (W) of the forces on the nodes."""
    power = 0.0
    for i in range(motion.force.shape[0]):
        for k in range(3):
            power += motion.force[i, k] * motion.twist[i, k]
    return power


@part
def rates(t, y, w, dy):
    """Fill dy with y' at t (s); coordinates of y that are prescribed become what they are then."""
    n, motion, floors = w.nodes.shape[0], w.motion, w.floors[0]
    follow_signals(t, y, w)
    place(y[:n], y[n : 2 * n], w.nodes, motion)
    clear(motion.force)
    pose, twist, force = motion.pose.ravel(), motion.twist.ravel(), motion.force.ravel()
    dy[2 * n + 1] = 0.0
    if floors > 0:
        planar_sand.force(rows(w.sand, 0, floors), pose, twist, force)
        dy[2 * n + 1] = power_of(motion)
    planar_sand.force(rows(w.sand, floors, w.sand.shape[0] - floors), pose, twist, force)
    dy[2 * n] = power_of(motion) - dy[2 * n + 1]
    for i in range(n):
        motion.force[i, 1] -= w.gravity[0] * w.nodes[i].mass
        motion.effort[i] = 0.0
        if w.nodes[i].acts:
            now = w.state[i]
            motion.effort[i] = total(w.laws[i], y[i], y[n + i], now[ANCHOR], now[VALUE], now[RATE])
        dy[i] = y[n + i]
        if w.nodes[i].prescribed:
            dy[n + i] = w.wanted[w.signals[i], 2]
    accelerate(w.nodes, motion, dy[n : 2 * n])


@part
def accept(y, w, row, begins):
    """End of a step at y: anchors follow, forces of the medium and depth go into a history row.

    begins: whether a motion begins here instead, without any stretched bristle.
    """
    n, motion = w.nodes.shape[0], w.motion
    place(y[:n], y[n : 2 * n], w.nodes, motion)
    planar_sand.accept(w.sand, motion.pose.ravel(), motion.twist.ravel(), row, begins)
    for i in range(n):
        if w.nodes[i].acts and w.laws[i].friction > 0.0:
            w.state[i, ANCHOR] = follow(w.laws[i], y[i], w.state[i, ANCHOR])


@part
def fastest(w):
    """Greatest speed (m/s) of any node as it was placed last: of its centre of mass, or of its rim about that."""
    speed = 0.0
    for i in range(w.nodes.shape[0]):
        twist = w.motion.twist[i]
        speed = max(speed, abs(twist[0]), abs(twist[1]), w.nodes[i].radius * abs(twist[2]))
    return speed
