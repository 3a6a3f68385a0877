"""Newton's matrix of a tree in space, eliminated from its leaves to its root: articulated-body inertias of 6 x 6.

The equations of `tree` (Featherstone 2008), on the accelerations of `space_tree`. A ball joint is eliminated as a
whole, with the inverse of its D (3, 3) = S . U + c, since what acts in it couples its three coordinates. Of what turns
with a change the moment w x I w counts, as a body that spins fast has much of it.
"""

from __future__ import annotations

from granular_contact.engines.tree.kernels.space_tree import BALL, LAST, axes_of, momentum, pass_on
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, piece, room2
from granular_contact.sand.kernels.vectors import at, cross, dot, plus, unit, vector

# Columns of `joint`: U, W, 1 / D (of a ball joint the inverse (9,), with its first node), S, and the arm e + d from the
# parent's centre of mass.
U, W, INVERSE, ALONG_S, ARM_S, COLUMNS = 0, 6, 12, 21, 27, 30


@part
def inertias(fv, w):
    """Fill B and c with what they are without any forces but w x I w."""
    nodes, body, twist = w.space_nodes, w.body, w.twist
    clear(body)
    clear(w.stiffness)
    clear(w.coupled)
    for i in range(nodes.shape[0]):
        m = nodes[i].mass
        if not m > 0.0:
            continue
        R, spin = axes_of(w, i), at(twist, i, 3)
        body[i, 0] = body[i, 7] = body[i, 14] = m
        turning = momentum(w, i, R, spin)
        for k in range(3):
            column = momentum(w, i, R, unit(k))
            of_spin = plus(cross(unit(k), turning), cross(spin, column))
            for j in range(3):
                body[i, 6 * (3 + j) + 3 + k] = column[j] + fv * of_spin[j]


@part
def fold(w):
    """Fill `joint` from B and c; B of each node then has all that hangs on it."""
    nodes, body, joint, arm = w.space_nodes, w.body, w.joint, w.arm
    T = room2(6, 6)
    for i in range(nodes.shape[0] - 1, -1, -1):
        if nodes[i].kind == BALL:
            if nodes[i].which != LAST:
                continue
            first = i - LAST
            _fold_ball(i, T, w)
        else:
            first = i
            _fold_one(i, T, w)
        for k in range(3):
            joint[first, ARM_S + k] = arm[first, k]
        if nodes[first].parent >= 0:
            hang(T, at(arm, first, 0), piece(body, nodes[first].parent, 36))


@part
def _sides(i, b, w):
    """Fill U, W and S of node i by the B (36,) of its body."""
    along, f = w.along, piece(w.joint, i, COLUMNS)
    for k in range(6):
        of_u, of_w = 0.0, 0.0
        for j in range(6):
            of_u += b[6 * k + j] * along[i, j]
            of_w += b[6 * j + k] * along[i, j]
        f[U + k], f[W + k], f[ALONG_S + k] = of_u, of_w, along[i, k]


@part
def _across(joint, i, k):
    """S of node i times U of node k."""
    found = 0.0
    for j in range(6):
        found += joint[i, ALONG_S + j] * joint[k, U + j]
    return found


@part
def _fold_one(i, T, w):
    """Fill 1 / D of a hinge or slider, and T (6, 6) with B - U W / D."""
    b, joint = piece(w.body, i, 36), w.joint
    _sides(i, b, w)
    d = _across(joint, i, i) + w.stiffness[i]
    joint[i, INVERSE] = 0.0 if w.prescribed[i] else 1.0 / d
    for j in range(6):
        share = joint[i, U + j] * joint[i, INVERSE]
        for k in range(6):
            T[j, k] = b[6 * j + k] - share * joint[i, W + k]


