"""Rigid bodies in space with all elements on them, in one call: force, tangent, end of a step, active clusters.

Shared arguments:

    addresses           of the arrays of elements of one kind in one medium, of the layout `space_law.BODIES`
                        (`jit.layout`), of which w is a view
    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory

These arrays are:

    reference           reference values of the system's coordinates
    places              (coordinates, 2) index of each coordinate of a body in the system and in the bed
    bodies              (bodies,) records BODY
    turn                (3, 3) rotation from the world to the frame of the bed, whose z is up
    clusters            (clusters,) records of `space_law`; clusters of a body stand one after another
    elements, anchors   rows of all clusters, one after another, see `facets`, `bars`, `space_balls`
    active              (clusters,) whether a cluster may touch the surface in this step; the others are skipped
    ground              see `ground`
    medium              see `space_law`; (1,)
    poses, proximity    (bodies, 6, 3) and (bodies, 3), of the last accepted step
    asked, wrenches     (bodies, 2, 7) coordinates and rates of the last evaluation of forces, and (bodies, TERMS, 6)
                        its wrenches, see below
    columns             (bodies, 3) first columns of the history for the power of the medium, the terms, and the wrench
                        of a body; a term and a wrench have six: force (N) and moment about the world origin (N m),
                        world frame

The last wrenches are kept with the coordinates they belong to (`asked`). A step usually ends at the state of the last
evaluation, so `accept` reuses them, and `force` reuses the wrenches of a tangent. NaN as first coordinate marks them as
invalid: the anchors have moved, or other clusters became active.

Coordinates of a body: see `space_coordinates`. A piece of a cubic cable element has the position and the slope
r' = dr/ds of its middle, y = S q with the 12 coordinates q of the element (`BODY`); its forces f give S^T f.
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, copy, piece, room1, room2, rows
from granular_contact.sand.kernels import lines
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.batches import gather
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, GREATEST, may_touch
from granular_contact.sand.kernels.space_clusters import bound, bound_cluster, reach_below, release
from granular_contact.sand.kernels.space_coordinates import by_parameters
from granular_contact.sand.kernels.vectors import at, axes, plus_cross, turned_back

view = law.BODIES.view


@part
def read(system_q, system_v, reference, indices, body, q, v):
    """Fill q and v with the coordinates and rates of a body; indices (coordinates, 2): its rows of `places`."""
    if body.places == body.size:
        gather(system_q, system_v, reference, indices, q, v)
        return
    shape = body.shape
    for i in range(3):
        x, y, vx, vy = 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            index = indices[3 * k + i, 0]
            coordinate, rate = system_q[index] + reference[index], system_v[index]
            x, y = x + shape[k] * coordinate, y + shape[4 + k] * coordinate
            vx, vy = vx + shape[k] * rate, vy + shape[4 + k] * rate
        q[i], q[3 + i], v[i], v[3 + i] = x, y, vx, vy


@part
def place(q, v, body, turn, medium, pose, G):
    """Fill the pose of a body in the frame of the bed, and G (3, 4) of `space_coordinates` in the world frame."""
    R, size = room2(3, 3), body.size
    if size == 7:
        by_parameters(q, R, G)
    else:
        law.by_six(medium, (q, body, R, G))
    for i in range(3):
        for j in range(3):
            pose[i, j] = turn[i, 0] * R[0, j] + turn[i, 1] * R[1, j] + turn[i, 2] * R[2, j]
    for i in range(3):
        pose[law.POSITION, i], pose[law.VELOCITY, i], pose[law.SPIN, i] = 0.0, 0.0, 0.0
        for j in range(3):
            pose[law.POSITION, i] += turn[i, j] * q[j]
            pose[law.VELOCITY, i] += turn[i, j] * v[j]
            w = 0.0
            for k in range(size - 3):
                w += G[j, k] * v[3 + k]
            pose[law.SPIN, i] += turn[i, j] * w


@part
def body_forces(q, v, body, w, medium, pose, W, out):
    """Set out (7,) to the generalised forces on a body; return whether any is not 0.

    Fills W (TERMS, 6) with the wrench in the frame of the bed.
    """
    clusters, elements, anchors = w.clusters, w.elements, w.anchors
    active, ground, G = w.active, w.ground, room2(3, 4)
    place(q, v, body, w.turn, medium, pose, G)
    clear(W)
    for c in range(body.first, body.last):
        if active[c] and reach_below(clusters[c], pose, ground, medium) > 0.0:
            cluster = clusters[c]
            s, n = cluster.first, cluster.last - cluster.first
            law.forces(medium, (rows(elements, s, n), rows(anchors, s, n), cluster, pose, ground, W))
    return generalise(W, w.turn, G, body, out)


@part
def generalise(W, turn, G, body, out):
    """Set out (7,) to the generalised forces of a wrench W (TERMS, 6); return whether any is not 0."""
    size = 0.0
    clear(out)
    for i in range(3):
        force, moment = 0.0, 0.0
        for j in range(3):
            for term in range(TERMS):
                force += turn[j, i] * W[term, j]
                moment += turn[j, i] * W[term, 3 + j]
                size += abs(W[term, j]) + abs(W[term, 3 + j])
        out[i] = force
        for k in range(body.size - 3):
            out[3 + k] += G[i, k] * moment
    return size > 0.0


@part
def force(addresses, system_q, system_v, out):
    """Add the generalised forces on the active clusters to out (coordinates of the bed,)."""
    w = view(addresses)
    q, v, f, pose, G = room1(7), room1(7), room1(7), room2(6, 3), room2(3, 4)
    bodies, active, medium = w.bodies, w.active, w.medium[0]
    for b in range(bodies.shape[0]):
        body = bodies[b]
        if not acts(body, active):
            continue
        indices, asked, W = rows(w.places, body.start, body.places), w.asked[b], w.wrenches[b]
        read(system_q, system_v, w.reference, indices, body, q, v)
        if known(asked, body, q, v):
            place(q, v, body, w.turn, medium, pose, G)
            generalise(W, w.turn, G, body, f)
        else:
            law.body_forces(medium, (q, v, body, w, pose, W, f))
            copy(piece(asked, 0, 7), q)
            copy(piece(asked, 1, 7), v)
        for i in range(body.places):
            out[indices[i, 1]] += spread(f, body, i)


@part
def spread(f, body, i):
    """Generalised force on coordinate i of the system's coordinates of a body; f: forces on the body's own ones."""
    if body.places == body.size:
        return f[i]
    return body.shape[i // 3] * f[i % 3] + body.shape[4 + i // 3] * f[3 + i % 3]


@part
def acts(body, active):
    """Return whether any cluster of a body is active."""
    for c in range(body.first, body.last):  # noqa: SIM110  # for the compiler
        if active[c]:
            return True
    return False


@part
def tangent(addresses, system_q, system_v, fq, fv, triplets, count):
    """Append the entries of fq df/dq + fv df/dv to `count` triplets (row, column, value); return the new count."""
    w = view(addresses)
    K = room2(7, 7)
    bodies, active, medium = w.bodies, w.active, w.medium[0]
    for b in range(bodies.shape[0]):
        body = bodies[b]
        if not acts(body, active):
            continue
        indices, q, v = rows(w.places, body.start, body.places), w.asked[b, 0], w.asked[b, 1]
        read(system_q, system_v, w.reference, indices, body, q, v)
        if law.tangent(medium, (q, v, body, w, fq, fv, K, w.wrenches[b])):
            count = append(K, body, indices, triplets, count)
    return count


@part
def append(K, body, indices, triplets, count):
    """Append the tangent K of a body to the first `count` triplets, and return their new number.

    K is by the body's own coordinates; for a piece of a cable S^T K S is appended.
    """
    whole = body.places == body.size
    for i in range(body.places):
        for j in range(body.places):
            value = 0.0
            if whole:
                value = K[i, j]
            else:
                for a in range(2):
                    for b in range(2):
                        both = body.shape[4 * a + i // 3] * body.shape[4 * b + j // 3]
                        value += both * K[3 * a + i % 3, 3 * b + j % 3]
            if value != 0.0:
                triplets[count, 0], triplets[count, 1], triplets[count, 2] = indices[i, 1], indices[j, 1], value
                count += 1
    return count


@part
def accept(addresses, system_q, system_v, row, begins):
    """End a step: add power and wrenches to a history row, let the anchors of the active clusters follow.

    Fills poses and proximity. The row begins with the columns of `lines` up to LOWEST.
    begins: a solve begins instead, without any stretched bristle; then only the poses are filled.
    """
    w = view(addresses)
    q, v, f, G = room1(7), room1(7), room1(7), room2(3, 4)
    bodies, medium, columns = w.bodies, w.medium[0], w.columns
    for b in range(bodies.shape[0]):
        body, pose, near, W = bodies[b], w.poses[b], w.proximity[b], w.wrenches[b]
        indices, loaded = rows(w.places, body.start, body.places), acts(body, w.active)
        read(system_q, system_v, w.reference, indices, body, q, v)
        if begins or not loaded or known(w.asked[b], body, q, v):
            place(q, v, body, w.turn, medium, pose, G)
        else:
            loaded = law.body_forces(medium, (q, v, body, w, pose, W, f))
        w.asked[b, 0, 0] = np.nan
        if begins:
            for c in range(body.first, body.last):
                release(w.elements, w.anchors, w.clusters[c], pose, medium, True)
            continue
        bound(body, pose, w.ground, medium, near)
        follow(body, w, medium, pose, near, row)
        if not loaded:
            continue
        power = columns[b, 0]
        for term in range(TERMS):
            for i in range(3):
                row[power] += W[term, i] * pose[law.VELOCITY, i] + W[term, 3 + i] * pose[law.SPIN, i]
            write(W, term, w.turn, q, row, columns[b, 1] + 6 * term)
            write(W, term, w.turn, q, row, columns[b, 2])


@part
def known(asked, body, q, v):
    """Return whether the last wrench on a body belongs to q and v."""
    same = True
    for i in range(body.size):
        same = same and asked[0, i] == q[i] and asked[1, i] == v[i]
    return same


@part
def follow(body, w, medium, pose, near, row):
    """Let the anchors of a body's active clusters follow; note depth, speed and height in a history row.

    near (3,): its proximity, whose `DEEPEST` is an upper bound of the depth. If no cluster is active the upper bounds
    of the clusters stand for the depth: the sphere around a long body can be deep in the bed though the body is not.
    """
    clusters, elements, anchors, active = w.clusters, w.elements, w.anchors, w.active
    extremes, loaded = room1(3), False
    extremes[law.DEPTH], extremes[law.SPEED], extremes[law.LOWEST] = -np.inf, 0.0, np.inf
    for c in range(body.first, body.last):
        if active[c]:
            cluster = clusters[c]
            s, n = cluster.first, cluster.last - cluster.first
            law.follow(medium, (rows(elements, s, n), rows(anchors, s, n), cluster, pose, w.ground, extremes))
            loaded = True
    depth = extremes[law.DEPTH]
    if not loaded and near[DEEPEST] > row[lines.DEPTH]:  # else another body is deeper
        depth = min(near[DEEPEST], deepest_cluster(body, w, medium, pose))
    near[GREATEST] = max(near[GREATEST], depth)
    row[lines.DEPTH] = max(row[lines.DEPTH], depth)
    row[lines.SPEED] = max(row[lines.SPEED], extremes[law.SPEED])
    row[lines.LOWEST] = min(row[lines.LOWEST], extremes[law.LOWEST])


@part
def deepest_cluster(body, w, medium, pose):
    """Upper bound of the depth (m) of all clusters of a body."""
    clusters, near, depth = w.clusters, room1(2), -np.inf
    for c in range(body.first, body.last):
        bound_cluster(clusters[c], pose, w.ground, medium, near)
        depth = max(depth, near[DEEPEST])
    return depth


@part
def write(W, term, turn, q, row, first):
    """Add the wrench of a term to a row of the history, from column `first` on.

    W: about the reference point q of a body, frame of the bed; in the row: about the world origin, world frame.
    """
    f = turned_back(axes(turn), at(W, term, 0))
    m = plus_cross(turned_back(axes(turn), at(W, term, 3)), q, f)
    for k in range(3):
        row[first + k] += f[k]
        row[first + 3 + k] += m[k]


@part
def update_active(addresses, step):
    """Mark the clusters that may touch the surface within a step (s) from the accepted poses; return whether any may.

    Anchors of clusters that come into reach are put at their elements.
    """
    w = view(addresses)
    bodies, clusters, active, medium = w.bodies, w.clusters, w.active, w.medium[0]
    reached, near = False, room1(2)
    for b in range(bodies.shape[0]):
        body, pose, within = bodies[b], w.poses[b], may_touch(w.proximity[b, DEEPEST], w.proximity[b, APPROACH], step)
        for c in range(body.first, body.last):
            cluster, touches = clusters[c], within
            if touches:
                bound_cluster(cluster, pose, w.ground, medium, near)
                touches = may_touch(near[DEEPEST], near[APPROACH], step)
            if touches and not active[c]:
                release(w.elements, w.anchors, cluster, pose, medium, False)
                w.asked[b, 0, 0] = np.nan
            active[c] = touches
            reached = reached or touches
    return reached
