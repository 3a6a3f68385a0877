"""Tree in space whose links bend in a few modes: Galerkin projection of its coordinates, s = Phi eta.

Phi (n, m) is constant. It has the mode shapes of links, in the coordinates of the joints between their elements, and
one unit column for each other coordinate but prescribed ones, which move by their signals. The charts of the joints
between elements stay at their home orientation, so that their coordinates are the rotations that Phi describes. With
the residuals R, and the matrix B and c of `space_tree` and `space_elimination`, Newton's method solves for eta'':

    Phi^T R = 0,    G = Phi^T (J^T B J + c) Phi,    J s'': accelerations of the nodes for given s'' (`outward`).

G is small and dense. The time scheme and Anderson acceleration are linear in the coordinates, so that coordinates stay
in the subspace. Cost: m (m + 60) n for a matrix; an iteration costs 2 m n more than one of the whole tree.
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
    """See `tree_load.iteration`."""
    if prepare(of_q, of_v, w):
        project(w)
        invert(w.inverse)
    solve(w)
    return fastest(flat(w.node_change), w.lever)


@part
def move(s2, w):
    """Fill `node_change` with J s2, the accelerations of the nodes for the accelerations s2 of the coordinates."""
    along, node_change = w.along, w.node_change
    for i in range(s2.shape[0]):
        for k in range(6):
            node_change[i, k] = along[i, k] * s2[i]
    outward(node_change, w)


@part
def project(w):
    """Fill G, column by column; overwrites `node_change`, `passed` and `change`."""
    G, shapes, body, efforts = w.inverse, w.shapes, w.body, w.change
    node_change, P = w.node_change, w.passed
    for c in range(G.shape[0]):
        shape = piece(shapes, c, shapes.shape[1])
        move(shape, w)
        for i in range(P.shape[0]):
            for k in range(6):
                P[i, k] = 0.0
                for j in range(6):
                    P[i, k] += body[i, 6 * k + j] * node_change[i, j]
        inward(P, efforts, w)
        joint_forces(shape, efforts, w)
        for r in range(G.shape[0]):
            G[r, c] = 0.0
            for i in range(efforts.shape[0]):
                G[r, c] += shapes[r, i] * efforts[i]


@part
def joint_forces(shape, efforts, w):
    """Add c shape, the stiffness forces of the joints, to the forces along the coordinates."""
    nodes, stiffness, coupled = w.space_nodes, w.stiffness, w.coupled
    for i in range(nodes.shape[0]):
        first = i - LAST
        if nodes[i].kind != BALL:
            efforts[i] += stiffness[i] * shape[i]
        elif nodes[i].which == LAST:
            for j in range(3):
                for k in range(3):
                    efforts[first + j] += coupled[first + j, k] * shape[first + k]


@part
def invert(G):
    """Replace G (m, m) by its inverse, by Gauss-Jordan elimination without pivoting, as G is close to a mass matrix."""
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
    """Fill the changes of the accelerations, -Phi G^-1 Phi^T R, and the changes of the nodes."""
    shapes, inverse, residual = w.shapes, w.inverse, w.residual
    change, projected = w.change, w.projected
    clear(change)
    for r in range(projected.shape[0]):
        projected[r] = 0.0
        for i in range(residual.shape[0]):
            projected[r] += shapes[r, i] * residual[i]
    for c in range(projected.shape[0]):
        amplitude = 0.0
        for r in range(projected.shape[0]):
            amplitude -= inverse[c, r] * projected[r]
        for i in range(change.shape[0]):
            change[i] += shapes[c, i] * amplitude
    move(change, w)
