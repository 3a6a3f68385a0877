"""Articulated-body elimination of Newton's matrix of a tree in space, with inertias of 6 x 6.

The equations are those of `tree` (Featherstone 2008), for the accelerations of `space_tree`. The law of a ball joint
couples its three coordinates, so the joint is eliminated as a whole, with the inverse of its D (3, 3) = S . U + c.
Of the terms that turn with the change, the matrix includes the gyroscopic moment w x I w, which is large for a body
that spins fast.
"""

from __future__ import annotations

from granular_contact.engines.tree.kernels.space_tree import BALL, LAST, axes_of, momentum, pass_on
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, piece, room2
from granular_contact.sand.kernels.vectors import at, cross, dot, plus, unit, xyz


@part
def inertias(fv, w):
    """Fill B with the inertias and the tangent of w x I w, and c with zeros: the matrix without any forces."""
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
def eliminate(w):
    """Fill `space_factors` from B and c; B of each node then includes all nodes that it carries."""
    nodes, body, factors, arm = w.space_nodes, w.body, w.space_factors, w.arm
    T = room2(6, 6)
    for i in range(nodes.shape[0] - 1, -1, -1):
        if nodes[i].kind == BALL:
            if nodes[i].which != LAST:
                continue
            first = i - LAST
            _eliminate_ball(i, T, w)
        else:
            first = i
            _eliminate_one(i, T, w)
        for k in range(3):
            factors[first].arm[k] = arm[first, k]
        if nodes[first].parent >= 0:
            add_to_parent(T, at(arm, first, 0), piece(body, nodes[first].parent, 36))


@part
def _products(i, b, w):
    """Fill U, W and S of node i, from the B (36,) of its body."""
    along, f = w.along, w.space_factors[i]
    for k in range(6):
        of_u, of_w = 0.0, 0.0
        for j in range(6):
            of_u += b[6 * k + j] * along[i, j]
            of_w += b[6 * j + k] * along[i, j]
        f.u[k], f.w[k], f.s[k] = of_u, of_w, along[i, k]


@part
def _product(s, u):
    """Scalar product S . U of two coordinates, (6,) each."""
    total = 0.0
    for j in range(6):
        total += s[j] * u[j]
    return total


@part
def _eliminate_one(i, T, w):
    """Fill 1 / D of a hinge or slider, and T (6, 6) with B - U W / D."""
    b, f = piece(w.body, i, 36), w.space_factors[i]
    _products(i, b, w)
    d = _product(f.s, f.u) + w.stiffness[i]
    f.inverse[0] = 0.0 if w.prescribed[i] else 1.0 / d
    for j in range(6):
        share = f.u[j] * f.inverse[0]
        for k in range(6):
            T[j, k] = b[6 * j + k] - share * f.w[k]


@part
def _eliminate_ball(i, T, w):
    """As `_eliminate_one` for the ball joint whose last node is i; its D (3, 3) is S . U + c of three coordinates."""
    b, factors, coupled, D, first = piece(w.body, i, 36), w.space_factors, w.coupled, room2(3, 3), i - LAST
    for k in range(3):
        _products(first + k, b, w)
    for j in range(3):
        for k in range(3):
            D[j, k] = _product(factors[first + j].s, factors[first + k].u) + coupled[first + j, k]
    inverse = factors[first].inverse
    _invert(D, inverse)
    for j in range(6):
        for k in range(6):
            T[j, k] = b[6 * j + k]
        for n in range(3):
            share = 0.0
            for m in range(3):
                share += factors[first + m].u[j] * inverse[3 * m + n]
            for k in range(6):
                T[j, k] -= share * factors[first + n].w[k]


@part
def _invert(D, inverse):
    """Write the inverse of D (3, 3) into `inverse` (9,), row by row, by cross products of the rows of D."""
    a, b, c = at(D, 0, 0), at(D, 1, 0), at(D, 2, 0)
    columns = cross(b, c), cross(c, a), cross(a, b)
    determinant = dot(a, columns[0])
    for j in range(3):
        for k in range(3):
            inverse[3 * j + k] = columns[k][j] / determinant


@part
def add_to_parent(T, arm, parent):
    """Add X^T T X of a node, T (6, 6), to the B of its parent (36,); T is overwritten."""
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
    """See `tree.solve`."""
    nodes, factors, change = w.space_nodes, w.space_factors, w.change
    p, A = w.passed, w.node_change
    clear(p)
    for i in range(nodes.shape[0] - 1, -1, -1):
        count = 3 if nodes[i].kind == BALL else 1
        first = i - count + 1
        if nodes[i].kind == BALL and nodes[i].which != LAST:
            continue
        _inward_change(first, count, i, p, w)
        for j in range(count):
            for k in range(6):
                p[i, k] += factors[first + j].u[k] * change[first + j]
        if nodes[first].parent >= 0:
            pass_on(p, i, xyz(factors[first].arm), nodes[first].parent)
    for i in range(nodes.shape[0]):
        count = 3 if nodes[i].kind == BALL else 1
        first = i - count + 1
        if nodes[i].kind == BALL and nodes[i].which != LAST:
            continue
        q = nodes[first].parent
        for k in range(6):
            A[i, k] = A[q, k] if q >= 0 else 0.0
        x = cross(at(A, i, 3), xyz(factors[first].arm))
        for k in range(3):
            A[i, k] += x[k]
        _outward_change(first, count, i, A, w)
        for j in range(count):
            for k in range(6):
                A[i, k] += factors[first + j].s[k] * change[first + j]


@part
def _inward_change(first, count, i, p, w):
    """Set the changes of the coordinates of a joint to 1 / D (-R - S . p)."""
    factors, residual, change = w.space_factors, w.residual, w.change
    inverse = factors[first].inverse
    for j in range(count):
        change[first + j] = 0.0
    for k in range(count):
        g = -residual[first + k]
        for m in range(6):
            g -= factors[first + k].s[m] * p[i, m]
        for j in range(count):
            change[first + j] += inverse[3 * j + k] * g


@part
def _outward_change(first, count, i, A, w):
    """Subtract 1 / D W . A from the changes of the coordinates of a joint; A: change of its body's A without them."""
    factors, change = w.space_factors, w.change
    inverse = factors[first].inverse
    for k in range(count):
        g = 0.0
        for m in range(6):
            g += factors[first + k].w[m] * A[i, m]
        for j in range(count):
            change[first + j] -= inverse[3 * j + k] * g
