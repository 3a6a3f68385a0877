"""Laws of ball joints of a tree: efforts tau along the three coordinates u of their charts (`space_tree`).

P and C are the rotation matrices of the joint's frame in the frames of the parent and of the child. At home the two
coincide. D = exp(u) H C P^T is the rotation of the child from home, in the frame of the parent: by the angle s in
[0, pi] about the axis a. J(u) u' = w is the angular velocity in that frame. The child gets a moment M, and
tau = J^T M. Springs, dampers and stops have

    M = F(s, a . w) a - c (w - (a . w) a),

where F is the law of the joint, with its damping c. At s = 0 the axis is undefined, and only the damper acts. Between
elements of a link that bends, M is the `moment` of `bending` in the frame P of the joint, for the rotation vector s P^T
a, turned back by P.

Compiled only for trees with such joints, and called by address.
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
from granular_contact.sand.kernels.vectors import dot, fill, plus, times, turned, turned_back, vector, xyz

SPRUNG, ELASTIC = 1, 2  # field `acts` of a node: a law of the joint, or a link that bends


@part
def torques(u, rate, home, node, law):
    """Efforts tau (3,) at the coordinates u with the rates u'; home: the quaternion H."""
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
    """Moment (N m) between elements of a link, in the parent's frame; turn: rotation vector from home, w (rad/s)."""
    P = matrix_of(as_quaternion(node.before))
    return turned(P, moment(turned_back(P, turn), turned_back(P, w), node))


@part
def ball_efforts(w):
    """Fill the efforts along the coordinates of ball joints."""
    nodes, s, rates, effort = w.space_nodes, w.s, w.rates, w.effort
    for i in range(nodes.shape[0]):
        if nodes[i].acts:
            first, home = i - LAST, quaternion(w.home, i, 0)
            fill(torques(vector(s, first), vector(rates, first), home, nodes[i], w.laws[i]), effort, first)


@part
def ball_stiffness(fq, fv, w):
    """Fill c (3, 3) of ball joints, three rows of `coupled` each; by finite differences, see `lines.differences`."""
    nodes, s, rates, coupled = w.space_nodes, w.s, w.rates, w.coupled
    u, rate = room1(3), room1(3)
    for i in range(nodes.shape[0]):
        if not nodes[i].acts:
            continue
        first, law, home = i - LAST, w.laws[i], quaternion(w.home, i, 0)
        d = difference(rows_of(s, first, 3), fq, fv)
        present = torques(vector(s, first), vector(rates, first), home, nodes[i], law)
        for k in range(3):
            for j in range(3):
                u[j], rate[j] = s[first + j], rates[first + j]
            u[k], rate[k] = u[k] + d * fq, rate[k] + d * fv
            moved = torques(xyz(u), xyz(rate), home, nodes[i], law)
            for j in range(3):
                coupled[first + j, k] = (present[j] - moved[j]) / d
