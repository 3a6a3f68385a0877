"""What is kept of each body in the sand of a MuJoCo model, and how it moves within a step.

Twists (6,) are angular velocity (rad/s), then velocity (m/s) of what of a body is at the point about which MuJoCo has
them: the centre of mass of its mechanism. Loads (6,) are force (N), then moment (N m) about the centre of mass of the
body. Both are in the world frame; poses, and wrench, in that of the bed.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear
from granular_contact.jit.records import fields, record_dtype
from granular_contact.sand.kernels.vectors import column, cross, dot, minus, moving, norm, plus, times, vector

# A body. number: its number, top: that of the first of its mechanism, last: the last degree of freedom that moves it,
# -1 if none does; radius (m): how far it reaches from the reference point, the origin of its frame; facing: see
# `planar_added_mass`; arm (m): from the point of twists to the reference point.
# twist: at the begin of the step; gained: in the step before; foreseen: gain that is foreseen for this step, reached:
# that of the step that was tried; ahead: twist with which the step is foreseen to end; change: of the twist at the end,
# by Newton's correction.
# load: in this step, start: in that before it; slope: the part of load that was not found where the step was foreseen
# to end, but along its slope from there; target: load with which the step would end as foreseen, about the point of
# twists, error: what load lacks, about the same; base: what others apply; written, brought: what stood in
# `xfrc_applied` last, and what MuJoCo's own state may bring back of it; work, drift (J): of load and of slope.
# pose: see `space_law`; then: the same with the velocities that are foreseen; seen: see `space_law.DEPTH`, and that of
# the floor. wrench: force and moment (N m) about the reference point where the step ends; added: see `added_mass`.
HELD = record_dtype(
    [
        *fields("i8", "number", "top", "last"),
        *fields("f8", "radius", "work", "drift"),
        *((name, "f8", (3,)) for name in ("facing", "arm", "seen", "seen_of_floor")),
        *((name, "f8", (6,)) for name in ("twist", "gained", "foreseen", "reached", "ahead", "change")),
        *((name, "f8", (6,)) for name in ("load", "start", "slope", "target", "error", "base", "written", "brought")),
        ("wrench", "f8", (6,)),
        *((name, "f8", (6, 3)) for name in ("pose", "then")),
        ("added", "f8", (6, 6)),
    ]
)
# Of them, what a state of the bed is.
STATE = ("load", "start", "slope", "base", "twist", "gained", "seen", "work", "drift")
# A bed and its clock. turn: from the world to the frame of the bed; slow (m/s): see `foresee`, close (m): see
# `held_step.again`; step (s): length of the step; passed (s): how long the one took that ended here, 0 if none did;
# begins: whether a motion begins here, with the friction state at rest.
BED = record_dtype([("turn", "f8", (3, 3)), *fields("f8", "slow", "close", "step", "passed"), ("begins", "?")])


@part
def gather_twist(last, parents, axes, v, twist):
    """Fill the twist (6,) of a body from the rates v (m,) of a tree: axes (m, 6) of its degrees of freedom.

    last: the last degree of freedom that moves the body, -1 if none does; parents (m,): the one before each.
    """
    for k in range(6):
        twist[k] = 0.0
    i = last
    while i >= 0:
        for k in range(6):
            twist[k] += axes[i, k] * v[i]
        i = parents[i]


@part
def place(body, x, R, c, twist, turn, pose):
    """Fill the pose of a body with a twist and its arm, from what MuJoCo has of it in the world frame.

    x (3,) m: origin of its frame, R (9,): rotation; c (3,) m: point of twists; turn (3, 3): to the frame of the bed.
    """
    r, w = minus(x, c), vector(twist, 0)
    v = moving(vector(twist, 3), w, r)
    body.arm[0], body.arm[1], body.arm[2] = r
    for i in range(3):
        to = vector(turn[i], 0)
        for j in range(3):
            pose[i, j] = dot(to, column(R, j))
        pose[3, i], pose[4, i], pose[5, i] = dot(to, x), dot(to, v), dot(to, w)


@part
def advance(pose, then, step, out):
    """Fill a pose (6, 3) with where a body at a pose is after a step with the velocities of the pose `then`."""
    w = times(step, then[5])
    angle = norm(w)
    a = math.sin(angle) / angle if angle > 1e-9 else 1.0
    b = (1.0 - math.cos(angle)) / (angle * angle) if angle > 1e-4 else 0.5
    for j in range(3):
        axis = pose[0, j], pose[1, j], pose[2, j]
        c = cross(w, axis)
        out[0, j], out[1, j], out[2, j] = plus(axis, plus(times(a, c), times(b, cross(w, c))))
        out[3, j] = pose[3, j] + step * then[4, j]
        out[4, j], out[5, j] = then[4, j], then[5, j]


@part
def blank(seen):
    """Begin to see a body anew, see `space_law.DEPTH`."""
    seen[0], seen[1], seen[2] = -np.inf, 0.0, np.inf


@part
def end_step(body, x, y, z, load, now, passed):
    """Work (J) of a load (6,) in the step that took a time (s): on the mean of the twists at its start and now.

    x, y, z (m): from the point of twists to the centre of mass.
    """
    power = 0.0
    for twist in (body.twist, now):
        v = moving(vector(twist, 3), vector(twist, 0), (x, y, z))
        power += dot(vector(load, 0), v) + dot(vector(load, 3), vector(twist, 0))
    return 0.5 * passed * power


@part
def foresee(body, slow):
    """Where a step leads if the twist gains what it gained in the one before, from `ahead`, the twist now.

    Only as much of it as leaves half of the twist, so that nothing turns round that only comes to rest; and little of
    it below a speed `slow` (m/s), where bristles bear that do not slide: it would drive what it comes too late for.
    """
    square, along, fast = 0.0, 0.0, 0.0
    for k in range(6):
        body.twist[k] = body.ahead[k]
        square += body.twist[k] * body.twist[k]
        along += body.twist[k] * body.gained[k]
    share = min(1.0, -0.5 * square / along) if along < 0.0 else 1.0
    for k in range(3):
        fast += body.pose[4, k] ** 2 + (body.radius * body.pose[5, k]) ** 2
    share *= fast / (fast + slow * slow)
    for k in range(6):
        body.foreseen[k] = share * body.gained[k]
        body.ahead[k] = body.twist[k] + body.foreseen[k]
    clear(body.wrench)
    clear(body.added)


@part
def farthest(held):
    """Greatest difference (m/s) of the velocity of any point between the gains of twists reached and foreseen."""
    most = 0.0
    for b in range(held.shape[0]):
        one, other = held[b].reached, held[b].foreseen
        w = minus(vector(one, 0), vector(other, 0))
        v = moving(minus(vector(one, 3), vector(other, 3)), w, held[b].arm)
        most = max(most, norm(v) + held[b].radius * norm(w))
    return most


@part
def find_base(body, applied):
    """Fill base where a row (6,) of `xfrc_applied` is not what was written, nor what was brought back."""
    for k in range(6):
        now = applied[k]
        if now != body.written[k] and (now == 0.0 or now != body.brought[k]):
            body.base[k] = now


@kernel(nogil=True)
def write_loads(held, applied):
    """Set the rows of bodies in applied (all, 6), and written, to base and load together."""
    for b in range(held.shape[0]):
        body = held[b]
        for k in range(6):
            body.written[k] = body.base[k] + body.load[k]
            applied[body.number, k] = body.written[k]
