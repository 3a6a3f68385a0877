"""What acts in ball joints of a tree, along the three coordinates u of their charts (`space_tree`).

With the rotation D = exp(u) H C P^T from home, in the frame of the parent, of the angle s in 0 to pi about the axis a,
and the angular velocity w = J(u) u' there, the child gets a moment M, and tau = J^T M. Of springs, dampers and stops

    M = F(s, a . w) a - c (w - (a . w) a),

F: the law of the joint, with c in it. At s = 0 there is no axis, and nothing but the damper acts. Between elements of
a link that bends M is P times the `moment` of `bending`, in the frame P of the joint, by the rotation vector s P^T a.

Compiled for trees with such joints alone, and called by address.
"""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.space_tree import LAST
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1
from granular_contact.jit.memory import rows as rows_of
from granular_contact.mechanics.kernels.bending import moment
from granular_contact.mechanics.kernels.joint_laws import total
from granular_contact.mechanics.kernels.space_rotations import (
    as_quaternion,
    exponential,
    jacobian_coefficients,
    jacobian_times,
    matrix_of,
    product,
    quaternion,
)
from granular_contact.sand.kernels.lines import difference
from granular_contact.sand.kernels.vectors import dot, fill, plus, seen, times, turned, vector

SPRUNG, ELASTIC = 1, 2  # of a node's `acts`: what its ball joint has


@part
def torques(u, rate, home, node, law):
    """Tau (3,) at u with the rate u'; home: H, a quaternion."""
    coefficients, q = jacobian_coefficients(u), product(product(exponential(u), home), as_quaternion(node.after))
    w, sine = jacobian_times(u, rate, coefficients), math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    a = times(math.copysign(1.0, q[0]) / sine if sine > 0.0 else 0.0, (q[1], q[2], q[3]))
    s = 2.0 * math.atan2(sine, abs(q[0]))
    if node.acts == ELASTIC:
        M = elastic(times(s, a), w, node)
    else:
        along = dot(a, w)
        force = total(law, s, along, 0.0, 0.0, 0.0)
        M = plus(times(force + law.damping * along, a), times(-law.damping, w))
    return jacobian_times(times(-1.0, u), M, coefficients)  # J(-u) = J^T


@part
def elastic(turn, w, node):
    """Moment between two elements of a link; turn: rotation vector from home, w: rad/s, all in the parent's frame."""
    P = matrix_of(as_quaternion(node.before))
    return turned(P, moment(seen(P, turn), seen(P, w), node))


@part
def push_balls(w):
    """Fill what acts along the coordinates of ball joints."""
    nodes, s, rates, effort = w.space_nodes, w.s, w.rates, w.effort
    for i in range(nodes.shape[0]):
        if nodes[i].acts:
            first, home = i - LAST, quaternion(w.home, i, 0)
            fill(torques(vector(s, first), vector(rates, first), home, nodes[i], w.laws[i]), effort, first)


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
