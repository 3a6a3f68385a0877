"""Coordinates of hinges, sliders and ball joints between rigid bodies in space, and forces; called by `joint_loads`.

A joint's frame lies at a point of the parent P and of the child C; its z is the axis a, which turns with the parent.

    hinge   s = angle about a from the parent's x to the child's, in the turn that was found last
    slider  s = a . (x_C + arm_C - x_P - arm_P)
    ball    s = angle of the rotation from the parent's frame to the child's, 0 to pi; a is its axis

x: position of a body's node, arm: from it to the joint's point. A torque or force tau along s is tau ds/dq on the
coordinates: with w = G e' (see `space_coordinates`) of hinges and balls ds/dt = a . (w_C - w_P). The spring of a ball
has the moment -k s a, k times the rotation vector, which is smooth at s = 0; at pi, where the way back may go either
way round, it jumps. Its damper acts on all of w_C - w_P: what is not along a adds -c (w_C - w_P - a ds/dt). Forces
along s are those of `joint_laws`; arguments and `state` as of `joint_loads`, with records of JOINT.

    elastic   between elements of a link that bends: a moment in the frame of the joint on the parent,
              m = -T^-T (K theta + D theta'), theta' = T^-1 (w_C - w_P), theta = s a the rotation vector there,
              T^-1 = 1 - theta^ / 2 + (1 - (s/2) cot(s/2)) (theta^ / s)^2 of the exponential map,
              so that m . (w_C - w_P) = -d/dt (theta . K theta) / 2 - theta' . D theta'
    stretching   the same, of a link that stretches: with s along the parent's x, a force -(k s + d s') as well
"""

from __future__ import annotations

import math
from functools import cache

from numba import from_dtype, types

from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.chosen import provide
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room1, room2, room3, rows
from granular_contact.jit.records import record_dtype
from granular_contact.mechanics.kernels import joint_loads
from granular_contact.mechanics.kernels.joint_coordinates import HINGE, SLIDER
from granular_contact.mechanics.kernels.joint_laws import total
from granular_contact.mechanics.kernels.joint_loads import ANCHOR, DRIVE, LAW, MOST, RATE, TURNS, VALUE
from granular_contact.sand.kernels.space_coordinates import by_parameters

BALL, ELASTIC, STRETCHING = 2, 3, 4  # kinds of joints, beside HINGE and SLIDER
# find: address of what finds the coordinate of its kind; parent, child: how many coordinates their nodes have, none of
# the ground; points (m) and axes of the joint's frame in the frames of parent and child; reference: values of the
# coordinates; bends, damps, axial: K, D, and k and d of an elastic joint.
JOINT = record_dtype(
    [
        *((name, "i8") for name in ("kind", "find")),
        ("parent", "i8"),
        ("child", "i8"),
        ("parent_point", "f8", (3,)),
        ("parent_turn", "f8", (3, 3)),
        ("child_point", "f8", (3,)),
        ("child_turn", "f8", (3, 3)),
        ("reference", "f8", (MOST,)),
        ("bends", "f8", (3,)),
        ("damps", "f8", (3,)),
        ("axial", "f8", (2,)),
        ("drive", "i8"),
        *((name, "f8") for name in (*LAW, *DRIVE)),
    ]
)
_ROW, _ROWS, _ROOM = (types.Array(types.float64, n, "C") for n in (1, 2, 3))
_FIND = (from_dtype(JOINT), *[_ROW] * 4, _ROOM, _ROWS, _ROOM)  # arguments of `_hinge` and its like
_FOUND = types.UniTuple(types.float64, 2)
_find = caller("find", _FIND, _FOUND, JOINT)


@part
def _frames(joint, q, frames, places, turns):
    """Fill rotations (2, 3, 3) and positions (2, 3) of parent and child, and the G (2, 3, 4) of `space_coordinates`."""
    q0 = room1(7)
    for side in range(2):
        count = joint.parent if side == 0 else joint.child
        first = 0 if side == 0 else joint.parent
        for i in range(7):
            q0[i] = q[first + i] + joint.reference[first + i] if count > 0 else (1.0 if i == 3 else 0.0)
        by_parameters(q0, frames[side], turns[side])
        for i in range(3):
            places[side, i] = q0[i]


@part
def _from_home(joint, R, a):
    """Angle (rad) of the rotation from the parent's frame to the child's; a (3,) is filled with its axis, or zeros."""
    P, C, A, B = joint.parent_turn, joint.child_turn, room2(3, 3), room2(3, 3)
    for i in range(3):
        for j in range(3):
            A[i, j] = R[0, i, 0] * P[0, j] + R[0, i, 1] * P[1, j] + R[0, i, 2] * P[2, j]
            B[i, j] = R[1, i, 0] * C[0, j] + R[1, i, 1] * C[1, j] + R[1, i, 2] * C[2, j]
    # The sum of the cross products of each axis of the parent's frame with that of the child's is 2 sin s a.
    cosine = -1.0
    for i in range(3):
        j, k, a[i] = (i + 1) % 3, (i + 2) % 3, 0.0
        for column in range(3):
            a[i] += 0.5 * (A[j, column] * B[k, column] - A[k, column] * B[j, column])
            cosine += A[i, column] * B[i, column]
    sine = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    for i in range(3):
        a[i] = a[i] / sine if sine > 0.0 else 0.0
    return math.atan2(sine, 0.5 * cosine)


