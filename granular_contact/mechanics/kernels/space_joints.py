"""Joint coordinates and generalised forces of hinges, sliders and ball joints in space; called by `joint_loads`.

A joint has a frame on the parent P and one on the child C; its axis a is the z of the parent's frame.

    hinge   s = angle about a from the parent's x to the child's x; whole turns are counted from the last accepted state
    slider  s = a . (x_C + arm_C - x_P - arm_P)
    ball    s = angle of the rotation from the parent's frame to the child's, 0 to pi; a is the axis of that rotation

x: position of a body's node; arm: from the node to the joint's point. A torque or force tau along s has the generalised
forces tau ds/dq. For hinges and balls ds/dt = a . (w_C - w_P), with w = G e' of the Euler parameters e (G: see
`sand.kernels.space_coordinates`). The spring of a ball has the moment -k s a, k times the rotation vector. It is smooth
at s = 0 and jumps at s = pi, where the shortest way back changes. The damper of a ball acts on the whole of w_C - w_P:
its part normal to a adds -c (w_C - w_P - a ds/dt). `joint_laws` gives forces along s. Arguments as in `joint_loads`,
with records of JOINT. Two more kinds connect the rigid elements of a flexible link:

    elastic      flexible link: the moment of `bending` for the rotation vector s a
    stretching   flexible link that stretches: also the force -(k s + d s') with s along the parent's x
"""

from __future__ import annotations

import math
from functools import cache

from numba import from_dtype, types

from granular_contact.jit.calls import address_of, caller
from granular_contact.jit.chosen import provide
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, copy, flat, room1
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
    times,
    turned,
    turned_back,
    vector,
    xyz,
)

BALL, ELASTIC, STRETCHING = 2, 3, 4  # kinds of joints, beside HINGE and SLIDER
# find: address of the function that evaluates the coordinate of its kind; parent, child: numbers of coordinates of
# their nodes, 0 for the ground; origins (m) and axes of the joint's frame in the frames of parent and child; reference:
# values that the nodes' coordinates are counted from; bends, damps, axial: K, D, and (k, d) of an elastic joint.
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
# Types of the arguments and results of `_hinge`, `_slider`, `_ball`, `_elastic` and `_stretching`.
_ARGUMENTS, _RESULTS = (from_dtype(JOINT), *[_ROW] * 4), types.UniTuple(types.float64, 2)
_find = caller("find", _ARGUMENTS, _RESULTS, JOINT)
ORIGIN = (0.0, 0.0, 0.0)


@part
def _bodies(joint, q):
    """Position (3,) m, axes (9,) and Euler parameters (4,) of the parent, perhaps the ground, and of the child."""
    n = joint.parent
    parent = _body(joint, q, 0) if n > 0 else (ORIGIN, ALONG_WORLD, UNTURNED)
    return parent, _body(joint, q, n)


@part
def _body(joint, q, i):
    """Position (3,) m, axes (9,) and Euler parameters (4,) of the body whose coordinates begin at i."""
    r = joint.reference
    e = q[i + 3] + r[i + 3], q[i + 4] + r[i + 4], q[i + 5] + r[i + 5], q[i + 6] + r[i + 6]
    return plus(vector(q, i), vector(r, i)), matrix_of(e), e


@part
def _frames(joint, parent, child):
    """Axes (9,) of the joint's frames on the parent and on the child, in the world frame."""
    return framed(parent[1], joint.parent_turn), framed(child[1], joint.child_turn)


@part
def _from_home(A, B):
    """Angle s (rad) and axis a (3,) of the rotation from a frame A (9,) to B (9,); a = 0 at s = 0 and s = pi."""
    # The sum of the cross products of the axes of A with those of B is 2 sin s a.
    double, cosine = ORIGIN, -1.0
    for k in range(3):
        a, b = column(A, k), column(B, k)
        double, cosine = plus(double, cross(a, b)), cosine + dot(a, b)
    sine = 0.5 * norm(double)
    return math.atan2(sine, 0.5 * cosine), times(0.5 / sine if sine > 0.0 else 0.0, double)


@part
def _coordinate(joint, last_angles, q, v, gradient):
    """Coordinate s (rad or m) and its rate, see `joint_loads.coordinate`; last_angles[0] becomes s."""
    return _find(joint, (last_angles, q, v, gradient))


@part
def _hinge(joint, last_angles, q, v, gradient):
    """`_coordinate` of a hinge."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    a, u = column(A, 2), column(B, 0)
    s = math.atan2(dot(u, column(A, 1)), dot(u, column(A, 0)))
    s += 2.0 * math.pi * round((last_angles[0] - s) / (2.0 * math.pi))
    clear(gradient)
    last_angles[0] = s
    return s, _add_turning(joint, times(-1.0, a), a, parent, child, v, gradient)


@part
def _ball(joint, last_angles, q, v, gradient):
    """`_coordinate` of a ball joint."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    s, a = _from_home(A, B)
    clear(gradient)
    last_angles[0] = s
    return s, _add_turning(joint, times(-1.0, a), a, parent, child, v, gradient)


