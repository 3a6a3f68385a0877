"""Forces on a tree of rigid bodies in the plane, their tangent, and one iteration of Newton's method."""

from __future__ import annotations

from granular_contact.engines.tree.kernels.tree import eliminate, inertias, node_accelerations, place, residuals, solve
from granular_contact.engines.tree.kernels.tree_calls import sand_accept, sand_forces, sand_tangent
from granular_contact.engines.tree.kernels.tree_joints import coordinate_efforts, joint_stiffness, move_anchors
from granular_contact.engines.tree.kernels.tree_newton import needs_matrix
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat
from granular_contact.mechanics.kernels.step_error import fastest
from granular_contact.sand.kernels import planar_sand as sand  # noqa: F401  # whose functions `tree_calls` takes


@part
def forces_on_nodes(w):
    """Place the nodes; fill the forces on them, and the efforts along their coordinates."""
    nodes, force, gravity = w.nodes, w.force, w.gravity[0]
    place(w)
    clear(force)
    sand_forces(force, w)
    for i in range(nodes.shape[0]):
        force[i, 1] -= gravity * nodes[i].mass
    coordinate_efforts(w)


@part
def tangent(fq, fv, w):
    """Fill B and c of `tree` at the state of the last `forces_on_nodes`."""
    body, triplets = w.body, w.triplets
    inertias(w)
    for k in range(sand_tangent(fq, fv, w)):
        line, column = int(triplets[k, 0]), int(triplets[k, 1])
        i = line // 3
        body[i, 3 * (line - 3 * i) + column - 3 * i] -= triplets[k, 2]
    joint_stiffness(fq, fv, w)


@part
def iteration(of_q, of_v, w):
    """One iteration of Newton's method: fill the change of s''; return the largest change of a point (m/s2)."""
    forces_on_nodes(w)
    node_accelerations(w)
    residuals(w)
    if needs_matrix(of_v, w):
        tangent(of_q, of_v, w)
        eliminate(w)
    solve(w)
    return fastest(flat(w.node_change), w.lever)


@part
def accept(w, history, begins):
    """End a step: move the anchors of friction, and add forces and depth of the medium to a history row.

    begins: whether a motion begins here instead, without any stretched bristle.
    """
    place(w)
    sand_accept(w, history, begins)
    move_anchors(w)
