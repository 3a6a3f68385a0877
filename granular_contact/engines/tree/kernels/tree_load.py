"""Forces on a tree of rigid bodies in the plane, how they follow its motion, and an iteration of Newton's method."""

from __future__ import annotations

from granular_contact.engines.tree.kernels.tree import carry, fold, inertias, lack, place, solve
from granular_contact.engines.tree.kernels.tree_calls import sand_accept, sand_force, sand_tangent
from granular_contact.engines.tree.kernels.tree_joints import follow, push, stiffen
from granular_contact.engines.tree.kernels.tree_newton import needs_matrix
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat
from granular_contact.mechanics.kernels.step_error import fastest
from granular_contact.sand.kernels import planar_sand as sand  # noqa: F401  # whose functions `tree_calls` takes


@part
def act(w):
    """Place the nodes, and fill the forces on them and along their coordinates."""
    nodes, force, gravity = w.nodes, w.force, w.gravity[0]
    place(w)
    clear(force)
    sand_force(force, w)
    for i in range(nodes.shape[0]):
        force[i, 1] -= gravity * nodes[i].mass
    push(w)


@part
def tangent(fq, fv, w):
    """Fill B and c of `tree` where `act` was called last."""
    body, triplets = w.body, w.triplets
    inertias(w)
    for k in range(sand_tangent(fq, fv, w)):
        line, column = int(triplets[k, 0]), int(triplets[k, 1])
        i = line // 3
        body[i, 3 * (line - 3 * i) + column - 3 * i] -= triplets[k, 2]
    stiffen(fq, fv, w)


@part
def iteration(of_q, of_v, w):
    """Find what joints lack at the present accelerations, and the change that takes it away; its size (m/s2)."""
    act(w)
    carry(w)
    lack(w)
    if needs_matrix(of_v, w):
        tangent(of_q, of_v, w)
        fold(w)
    solve(w)
    return fastest(flat(w.moved), w.lever)


@part
def accept(w, history, begins):
    """End of a step: anchors follow, forces of the medium and depth go into a history row.

    begins: whether a motion begins here instead, without any stretched bristle.
    """
    place(w)
    sand_accept(w, history, begins)
    follow(w)