@part
def _slider(joint, last_angles, q, v, gradient):
    """`_coordinate` of a slider."""
    parent, child = _bodies(joint, q)
    last_angles[0], rate = _displacement(joint, 2, parent, child, v, gradient)
    return last_angles[0], rate


@part
def _displacement(joint, k, parent, child, v, gradient):
    """Displacement s (m) of the child along axis k of the parent's joint frame, and its rate; fills the gradient."""
    a, n = column(framed(parent[1], joint.parent_turn), k), joint.parent
    arm = turned(child[1], xyz(joint.child_point))
    d = minus(plus(child[0], arm), parent[0])  # from the parent's node to the joint's point on the child
    s = dot(a, d) - dot(a, turned(parent[1], xyz(joint.parent_point)))
    clear(gradient)
    for i in range(3):
        if n > 0:
            gradient[i] = -a[i]
        gradient[n + i] = a[i]
    # The arm of the parent turns with it as the axis does: w . (a x (d - arm_P)) - a . (w x arm_P) = w . (a x d).
    return s, _add_turning(joint, cross(a, d), cross(arm, a), parent, child, v, gradient)


@part
def _elastic(joint, last_angles, q, v, out):
    """Fill out with the generalised forces of an elastic joint, in the place of a gradient; return zeros."""
    parent, child = _bodies(joint, q)
    clear(out)
    _bend(joint, parent, child, v, out)
    return 0.0, 0.0


@part
def _bend(joint, parent, child, v, out):
    """Add the generalised forces of the moment of an elastic joint to out."""
    A, B = _frames(joint, parent, child)
    s, a = _from_home(A, B)
    w = _relative(joint, parent, child, v)
    _add_moments(joint, turned(A, moment(times(s, turned_back(A, a)), turned_back(A, w), joint)), parent, child, out)


@part
def _stretching(joint, last_angles, q, v, out):
    """As `_elastic`, for a link that stretches."""
    parent, child = _bodies(joint, q)
    s, rate = _displacement(joint, 0, parent, child, v, out)
    last_angles[0], force = s, joint.axial[0] * s + joint.axial[1] * rate
    for i in range(MOST):
        out[i] *= -force
    _bend(joint, parent, child, v, out)
    return 0.0, 0.0


@part
def _relative(joint, parent, child, v):
    """Relative angular velocity w_C - w_P (3,) rad/s."""
    n = joint.parent
    w = spin_by(child[2], v[n + 3], vector(v, n + 4))
    return minus(w, spin_by(parent[2], v[3], vector(v, 4))) if n > 0 else w


@part
def _add_moment(m, e, i, out):
    """Add G^T m for a moment (3,) on a body with Euler parameters e, whose coordinates begin at i."""
    f = rates_of(e, m)
    for k in range(4):
        out[i + 3 + k] += 4.0 * f[k]


@part
def _add_moments(joint, m, parent, child, out):
    """Add the generalised forces of a moment (3,) on the child and of its reaction on the parent."""
    if joint.parent > 0:
        _add_moment(times(-1.0, m), parent[2], 0, out)
    _add_moment(m, child[2], joint.parent, out)


@part
def _add_turning(joint, by_parent, by_child, parent, child, v, gradient):
    """Add to the gradient the derivatives by Euler parameters, from ds/dw_P and ds/dw_C (3,); return the rate of s."""
    n, rate = joint.parent, 0.0
    if n > 0:
        _add_moment(by_parent, parent[2], 0, gradient)
    _add_moment(by_child, child[2], n, gradient)
    for i in range(n + joint.child):
        rate += gradient[i] * v[i]
    return rate


@part
def _act(joint, state, q, v, out):
    """Generalised forces of a joint in space, see `joint_loads.act`."""
    angles = room1(2)
    copy(angles, flat(state.last_angles))  # as in the plane
    s, rate = _find(joint, (angles, q, v, out))
    if joint.kind >= ELASTIC:
        return
    force = total(joint, s, rate, state.anchor, state.target, state.target_rate)
    for i in range(MOST):
        out[i] *= force
    if joint.kind == BALL and joint.damping > 0.0:
        _damp_across(joint, q, v, out)


@part
def _damp_across(joint, q, v, out):
    """Add the part of the moment of a ball joint's damper that is normal to the axis of the rotation."""
    parent, child = _bodies(joint, q)
    A, B = _frames(joint, parent, child)
    a, w = _from_home(A, B)[1], _relative(joint, parent, child, v)
    _add_moments(joint, times(-joint.damping, minus(w, times(dot(a, w), a))), parent, child, out)


provide(joint_loads.coordinate, JOINT, _coordinate)
provide(joint_loads.act, JOINT, _act)


@cache
def coordinate_address(kind: int) -> int:
    """Address of the function that evaluates the coordinate of a kind of joints; it is compiled at the first call."""
    functions = {HINGE: _hinge, SLIDER: _slider, BALL: _ball, ELASTIC: _elastic, STRETCHING: _stretching}
    return address_of(functions[kind], _ARGUMENTS, _RESULTS)