@part
def _fold_ball(i, T, w):
    """As `_fold_one`, of a ball joint whose last node is i: D (3, 3) is S . U + c of its three coordinates."""
    b, joint, coupled, D, first = piece(w.body, i, 36), w.joint, w.coupled, room2(3, 3), i - LAST
    for k in range(3):
        _sides(first + k, b, w)
    for j in range(3):
        for k in range(3):
            D[j, k] = _across(joint, first + j, first + k) + coupled[first + j, k]
    _invert(D, piece(joint, first, COLUMNS))
    for j in range(6):
        for k in range(6):
            T[j, k] = b[6 * j + k]
        for n in range(3):
            share = 0.0
            for m in range(3):
                share += joint[first + m, U + j] * joint[first, INVERSE + 3 * m + n]
            for k in range(6):
                T[j, k] -= share * joint[first + n, W + k]


@part
def _invert(D, f):
    """Write the inverse of D (3, 3) into a row of `joint`."""
    a, b, c = at(D, 0, 0), at(D, 1, 0), at(D, 2, 0)
    columns = cross(b, c), cross(c, a), cross(a, b)
    whole = dot(a, columns[0])
    for j in range(3):
        for k in range(3):
            f[INVERSE + 3 * j + k] = columns[k][j] / whole


@part
def hang(T, arm, parent):
    """Add X^T T X of a node, T (6, 6), to the B of its parent (36,); T is used up."""
    for i in range(6):
        x = cross(arm, at(T, i, 0))
        for k in range(3):
            T[i, 3 + k] += x[k]
    for k in range(6):
        x = cross(arm, (T[0, k], T[1, k], T[2, k]))
        for i in range(3):
            parent[6 * i + k] += T[i, k]
            parent[6 * (3 + i) + k] += T[3 + i, k] + x[i]


@part
def solve(w):
    """As `tree.solve`."""
    nodes, joint, change = w.space_nodes, w.joint, w.change
    p, A = w.passed, w.moved
    clear(p)
    for i in range(nodes.shape[0] - 1, -1, -1):
        count = 3 if nodes[i].kind == BALL else 1
        first = i - count + 1
        if nodes[i].kind == BALL and nodes[i].which != LAST:
            continue
        _weigh(first, count, i, p, w)
        for j in range(count):
            for k in range(6):
                p[i, k] += joint[first + j, U + k] * change[first + j]
        if nodes[first].parent >= 0:
            pass_on(p, i, vector(piece(joint, first, COLUMNS), ARM_S), nodes[first].parent)
    for i in range(nodes.shape[0]):
        count = 3 if nodes[i].kind == BALL else 1
        first = i - count + 1
        if nodes[i].kind == BALL and nodes[i].which != LAST:
            continue
        q = nodes[first].parent
        for k in range(6):
            A[i, k] = A[q, k] if q >= 0 else 0.0
        x = cross(at(A, i, 3), vector(piece(joint, first, COLUMNS), ARM_S))
        for k in range(3):
            A[i, k] += x[k]
        _follow(first, count, i, A, w)
        for j in range(count):
            for k in range(6):
                A[i, k] += joint[first + j, ALONG_S + k] * change[first + j]


@part
def _weigh(first, count, i, p, w):
    """Set the changes of the coordinates of a joint to 1 / D (-R - S . p)."""
    joint, rest, change = w.joint, w.rest, w.change
    for j in range(count):
        change[first + j] = 0.0
    for k in range(count):
        g = -rest[first + k]
        for m in range(6):
            g -= joint[first + k, ALONG_S + m] * p[i, m]
        for j in range(count):
            change[first + j] += joint[first, INVERSE + 3 * j + k] * g


@part
def _follow(first, count, i, A, w):
    """Take 1 / D W . A off the changes of the coordinates of a joint, with A of the body before they count."""
    joint, change = w.joint, w.change
    for k in range(count):
        g = 0.0
        for m in range(6):
            g += joint[first + k, W + m] * A[i, m]
        for j in range(count):
            change[first + j] -= joint[first, INVERSE + 3 * j + k] * g
