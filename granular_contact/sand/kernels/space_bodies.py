"""Rigid bodies in space and all elements on them, in one call: force, tangent, end of a step, what may be touched.

Arguments that they share:

    addresses           of the arrays of elements of one kind in one medium, of the layout `space_law.BODIES`
                        (`jit.layout`), of which w is a view
    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory

These arrays are:

    reference           reference values of the system's coordinates
    places              (coordinates, 2) place of each coordinate of a body in the system and among those of the bed
    bodies              (bodies,) records BODY
    turn                (3, 3) from the world to the frame of the bed, whose z is up
    clusters            (clusters,) records of `space_law`, those of a body one after another
    elements, anchors   rows of all clusters, one after another, see `facets`, `bars`, `space_balls`
    active              (clusters,) whether one may touch the surface in this step; the others are passed over
    ground              see `ground`
    medium              see `space_law`; (1,)
    poses, proximity    (bodies, 6, 3) and (bodies, 3), of the last accepted step
    asked, wrenches     (bodies, 2, 7) coordinates and rates at which forces were asked for last, and (bodies, TERMS, 6)
                        what was found there, see below
    columns             (bodies, 3) where the power of the medium, its terms and the wrench of a body stand in a row of
                        the history, six numbers each: force (N) and moment about the world origin (N m), world frame

A step mostly ends where forces were asked for last, and then `accept` does not compute them again; nor does `force`
where a tangent was asked for, with which they come. A first coordinate that is no number says that they are not known
any more, as anchors follow or other clusters are active.

Coordinates of a body: see `space_coordinates`. A piece of a cubic cable element has the position and the slope
r' = dr/ds at its middle, y = S q of the 12 coordinates q of the element (`BODY`), and acts on them by S^T.
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, copy, piece, room1, room2, rows
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.batches import gather
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, EVER, may_touch
from granular_contact.sand.kernels.space_clusters import bound, bound_cluster, reach_below, release
from granular_contact.sand.kernels.space_coordinates import by_parameters
from granular_contact.sand.kernels.vectors import at, axes, moving, seen

view = law.BODIES.view


@part
def read(system_q, system_v, reference, at, body, q, v):
    """Fill q and v with the coordinates of a body, at these places of the system."""
    if body.places == body.size:
        gather(system_q, system_v, reference, at, q, v)
        return
    shape = body.shape
    for i in range(3):
        x, y, vx, vy = 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            place = at[3 * k + i, 0]
            now, rate = system_q[place] + reference[place], system_v[place]
            x, y = x + shape[k] * now, y + shape[4 + k] * now
            vx, vy = vx + shape[k] * rate, vy + shape[4 + k] * rate
        q[i], q[3 + i], v[i], v[3 + i] = x, y, vx, vy


@part
def place(q, v, body, turn, medium, pose, G):
    """Fill the pose of a body in the frame of the bed, and its G (3, 4) in the world's."""
    R, size = room2(3, 3), body.size
    if size == 7:
        by_parameters(q, R, G)
    else:
        law.by_six(medium, (q, body, R, G))
    for i in range(3):
        for j in range(3):
            pose[i, j] = turn[i, 0] * R[0, j] + turn[i, 1] * R[1, j] + turn[i, 2] * R[2, j]
    for i in range(3):
        pose[3, i], pose[4, i], pose[5, i] = 0.0, 0.0, 0.0
        for j in range(3):
            pose[3, i] += turn[i, j] * q[j]
            pose[4, i] += turn[i, j] * v[j]
            w = 0.0
            for k in range(size - 3):
                w += G[j, k] * v[3 + k]
            pose[5, i] += turn[i, j] * w


