"""Coordinates of hinges, sliders and ball joints between rigid bodies in space, and forces; called by `joint_loads`.

A joint's frame lies at a point of the parent P and of the child C; its z is the axis a, which turns with the parent.

    hinge   s = angle about a from the parent's x to the child's, in the turn that was found last
    slider  s = a . (x_C + arm_C - x_P - arm_P)
    ball    s = angle of the rotation from the parent's frame to the child's, 0 to pi; a is its axis

x: position of a body's node, arm: from it to the joint's point. A torque or force tau along s is tau ds/dq on the
coordinates: with w = G e' (see `space_coordinates`) of hinges and balls ds/dt = a . (w_C - w_P). The spring of a ball
has the moment -k s a, k times the rotation vector, which is smooth at s = 0; at pi, where the way back may go either
way round, it jumps. Its damper acts on all of w_C - w_P: what is not along a adds -c (w_C - w_P - a ds/dt). Forces
along s are those of `joint_laws`; arguments as of `joint_loads`, with records of JOINT.

    elastic   between elements of a link that bends: the moment of `bending` by the rotation vector s a
    stretching   the same, of a link that stretches: with s along the parent's x, a force -(k s + d s') as well
"""

from __future__ import annotations

import math
from functools import cache

from numba import from_dtype, types

from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.chosen import provide
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat
from granular_contact.jit.records import record_dtype
from granular_contact.mechanics.kernels import joint_loads
from granular_contact.mechanics.kernels.bending import moment
from granular_contact.mechanics.kernels.joint_coordinates import HINGE, SLIDER
from granular_contact.mechanics.kernels.joint_laws import total
from granular_contact.mechanics.kernels.joint_loads import DRIVE, LAW, MOST
from granular_contact.mechanics.kernels.space_rotations import ALONG_WORLD, UNTURNED, matrix_of, rates_of, spin_by
from granular_contact.sand.kernels.vectors import (
    column,
    cross,
    dot,
    framed,
    minus,
    norm,
    plus,
    seen,
    times,
    turned,
    vector,
)

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
_ROW = types.Array(types.float64, 1, "C")
_FIND, _FOUND = (from_dtype(JOINT), *[_ROW] * 4), types.UniTuple(types.float64, 2)  # of `_hinge` and its like
_find = caller("find", _FIND, _FOUND, JOINT)
ORIGIN = (0.0, 0.0, 0.0)


@part
def _bodies(joint, q):
    """Position (3,) m, axes (9,) and Euler parameters (4,) of the parent, which may be the ground, and of the child."""
    n = joint.parent
    parent = _body(joint, q, 0) if n > 0 else (ORIGIN, ALONG_WORLD, UNTURNED)
    return parent, _body(joint, q, n)


@part
def _body(joint, q, i):
    """Position, axes and Euler parameters of the body whose coordinates begin at i."""
    r = joint.reference
    e = q[i + 3] + r[i + 3], q[i + 4] + r[i + 4], q[i + 5] + r[i + 5], q[i + 6] + r[i + 6]
    return plus(vector(q, i), vector(r, i)), matrix_of(e), e


@part
def _frames(joint, parent, child):
    """Axes (9,) of the joint's frame on the parent and on the child."""
    return framed(parent[1], joint.parent_turn), framed(child[1], joint.child_turn)


@part
def _from_home(A, B):
    """Angle (rad) and axis (3,) of the rotation from a frame A to B (9,); without an angle the axis is zero."""
    # The sum of the cross products of each axis of the parent's frame with that of the child's is 2 sin s a.
    double, cosine = ORIGIN, -1.0
    for k in range(3):
        a, b = column(A, k), column(B, k)
        double, cosine = plus(double, cross(a, b)), cosine + dot(a, b)
    sine = 0.5 * norm(double)
    return math.atan2(sine, 0.5 * cosine), times(0.5 / sine if sine > 0.0 else 0.0, double)


@part
def _coordinate(joint, turns, q, v, slope):
    """`joint_loads.coordinate` (rad or m); turns[0] becomes that found here."""
    return _find(joint, (turns, q, v, slope))


@part
def _hinge(joint, last, q, v, slope):
    """`_coordinate` of a hinge."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    a, u = column(A, 2), column(B, 0)
    s = math.atan2(dot(u, column(A, 1)), dot(u, column(A, 0)))
    s += 2.0 * math.pi * round((last[0] - s) / (2.0 * math.pi))
    clear(slope)
    return _found(joint, last, s, times(-1.0, a), a, parent, child, v, slope)


@part
def _ball(joint, last, q, v, slope):
    """As `_hinge`, of a ball joint."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    s, a = _from_home(A, B)
    clear(slope)
    return _found(joint, last, s, times(-1.0, a), a, parent, child, v, slope)


