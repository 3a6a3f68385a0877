"""Forces on a tree of rigid bodies in space, their tangent, and one iteration of Newton's method.

The medium gets poses with Euler parameters e, and returns forces f = G^T M on them for a moment M
(`space_coordinates`). Since G G^T = 4, M = G f / 4, and a rotation by a small vector theta changes e by G^T theta / 4.
The tangent is transformed in the same way. Limit: the derivative of G is neglected, a term of at most fq M / 2.
"""

from __future__ import annotations

from granular_contact.engines.tree.kernels.space_elimination import eliminate, inertias, solve
from granular_contact.engines.tree.kernels.space_tree import node_accelerations, place, recentre, residuals
from granular_contact.engines.tree.kernels.tree_calls import (
    ball_efforts,
    ball_stiffness,
    sand_accept,
    sand_forces,
    sand_tangent,
)
from granular_contact.engines.tree.kernels.tree_joints import coordinate_efforts, joint_stiffness, move_anchors
from granular_contact.engines.tree.kernels.tree_newton import needs_matrix
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat, room2
from granular_contact.mechanics.kernels.space_rotations import quaternion, spin_by
from granular_contact.mechanics.kernels.step_error import fastest
from granular_contact.sand.kernels import space_sand as sand  # noqa: F401  # whose functions `tree_calls` takes
from granular_contact.sand.kernels.vectors import at, put, times

SIZE = 7  # coordinates of a pose


@part
def forces_on_nodes(w):
    """Place the nodes; fill the forces and moments on them, and the efforts along their coordinates."""
    nodes, force, of_sand, gravity = w.space_nodes, w.force, w.of_sand, w.gravity[0]
    place(w)
    clear(of_sand)
    sand_forces(of_sand, w)
    pose = w.pose
    for i in range(nodes.shape[0]):
        put(at(of_sand, i, 0), force, i, 0)
        put(moment(pose, i, of_sand[i, 3], at(of_sand, i, 4)), force, i, 3)
        force[i, 2] -= gravity * nodes[i].mass
    coordinate_efforts(w)
    ball_efforts(w)


@part
def moment(pose, i, f, g):
    """Moment G (f, g) / 4 of node i, from the generalised forces f and g (3,) on its Euler parameters."""
    return times(0.25, spin_by(quaternion(pose, i, 3), f, g))


@part
def tangent(fq, fv, w):
    """Fill B and c of `space_tree` at the state at which the nodes were placed last."""
    blocks, triplets, body, columns = w.blocks, w.triplets, w.body, room2(SIZE, 6)
    inertias(fv, w)
    count = sand_tangent(fq, fv, w)
    if count > 0:
        clear(blocks)
        for k in range(count):
            line, column = int(triplets[k, 0]), int(triplets[k, 1])
            i = line // SIZE
            blocks[i, SIZE * (line - SIZE * i) + column - SIZE * i] += triplets[k, 2]
        for i in range(blocks.shape[0]):
            turn(i, blocks, w.pose, columns, body)
    joint_stiffness(fq, fv, w)
    ball_stiffness(fq, fv, w)


@part
def turn(i, blocks, pose, columns, body):
    """Subtract the tangent (7, 7) of the forces on node i from its B, by rotations and moments; columns: work array."""
    for r in range(SIZE):
        for k in range(3):
            columns[r, k] = blocks[i, SIZE * r + k]
        g = blocks[i, SIZE * r + 4], blocks[i, SIZE * r + 5], blocks[i, SIZE * r + 6]
        put(moment(pose, i, blocks[i, SIZE * r + 3], g), columns, r, 3)
    for k in range(6):
        x = moment(pose, i, columns[3, k], (columns[4, k], columns[5, k], columns[6, k]))
        for r in range(3):
            body[i, 6 * r + k] -= columns[r, k]
            body[i, 6 * (3 + r) + k] -= x[r]


@part
def iteration(of_q, of_v, w):
    """See `tree_load.iteration`."""
    if prepare(of_q, of_v, w):
        eliminate(w)
    solve(w)
    return fastest(flat(w.node_change), w.lever)


@part(inline=True)  # a call costs 2 % of a run
def prepare(of_q, of_v, w):
    """Fill the residuals R, and also B and c if a new matrix is needed; return whether it is.

    B and c are computed first, because the medium keeps the forces that it computes along with them for
    `forces_on_nodes`.
    """
    renewed = needs_matrix(of_v, w)
    if renewed:
        place(w)
        tangent(of_q, of_v, w)
    forces_on_nodes(w)
    node_accelerations(w)
    residuals(w)
    return renewed


@part
def accept(w, history, begins):
    """See `tree_load.accept`; also restart the charts of ball joints at their new orientations."""
    place(w)
    sand_accept(w, history, begins)
    move_anchors(w)
    recentre(w)