@part
def body_forces(q, v, body, w, medium, pose, W, out):
    """Set out (7,) to the generalised forces on a body; whether there are any.

    W (TERMS, 6) is filled with its wrench in the bed's frame.
    """
    clusters, elements, anchors = w.clusters, w.elements, w.anchors
    active, ground, G = w.active, w.ground, room2(3, 4)
    place(q, v, body, w.turn, medium, pose, G)
    clear(W)
    for c in range(body.first, body.last):
        if active[c] and reach_below(clusters[c], pose, ground, medium) > 0.0:
            one = clusters[c]
            s, n = one.first, one.last - one.first
            law.forces(medium, (rows(elements, s, n), rows(anchors, s, n), one, pose, ground, W))
    return generalise(W, w.turn, G, body, out)


@part
def generalise(W, turn, G, body, out):
    """Set out (7,) to the generalised forces of a wrench W (TERMS, 6); whether there are any."""
    some = 0.0
    clear(out)
    for i in range(3):
        force, moment = 0.0, 0.0
        for j in range(3):
            for term in range(TERMS):
                force += turn[j, i] * W[term, j]
                moment += turn[j, i] * W[term, 3 + j]
                some += abs(W[term, j]) + abs(W[term, 3 + j])
        out[i] = force
        for k in range(body.size - 3):
            out[3 + k] += G[i, k] * moment
    return some > 0.0


@part
def force(addresses, system_q, system_v, out):
    """Add the generalised forces of the active clusters to out, the coordinates of the bed."""
    w = view(addresses)
    q, v, f, pose, G = room1(7), room1(7), room1(7), room2(6, 3), room2(3, 4)
    bodies, active, medium = w.bodies, w.active, w.medium[0]
    for b in range(bodies.shape[0]):
        body = bodies[b]
        if not acts(body, active):
            continue
        at, asked, W = rows(w.places, body.start, body.places), w.asked[b], w.wrenches[b]
        read(system_q, system_v, w.reference, at, body, q, v)
        if known(asked, body, q, v):
            place(q, v, body, w.turn, medium, pose, G)
            generalise(W, w.turn, G, body, f)
        else:
            law.body_forces(medium, (q, v, body, w, pose, W, f))
            copy(piece(asked, 0, 7), q)
            copy(piece(asked, 1, 7), v)
        for i in range(body.places):
            out[at[i, 1]] += spread(f, body, i)