@part
def _coordinate(joint, turns, q, v, slope):
    """`joint_loads.coordinate` (rad or m); turns[0] becomes that found here."""
    R, x, G = room3(2, 3, 3), room2(2, 3), room3(2, 3, 4)
    return _find(joint, (turns, q, v, slope, R, x, G))


@part
def _hinge(joint, last, q, v, slope, R, x, G):
    """`_coordinate` of a hinge; R, x, G: room for the frames of both bodies, see `_frames`."""
    _frames(joint, q, R, x, G)
    a, by_turn, s = room1(3), room2(2, 3), _turn_of(joint, R)
    _axis(joint, R, a, 2)
    s += 2.0 * math.pi * round((last[0] - s) / (2.0 * math.pi))
    for i in range(3):
        by_turn[0, i], by_turn[1, i] = -a[i], a[i]
    clear(slope)
    return _ended(joint, last, s, by_turn, G, v, slope)


@part
def _ball(joint, last, q, v, slope, R, x, G):
    """As `_hinge`, of a ball joint."""
    _frames(joint, q, R, x, G)
    a, by_turn = room1(3), room2(2, 3)
    s = _from_home(joint, R, a)
    for i in range(3):
        by_turn[0, i], by_turn[1, i] = -a[i], a[i]
    clear(slope)
    return _ended(joint, last, s, by_turn, G, v, slope)


@part
def _slider(joint, last, q, v, slope, R, x, G):
    """As `_hinge`, of a slider."""
    _frames(joint, q, R, x, G)
    a, by_turn = room1(3), room2(2, 3)
    _axis(joint, R, a, 2)
    clear(slope)
    s = _slide(joint, R, x, a, by_turn, slope)
    return _ended(joint, last, s, by_turn, G, v, slope)


@part
def _elastic(joint, last, q, v, slope, R, x, G):
    """Fill slope with the generalised forces of an elastic joint; arguments as of `_hinge`, returns zeros."""
    _frames(joint, q, R, x, G)
    P, A, a, w, t, f, n = joint.parent_turn, room2(3, 3), room1(3), room1(3), room1(3), room1(3), joint.parent
    s = _from_home(joint, R, a)
    for i in range(3):
        w[i] = 0.0
        for k in range(4):
            w[i] += G[1, i, k] * v[n + 3 + k] - (G[0, i, k] * v[3 + k] if n > 0 else 0.0)
        for j in range(3):
            A[i, j] = R[0, i, 0] * P[0, j] + R[0, i, 1] * P[1, j] + R[0, i, 2] * P[2, j]
    for i in range(3):
        t[i] = s * (A[0, i] * a[0] + A[1, i] * a[1] + A[2, i] * a[2])
    c = 1.0 / 12.0 + s * s / 720.0 if s < 1e-2 else (1.0 - 0.5 * s / math.tan(0.5 * s)) / (s * s)
    for i in range(3):
        f[i] = joint.bends[i] * t[i]
        if joint.damps[i] > 0.0:
            f[i] += joint.damps[i] * _by_map(A, w, t, c, i)
    clear(slope)
    square, along = s * s, t[0] * f[0] + t[1] * f[1] + t[2] * f[2]
    for i in range(3):
        # m = -(1 + t^ / 2 + c t^ t^) f in the joint's frame, a row of it at a time; w gets it in the world's.
        j, k = (i + 1) % 3, (i + 2) % 3
        a[i] = -(f[i] + 0.5 * (t[j] * f[k] - t[k] * f[j]) + c * (t[i] * along - square * f[i]))
    for i in range(3):
        w[i] = A[i, 0] * a[0] + A[i, 1] * a[1] + A[i, 2] * a[2]
    for i in range(3):
        for k in range(4):
            slope[n + 3 + k] += w[i] * G[1, i, k]
            if n > 0:
                slope[3 + k] -= w[i] * G[0, i, k]
    return 0.0, 0.0


@part
def _stretching(joint, last, q, v, slope, R, x, G):
    """As `_elastic`, of a link that stretches."""
    _elastic(joint, last, q, v, slope, R, x, G)
    a, by_turn, along = room1(3), room2(2, 3), room1(MOST)
    _axis(joint, R, a, 0)
    clear(along)
    s, rate = _ended(joint, last, _slide(joint, R, x, a, by_turn, along), by_turn, G, v, along)
    force = joint.axial[0] * s + joint.axial[1] * rate
    for i in range(MOST):
        slope[i] -= force * along[i]
    return 0.0, 0.0


