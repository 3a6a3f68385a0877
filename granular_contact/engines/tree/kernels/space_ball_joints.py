"""What acts in ball joints of a tree, along the three coordinates u of their charts (`space_tree`).

With the rotation D = exp(u) H C P^T from home, in the frame of the parent, of the angle s in 0 to pi about the axis a,
and the angular velocity w = J(u) u' there, the child gets a moment M, and tau = J^T M. Of springs, dampers and stops

    M = F(s, a . w) a - c (w - (a . w) a),

F: the law of the joint, with c in it. At s = 0 there is no axis, and nothing but the damper acts. Between elements of
a link that bends, in the frame P of the joint with the rotation vector t = s P^T a and its map T (`space_joints`),

    M = -P T^-T (K t + D T^-1 P^T w),    T^-1 = 1 - t^ / 2 + c t^ t^.

Compiled for trees with such joints alone, and called by address.
"""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.space_rotations import (
    by_vector,
    chart,
    four,
    matrix_of,
    plus,
    product,
    quaternion,
    spin_of,
    times,
    vector,
)
from granular_contact.engines.tree.kernels.space_tree import LAST
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.jit.memory import rows as rows_of
from granular_contact.mechanics.kernels.joint_laws import total
from granular_contact.sand.kernels.lines import difference
from granular_contact.sand.kernels.vectors import cross, dot, seen, turned

SPRUNG, ELASTIC = 1, 2  # of a node's `acts`: what its ball joint has
SMALL = 1e-2  # rad, below which c is taken from its series


@part
def torques(u, rate, home, node, law):
    """Tau (3,) at u with the rate u'; home: H, a quaternion."""
    of, q = chart(u), product(product(by_vector(u), home), four(node.after))
    w, sine = spin_of(u, rate, of), math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    a = times(math.copysign(1.0, q[0]) / sine if sine > 0.0 else 0.0, (q[1], q[2], q[3]))
    s = 2.0 * math.atan2(sine, abs(q[0]))
    if node.acts == ELASTIC:
        M = elastic(times(s, a), w, node)
    else:
        along = dot(a, w)
        force = total(law, s, along, 0.0, 0.0, 0.0)
        M = plus(times(force + law.damping * along, a), times(-law.damping, w))
    return spin_of(times(-1.0, u), M, of)  # J(-u) = J^T


@part
def elastic(turn, w, node):
    """Moment between two elements of a link; turn: rotation vector from home, w: rad/s, all in the parent's frame."""
    P = matrix_of(four(node.before))
    t, w, square = seen(P, turn), seen(P, w), dot(turn, turn)
    s = math.sqrt(square)
    c = 1.0 / 12.0 + square / 720.0 if s < SMALL else (1.0 - 0.5 * s / math.tan(0.5 * s)) / square
    v, K, D = mapped(t, w, -0.5, c), node.bends, node.damps
    f = K[0] * t[0] + D[0] * v[0], K[1] * t[1] + D[1] * v[1], K[2] * t[2] + D[2] * v[2]
    return times(-1.0, turned(P, mapped(t, f, 0.5, c)))


@part
def mapped(t, a, half, c):
    """A + half t x a + c t x (t x a)."""
    x = cross(t, a)
    return plus(a, plus(times(half, x), times(c, cross(t, x))))


@part
def push_balls(w):
    """Fill what acts along the coordinates of ball joints."""
    nodes, s, rates, effort = w.space_nodes, w.s, w.rates, w.effort
    for i in range(nodes.shape[0]):
        if nodes[i].acts:
            first, home = i - LAST, quaternion(w.home, i, 0)
            tau = torques(vector(s, first), vector(rates, first), home, nodes[i], w.laws[i])
            effort[first], effort[first + 1], effort[first + 2] = tau


@part
def stiffen_balls(fq, fv, w):
    """Fill c of ball joints, three rows of three; by differences, see `lines.differences`."""
    nodes, s, rates, coupled = w.space_nodes, w.s, w.rates, w.coupled
    u, rate = room1(3), room1(3)
    for i in range(nodes.shape[0]):
        if not nodes[i].acts:
            continue
        first, law, home = i - LAST, w.laws[i], quaternion(w.home, i, 0)
        d = difference(rows_of(s, first, 3), fq, fv)
        here = torques(vector(s, first), vector(rates, first), home, nodes[i], law)
        for k in range(3):
            for j in range(3):
                u[j], rate[j] = s[first + j], rates[first + j]
            u[k], rate[k] = u[k] + d * fq, rate[k] + d * fv
            moved = torques(vector(u, 0), vector(rate, 0), home, nodes[i], law)
            for j in range(3):
                coupled[first + j, k] = (here[j] - moved[j]) / d
