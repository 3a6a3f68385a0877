"""Springs, dampers and stops of ball joints in a tree, along the three coordinates u of their charts (`space_tree`).

With the rotation D = exp(u) H C P^T from home, in the frame of the parent, of the angle s in 0 to pi about the axis a,
and the angular velocity w = J(u) u' there, the child gets the moment

    M = F(s, a . w) a - c (w - (a . w) a),    tau = J^T M,

F: the law of the joint, with c in it (as in `mechanics.kernels.space_joints`). At s = 0 there is no axis, and nothing
but the damper acts.
"""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.space_arrays import nodes_of
from granular_contact.engines.tree.kernels.space_rotations import (
    by_vector,
    chart,
    dot,
    plus,
    product,
    quaternion,
    spin_of,
    times,
    unit,
    vector,
)
from granular_contact.engines.tree.kernels.space_tree import LAST, four
from granular_contact.engines.tree.kernels.tree_arrays import (
    COUPLED,
    EFFORT,
    HOME,
    LAWS,
    NODES,
    RATES,
    S,
    laws_of,
    row,
    rows,
)
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import rows as rows_of
from granular_contact.mechanics.kernels.joint_laws import total
from granular_contact.sand.kernels.lines import difference


@part
def torques(u, rate, home, from_home, law):
    """Tau (3,) at u with the rate u'; home: H; from_home: C P^T, quaternions."""
    of, q = chart(u), product(product(by_vector(u), home), from_home)
    sign, w = math.copysign(1.0, q[0]), spin_of(u, rate, of)
    sine = math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    a = times(sign / sine if sine > 0.0 else 0.0, (q[1], q[2], q[3]))
    along = dot(a, w)
    force = total(law, 2.0 * math.atan2(sine, abs(q[0])), along, 0.0, 0.0, 0.0)
    M = plus(times(force + law.damping * along, a), times(-law.damping, w))
    return (
        dot(spin_of(u, unit(0), of), M),
        dot(spin_of(u, unit(1), of), M),
        dot(spin_of(u, unit(2), of), M),
    )  # fmt: skip


@part
def push_balls(w):
    """Fill what acts along the coordinates of ball joints."""
    nodes, s, rates, effort = nodes_of(w, NODES), row(w, S), row(w, RATES), row(w, EFFORT)
    for i in range(nodes.shape[0]):
        if nodes[i].sprung:
            first = i - LAST
            given = quaternion(rows(w, HOME), i, 0), four(nodes[i].after), laws_of(w, LAWS)[i]
            tau = torques(vector(s, first), vector(rates, first), given[0], given[1], given[2])
            effort[first], effort[first + 1], effort[first + 2] = tau


@part
def stiffen_balls(fq, fv, w):
    """Fill c of ball joints, three rows of three; by differences, see `lines.differences`."""
    nodes, s, rates, coupled = nodes_of(w, NODES), row(w, S), row(w, RATES), rows(w, COUPLED)
    for i in range(nodes.shape[0]):
        if nodes[i].sprung:
            first, law = i - LAST, laws_of(w, LAWS)[i]
            home, turn = quaternion(rows(w, HOME), i, 0), four(nodes[i].after)
            u, rate, d = vector(s, first), vector(rates, first), difference(rows_of(s, first, 3), fq, fv)
            here = torques(u, rate, home, turn, law)
            for k in range(3):
                more = torques(plus(u, times(d * fq, unit(k))), plus(rate, times(d * fv, unit(k))), home, turn, law)
                for j in range(3):
                    coupled[first + j, k] = (here[j] - more[j]) / d