@part
def _by_map(A, w, t, c, i):
    """Component i of T^-1 w; w (3,) rad/s in the world, A: axes of the joint's frame, t (3,) the rotation vector."""
    j, k, square = (i + 1) % 3, (i + 2) % 3, t[0] * t[0] + t[1] * t[1] + t[2] * t[2]
    u = room1(3)
    for row in range(3):
        u[row] = A[0, row] * w[0] + A[1, row] * w[1] + A[2, row] * w[2]
    along = t[0] * u[0] + t[1] * u[1] + t[2] * u[2]
    return u[i] - 0.5 * (t[j] * u[k] - t[k] * u[j]) + c * (t[i] * along - square * u[i])


@part
def _axis(joint, R, a, k):
    """Fill a (3,) with an axis of the parent's frame, of a hinge or a slider its z."""
    P = joint.parent_turn
    for i in range(3):
        a[i] = R[0, i, 0] * P[0, k] + R[0, i, 1] * P[1, k] + R[0, i, 2] * P[2, k]


@part
def _ended(joint, last, s, by_turn, G, v, slope):
    """Coordinate and rate, once it is known by what w_P and w_C count, by_turn (2, 3), which is added to slope."""
    n, rate = joint.parent, 0.0
    last[0] = s
    for i in range(3):
        for k in range(4):
            if n > 0:
                slope[3 + k] += by_turn[0, i] * G[0, i, k]
            slope[n + 3 + k] += by_turn[1, i] * G[1, i, k]
    for i in range(n + joint.child):
        rate += slope[i] * v[i]
    return s, rate


@part
def _turn_of(joint, R):
    """Angle (rad, -pi to pi) about the axis of a hinge from the parent's x to the child's."""
    P, C, sine, cosine = joint.parent_turn, joint.child_turn, 0.0, 0.0
    for i in range(3):
        u = R[1, i, 0] * C[0, 0] + R[1, i, 1] * C[1, 0] + R[1, i, 2] * C[2, 0]
        cosine += u * (R[0, i, 0] * P[0, 0] + R[0, i, 1] * P[1, 0] + R[0, i, 2] * P[2, 0])
        sine += u * (R[0, i, 0] * P[0, 1] + R[0, i, 1] * P[1, 1] + R[0, i, 2] * P[2, 1])
    return math.atan2(sine, cosine)


@part
def _slide(joint, R, x, a, by_turn, slope):
    """How far (m) a slider has slid; by_turn, and slope by the places of the nodes, are filled."""
    d, arm, s, n = room1(3), room1(3), 0.0, joint.parent  # d: from the parent's node to the joint's point on the child
    for i in range(3):
        arm[i], on_parent = 0.0, 0.0
        for j in range(3):
            arm[i] += R[1, i, j] * joint.child_point[j]
            on_parent += R[0, i, j] * joint.parent_point[j]
        d[i] = x[1, i] + arm[i] - x[0, i]
        s += a[i] * (d[i] - on_parent)
    # The arm of the parent turns with it as the axis does: w . (a x (d - arm_P)) - a . (w x arm_P) = w . (a x d).
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        by_turn[0, i] = a[j] * d[k] - a[k] * d[j]
        by_turn[1, i] = arm[j] * a[k] - arm[k] * a[j]
        if n > 0:
            slope[i] = -a[i]
        slope[n + i] = a[i]
    return s


@part
def _act(joint, now, q, v, out):
    """`joint_loads.act`."""
    R, x, G = room3(2, 3, 3), room2(2, 3), room3(2, 3, 4)
    s, rate = _find(joint, (rows(now, TURNS, 2), q, v, out, R, x, G))
    if joint.kind >= ELASTIC:
        return
    force = total(joint, s, rate, now[ANCHOR], now[VALUE], now[RATE])
    for i in range(MOST):
        out[i] *= force
    if joint.kind == BALL and joint.damping > 0.0:
        _damp_across(joint, R, G, v, out)


@part
def _damp_across(joint, R, G, v, out):
    """Add the moment of a ball joint's damper that is not along the axis of its rotation."""
    a, w = room1(3), room1(3)
    _from_home(joint, R, a)
    n, rate = joint.parent, 0.0
    for i in range(3):
        w[i] = 0.0
        for k in range(4):
            w[i] += G[1, i, k] * v[n + 3 + k]
            if n > 0:
                w[i] -= G[0, i, k] * v[3 + k]
        rate += a[i] * w[i]
    for i in range(3):
        moment = -joint.damping * (w[i] - rate * a[i])
        for k in range(4):
            out[n + 3 + k] += moment * G[1, i, k]
            if n > 0:
                out[3 + k] -= moment * G[0, i, k]


provide(joint_loads.coordinate, JOINT, _coordinate)
provide(joint_loads.act, JOINT, _act)


@cache
def found_by(kind: int) -> int:
    """Address of what finds the coordinate of joints of a kind, which is compiled where it is not yet."""
    finds = {HINGE: _hinge, SLIDER: _slider, BALL: _ball, ELASTIC: _elastic, STRETCHING: _stretching}
    return address_of(finds[kind], _FIND, _FOUND)