@part
def _slider(joint, last, q, v, slope):
    """As `_hinge`, of a slider."""
    parent, child = _bodies(joint, q)
    return _slid(joint, 2, last, parent, child, v, slope)


@part
def _slid(joint, k, last, parent, child, v, slope):
    """How far (m) a joint has slid along axis k of the parent's frame, and its rate; slope is filled."""
    a, n = column(framed(parent[1], joint.parent_turn), k), joint.parent
    arm = turned(child[1], vector(joint.child_point, 0))
    d = minus(plus(child[0], arm), parent[0])  # from the parent's node to the joint's point on the child
    s = dot(a, d) - dot(a, turned(parent[1], vector(joint.parent_point, 0)))
    clear(slope)
    for i in range(3):
        if n > 0:
            slope[i] = -a[i]
        slope[n + i] = a[i]
    # The arm of the parent turns with it as the axis does: w . (a x (d - arm_P)) - a . (w x arm_P) = w . (a x d).
    return _found(joint, last, s, cross(a, d), cross(arm, a), parent, child, v, slope)


@part
def _elastic(joint, last, q, v, slope):
    """Fill slope with the generalised forces of an elastic joint; arguments as of `_hinge`, returns zeros."""
    parent, child = _bodies(joint, q)
    clear(slope)
    _bend(joint, parent, child, v, slope)
    return 0.0, 0.0


@part
def _bend(joint, parent, child, v, out):
    """Add what an elastic joint does to its bodies."""
    A, B = _frames(joint, parent, child)
    s, a = _from_home(A, B)
    w = _relative(joint, parent, child, v)
    _push(joint, turned(A, moment(times(s, seen(A, a)), seen(A, w), joint)), parent, child, out)


@part
def _stretching(joint, last, q, v, slope):
    """As `_elastic`, of a link that stretches."""
    parent, child = _bodies(joint, q)
    s, rate = _slid(joint, 0, last, parent, child, v, slope)
    force = joint.axial[0] * s + joint.axial[1] * rate
    for i in range(MOST):
        slope[i] *= -force
    _bend(joint, parent, child, v, slope)
    return 0.0, 0.0


@part
def _relative(joint, parent, child, v):
    """Angular velocity (3,) rad/s of the child less that of the parent."""
    n = joint.parent
    w = spin_by(child[2], v[n + 3], vector(v, n + 4))
    return minus(w, spin_by(parent[2], v[3], vector(v, 4))) if n > 0 else w


@part
def _turn(m, e, i, out):
    """Add G^T m of a moment (3,) on a body with Euler parameters e, whose coordinates begin at i."""
    f = rates_of(e, m)
    for k in range(4):
        out[i + 3 + k] += 4.0 * f[k]


@part
def _push(joint, m, parent, child, out):
    """Add the generalised forces of a moment (3,) on the child, and of its opposite on the parent."""
    if joint.parent > 0:
        _turn(times(-1.0, m), parent[2], 0, out)
    _turn(m, child[2], joint.parent, out)


@part
def _found(joint, last, s, by_parent, by_child, parent, child, v, slope):
    """Coordinate and rate, once it is known by what (3,) w_P and w_C count, of which the gradient is added to slope."""
    n, rate = joint.parent, 0.0
    last[0] = s
    if n > 0:
        _turn(by_parent, parent[2], 0, slope)
    _turn(by_child, child[2], n, slope)
    for i in range(n + joint.child):
        rate += slope[i] * v[i]
    return s, rate


@part
def _act(joint, state, q, v, out):
    """`joint_loads.act`."""
    s, rate = _find(joint, (flat(state.last_angles), q, v, out))
    if joint.kind >= ELASTIC:
        return
    force = total(joint, s, rate, state.anchor, state.target, state.target_rate)
    for i in range(MOST):
        out[i] *= force
    if joint.kind == BALL and joint.damping > 0.0:
        _damp_across(joint, q, v, out)


@part
def _damp_across(joint, q, v, out):
    """Add the moment of a ball joint's damper that is not along the axis of its rotation."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    a, w = _from_home(A, B)[1], _relative(joint, parent, child, v)
    _push(joint, times(-joint.damping, minus(w, times(dot(a, w), a))), parent, child, out)


provide(joint_loads.coordinate, JOINT, _coordinate)
provide(joint_loads.act, JOINT, _act)


@cache
def found_by(kind: int) -> int:
    """Address of what finds the coordinate of joints of a kind, which is compiled where it is not yet."""
    finds = {HINGE: _hinge, SLIDER: _slider, BALL: _ball, ELASTIC: _elastic, STRETCHING: _stretching}
    return address_of(finds[kind], _FIND, _FOUND)
