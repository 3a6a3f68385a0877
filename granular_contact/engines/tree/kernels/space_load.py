"""Forces on a tree of rigid bodies in space, how they follow its motion, and an iteration of Newton's method.

The medium sees poses with Euler parameters e, and gives forces f = G^T M of a moment M (`space_coordinates`).
With G G^T = 4: M = G f / 4, and a turn by a small vector changes e by G^T / 4 of it. The derivative of a moment is
taken so, too, without what of it comes from G alone, fq M / 2 or less.
"""

from __future__ import annotations

from granular_contact.engines.tree.kernels.space_fold import fold, inertias, solve
from granular_contact.engines.tree.kernels.space_tree import carry, lack, place, recentre
from granular_contact.engines.tree.kernels.tree_calls import (
    push_balls,
    sand_accept,
    sand_force,
    sand_tangent,
    stiffen_balls,
)
from granular_contact.engines.tree.kernels.tree_joints import follow, push, stiffen
from granular_contact.engines.tree.kernels.tree_newton import needs_matrix
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, flat, room2
from granular_contact.mechanics.kernels.space_rotations import quaternion, spin_by
from granular_contact.mechanics.kernels.step_error import fastest
from granular_contact.sand.kernels import space_sand as sand  # noqa: F401  # whose functions `tree_calls` takes
from granular_contact.sand.kernels.vectors import at, put, times

SIZE = 7  # coordinates of a pose


@part
def act(w):
    """Place the nodes, and fill the forces on them and along their coordinates."""
    nodes, force, of_sand, gravity = w.space_nodes, w.force, w.of_sand, w.gravity[0]
    place(w)
    clear(of_sand)
    sand_force(of_sand, w)
    pose = w.pose
    for i in range(nodes.shape[0]):
        put(at(of_sand, i, 0), force, i, 0)
        put(moment(pose, i, of_sand[i, 3], at(of_sand, i, 4)), force, i, 3)
        force[i, 2] -= gravity * nodes[i].mass
    push(w)
    push_balls(w)


@part
def moment(pose, i, f, g):
    """G (f, g) / 4 of node i: the moment of generalised forces f and g (3,) on its Euler parameters."""
    return times(0.25, spin_by(quaternion(pose, i, 3), f, g))


@part
def tangent(fq, fv, w):
    """Fill B and c of `space_tree` where the nodes were placed last."""
    blocks, triplets, body, some = w.blocks, w.triplets, w.body, room2(SIZE, 6)
    inertias(fv, w)
    count = sand_tangent(fq, fv, w)
    if count > 0:
        clear(blocks)
        for k in range(count):
            line, column = int(triplets[k, 0]), int(triplets[k, 1])
            i = line // SIZE
            blocks[i, SIZE * (line - SIZE * i) + column - SIZE * i] += triplets[k, 2]
        for i in range(blocks.shape[0]):
            turn(i, blocks, w.pose, some, body)
    stiffen(fq, fv, w)
    stiffen_balls(fq, fv, w)


@part
def turn(i, blocks, pose, some, body):
    """Take the tangent (7, 7) of the forces on node i from its B, as one on turns and of moments; some (7, 6): room."""
    for r in range(SIZE):
        for k in range(3):
            some[r, k] = blocks[i, SIZE * r + k]
        g = blocks[i, SIZE * r + 4], blocks[i, SIZE * r + 5], blocks[i, SIZE * r + 6]
        put(moment(pose, i, blocks[i, SIZE * r + 3], g), some, r, 3)
    for k in range(6):
        x = moment(pose, i, some[3, k], (some[4, k], some[5, k], some[6, k]))
        for r in range(3):
            body[i, 6 * r + k] -= some[r, k]
            body[i, 6 * (3 + r) + k] -= x[r]


@part
def iteration(of_q, of_v, w):
    """As `tree_load.iteration`."""
    if prepare(of_q, of_v, w):
        fold(w)
    solve(w)
    return fastest(flat(w.moved), w.lever)


@part(inline=True)  # a call costs 2 % of a run
def prepare(of_q, of_v, w):
    """Fill R, and B and c where a new matrix is asked for; whether it is.

    B and c come first, as the medium then keeps the forces that belong to them.
    """
    renewed = needs_matrix(of_v, w)
    if renewed:
        place(w)
        tangent(of_q, of_v, w)
    act(w)
    carry(w)
    lack(w)
    return renewed


@part
def accept(w, history, begins):
    """As `tree_load.accept`; the charts of ball joints begin anew."""
    place(w)
    sand_accept(w, history, begins)
    follow(w)
    recentre(w)
