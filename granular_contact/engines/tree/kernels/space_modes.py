"""A tree in space whose coordinates are in a subspace, s = Phi eta: links that bend in a few modes (Galerkin's method).

Phi (n, m) is constant: the shapes of a link's modes in the coordinates of the joints between its elements, and one
column of a single 1 for each other coordinate; none of what is prescribed, which moves by itself. The charts of those
joints stay where they began, so that their coordinates are the turns that Phi is of. With R that the joints lack, and
the matrix B and c of `space_tree` and `space_fold`, eta'' is found by Newton's method from

    Phi^T R = 0,    G = Phi^T (J^T B J + c) Phi,    J s'': the accelerations that the nodes have of s'' (`outward`).

G is small and dense. The time scheme and Anderson's acceleration are linear, so that all that they make of coordinates
in the subspace is in it again. Cost of a matrix: m (m + 60) n; of an iteration 2 m n more than that of the whole tree.
"""

from __future__ import annotations

from granular_contact.engines.tree.kernels.space_load import accept, prepare  # noqa: F401  # see `tree_calls`
from granular_contact.engines.tree.kernels.space_tree import BALL, LAST, inward, outward
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat, piece
from granular_contact.mechanics.kernels.step_error import fastest
from granular_contact.sand.kernels import space_sand as sand  # noqa: F401


@part
def iteration(of_q, of_v, w):
    """As `tree_load.iteration`."""
    if prepare(of_q, of_v, w):
        project(w)
        invert(w.inverse)
    solve(w)
    return fastest(flat(w.moved), w.lever)


@part
def move(s2, w):
    """Fill `moved` with the accelerations J s2 of the nodes."""
    along, moved = w.along, w.moved
    for i in range(s2.shape[0]):
        for k in range(6):
            moved[i, k] = along[i, k] * s2[i]
    outward(moved, w)


@part
def project(w):
    """Fill G, column by column; uses `moved`, `passed` and `change`."""
    G, shapes, body, asked = w.inverse, w.shapes, w.body, w.change
    moved, P = w.moved, w.passed
    for c in range(G.shape[0]):
        shape = piece(shapes, c, shapes.shape[1])
        move(shape, w)
        for i in range(P.shape[0]):
            for k in range(6):
                P[i, k] = 0.0
                for j in range(6):
                    P[i, k] += body[i, 6 * k + j] * moved[i, j]
        inward(P, asked, w)
        push_back(shape, asked, w)
        for r in range(G.shape[0]):
            G[r, c] = 0.0
            for i in range(asked.shape[0]):
                G[r, c] += shapes[r, i] * asked[i]


@part
def push_back(shape, asked, w):
    """Add c shape to what is asked of the coordinates."""
    nodes, stiffness, coupled = w.space_nodes, w.stiffness, w.coupled
    for i in range(nodes.shape[0]):
        first = i - LAST
        if nodes[i].kind != BALL:
            asked[i] += stiffness[i] * shape[i]
        elif nodes[i].which == LAST:
            for j in range(3):
                for k in range(3):
                    asked[first + j] += coupled[first + j, k] * shape[first + k]


@part
def invert(G):
    """Put the inverse of G (m, m) in its place, by elimination; no pivots, as it is near to a mass matrix."""
    m = G.shape[0]
    for p in range(m):
        pivot = 1.0 / G[p, p]
        G[p, p] = 1.0
        for k in range(m):
            G[p, k] *= pivot
        for r in range(m):
            if r != p:
                factor = G[r, p]
                G[r, p] = 0.0
                for k in range(m):
                    G[r, k] -= factor * G[p, k]


@part
def solve(w):
    """Fill the changes of accelerations, -Phi G^-1 Phi^T R, and how the nodes move with them."""
    shapes, inverse, rest = w.shapes, w.inverse, w.rest
    change, lacked = w.change, w.lacked
    clear(change)
    for r in range(lacked.shape[0]):
        lacked[r] = 0.0
        for i in range(rest.shape[0]):
            lacked[r] += shapes[r, i] * rest[i]
    for c in range(lacked.shape[0]):
        amplitude = 0.0
        for r in range(lacked.shape[0]):
            amplitude -= inverse[c, r] * lacked[r]
        for i in range(change.shape[0]):
            change[i] += shapes[c, i] * amplitude
    move(change, w)