@part
def spread(f, body, i):
    """Generalised force on the coordinate i of a body's places, from those on its own coordinates."""
    if body.places == body.size:
        return f[i]
    return body.shape[i // 3] * f[i % 3] + body.shape[4 + i // 3] * f[3 + i % 3]


@part
def acts(body, active):
    """Whether any cluster of a body is active."""
    for c in range(body.first, body.last):  # noqa: SIM110  # for the compiler
        if active[c]:
            return True
    return False


@part
def tangent(addresses, system_q, system_v, fq, fv, triplets, count):
    """Append the entries of fq df/dq + fv df/dv as rows (row, column, value) to the first `count` triplets."""
    w = view(addresses)
    K = room2(7, 7)
    bodies, active, medium = w.bodies, w.active, w.medium[0]
    for b in range(bodies.shape[0]):
        body = bodies[b]
        if not acts(body, active):
            continue
        at, q, v = rows(w.places, body.start, body.places), w.asked[b, 0], w.asked[b, 1]
        read(system_q, system_v, w.reference, at, body, q, v)
        if law.tangent(medium, (q, v, body, w, fq, fv, K, w.wrenches[b])):
            count = append(K, body, at, triplets, count)
    return count


@part
def append(K, body, at, triplets, count):
    """Append the tangent K of a body's own coordinates, on its places, to the first `count`; how many there are then.

    Where these are more, it is S^T K S.
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
                triplets[count, 0], triplets[count, 1], triplets[count, 2] = at[i, 1], at[j, 1], value
                count += 1
    return count


@part
def accept(addresses, system_q, system_v, row, begins):
    """End of a step: power and wrenches go into a history row, then the anchors of the active clusters follow.

    poses and proximity are filled. The row begins with `space_law.DEPTH` and its neighbours, after the time. begins: a
    solve begins here instead, with no bristle stretched; of poses, proximity and row only the poses are filled.
    """
    w = view(addresses)
    q, v, f, G = room1(7), room1(7), room1(7), room2(3, 4)
    bodies, medium, columns = w.bodies, w.medium[0], w.columns
    for b in range(bodies.shape[0]):
        body, pose, near, W = bodies[b], w.poses[b], w.proximity[b], w.wrenches[b]
        at, loaded = rows(w.places, body.start, body.places), acts(body, w.active)
        read(system_q, system_v, w.reference, at, body, q, v)
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
                row[power] += W[term, i] * pose[4, i] + W[term, 3 + i] * pose[5, i]
            write(W, term, w.turn, q, row, columns[b, 1] + 6 * term)
            write(W, term, w.turn, q, row, columns[b, 2])


@part
def known(asked, body, q, v):
    """Whether the last forces on a body were found at q and v."""
    same = True
    for i in range(body.size):
        same = same and asked[0, i] == q[i] and asked[1, i] == v[i]
    return same


@part
def follow(body, w, medium, pose, near, row):
    """Let the anchors of a body's active clusters follow; what was seen of it goes into a history row.

    near (3,): its proximity, of which `DEEPEST` is a bound of the depth. Where nothing is active the bounds of its
    clusters are the depth: the sphere around a long body can be deep in the bed though the body is above it.
    """
    clusters, elements, anchors, active = w.clusters, w.elements, w.anchors, w.active
    seen, some = room1(3), False
    seen[law.DEPTH], seen[law.SPEED], seen[law.LOWEST] = -np.inf, 0.0, np.inf
    for c in range(body.first, body.last):
        if active[c]:
            one = clusters[c]
            s, n = one.first, one.last - one.first
            law.follow(medium, (rows(elements, s, n), rows(anchors, s, n), one, pose, w.ground, seen))
            some = True
    depth = seen[law.DEPTH]
    if not some and near[DEEPEST] > row[1]:  # or another body is deeper
        depth = min(near[DEEPEST], deepest_cluster(body, w, medium, pose))
    near[EVER] = max(near[EVER], depth)
    row[1] = max(row[1], depth)
    row[2] = max(row[2], seen[law.SPEED])
    row[3] = min(row[3], seen[law.LOWEST])


@part
def deepest_cluster(body, w, medium, pose):
    """Bound for the depth (m) of all clusters of a body."""
    clusters, near, depth = w.clusters, room1(2), -np.inf
    for c in range(body.first, body.last):
        bound_cluster(clusters[c], pose, w.ground, medium, near)
        depth = max(depth, near[DEEPEST])
    return depth


@part
def write(W, term, turn, q, row, first):
    """Add the wrench of a term, about a body's reference point in the bed's frame, to that about the world's origin.

    The latter stands in the row from `first` on.
    """
    f = seen(axes(turn), at(W, term, 0))
    m = moving(seen(axes(turn), at(W, term, 3)), q, f)
    for k in range(3):
        row[first + k] += f[k]
        row[first + 3 + k] += m[k]


@part
def update_active(addresses, step):
    """Mark the clusters that may touch the surface within a step (s) from the accepted poses; whether there are any.

    What comes into reach has its anchors put where it is.
    """
    w = view(addresses)
    bodies, clusters, active, medium = w.bodies, w.clusters, w.active, w.medium[0]
    some, near = False, room1(2)
    for b in range(bodies.shape[0]):
        body, pose, within = bodies[b], w.poses[b], may_touch(w.proximity[b, DEEPEST], w.proximity[b, APPROACH], step)
        for c in range(body.first, body.last):
            one, now = clusters[c], within
            if now:
                bound_cluster(one, pose, w.ground, medium, near)
                now = may_touch(near[DEEPEST], near[APPROACH], step)
            if now and not active[c]:
                release(w.elements, w.anchors, one, pose, medium, False)
                w.asked[b, 0, 0] = np.nan
            active[c] = now
            some = some or now
    return some
