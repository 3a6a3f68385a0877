"""`added_mass` of bodies in space: facets, strips of bars and balls.

`rows`: how many rows of `elements` an element takes, 2 for the strips of a bar; inner: clusters for all elements of a
cluster but its last, without the free end face. See `space_bodies` for other arrays of a view `w`; of_bed (bodies,)
are the places of the bodies in held, see `held_bodies` also for bed.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import OF_STEP, add_inertia, add_point
from granular_contact.engines.mujoco.kernels.facets_added_mass import add_turned, held_facets
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear, room1, room2
from granular_contact.jit.memory import rows as rows_of
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_records import COLUMNS
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.friction import drive as drive_along
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.planar_friction import drive as drive_across
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, may_touch
from granular_contact.sand.kernels.space_clusters import bound, bound_cluster, reach_below, release
from granular_contact.sand.kernels.space_friction import factors
from granular_contact.sand.kernels.vectors import axes, minus, moving, norm, plus, turned

# Those arrays of `space_law.BODIES` that are needed here, and the ones above; active (clusters,): which may touch the
# surface in this step.
BATCH = Layout(
    "elements in MuJoCo",
    **law.BODIES.of("bodies", "clusters", "elements", "anchors", "active", "ground", "medium"),
    **OF_STEP,
    inner=(law.CLUSTER, 1),
)
view = BATCH.view


@kernel(nogil=True)
def act(addresses, rows):
    """One step of elements of a medium: `begin` or `follow`, and `resist`."""
    w = view(addresses)
    begin_or_follow(w, False)
    resist(w, rows)


@part
def begin_or_follow(w, floor):
    """`begin` or `follow`, as the bed says; floor: whether it is that of a bed, whose depths are seen apart."""
    if not w.bed[0].begins and not w.bed[0].passed > 0.0:
        return
    for b in range(w.bodies.shape[0]):
        one, body = w.held[w.of_bed[b]], w.bodies[b]
        pose, saw = rows_of(one.pose, 0, 6), rows_of(one.seen_of_floor if floor else one.seen, 0, 3)
        if w.bed[0].begins:
            begin(w, body, pose, w.bed[0].step, saw)
        else:
            follow(w, body, pose, w.bed[0].step, saw)


@part
def follow(w, body, pose, step, saw):
    """End of a step of a body at this pose: anchors follow, and what the next may touch is chosen.

    saw (3,), of `space_law.DEPTH` and its neighbours, is brought up to date; of what is out of reach the depth is a
    bound.
    """
    near, clusters, active, ground, medium = room1(2), w.clusters, w.active, w.ground, w.medium
    elements, anchors = w.elements, w.anchors
    bound(body, pose, ground, medium[0], near)
    within, deepest = may_touch(near[DEEPEST], near[APPROACH], step), near[DEEPEST]
    if not within:
        saw[law.DEPTH] = max(saw[law.DEPTH], deepest)
    for c in range(body.first, body.last):
        one, now = clusters[c], within
        if within:
            bound_cluster(one, pose, ground, medium[0], near)
            now = may_touch(near[DEEPEST], near[APPROACH], step)
        s, e = one.first, one.last
        if now and active[c]:
            E, A = rows_of(elements, s, e - s), rows_of(anchors, s, e - s)
            law.follow(medium[0], (E, A, one, pose, ground, saw))
        elif now:
            release(elements, anchors, one, pose, medium[0], False)
        if within and not (now and active[c]):
            saw[law.DEPTH] = max(saw[law.DEPTH], near[DEEPEST])
        active[c] = now


@part
def begin(w, body, pose, step, saw):
    """Begin of a body at this pose: no bristle is stretched; saw as of `follow`, all depths are bounds."""
    near, medium = room1(2), w.medium[0]
    for c in range(body.first, body.last):
        one = w.clusters[c]
        release(w.elements, w.anchors, one, pose, medium, True)
        bound_cluster(one, pose, w.ground, medium, near)
        saw[law.DEPTH] = max(saw[law.DEPTH], near[DEEPEST])
        w.active[c] = may_touch(near[DEEPEST], near[APPROACH], step)


@part
def resist(w, rows):
    """Add forces where the step ends to the wrench of bodies, and inertia to what is added to theirs.

    The wrench is about the reference point of a body where it starts.
    """
    W, ahead, inertia, step = room2(TERMS, 6), room2(6, 3), room2(6, 6), w.bed[0].step
    clusters, elements, anchors, ground = w.clusters, w.elements, w.anchors, w.ground
    medium = w.medium[0]
    for b in range(w.bodies.shape[0]):
        body, at, some = w.bodies[b], w.held[w.of_bed[b]], False
        wrench = rows_of(at.wrench, 0, 6)
        for c in range(body.first, body.last):
            if not w.active[c]:
                continue
            one = clusters[c]
            if not some:
                advance(at.pose, at.then, step, ahead)
                clear(inertia)
                some = True
            if reach_below(one, ahead, ground, medium) <= 0.0:
                continue
            s, e = one.first, one.last
            if elements.shape[1] == COLUMNS:
                E, A = rows_of(elements, s, e - s), rows_of(anchors, s, e - s)
                held_facets(E, A, one, ahead, ground, medium, step, w.bristle[0], wrench, inertia)
                continue
            for i in range(s, e - rows + 1):
                clear(W)
                E, A = rows_of(elements, i, rows), rows_of(anchors, i, rows)
                law.forces(medium, (E, A, one if i == e - rows else w.inner[c], ahead, ground, W))
                f = total(W, 0), total(W, 1), total(W, 2)
                if f != (0.0, 0.0, 0.0):
                    for k in range(6):
                        wrench[k] += total(W, k)
                    weigh(f, E, A, at.pose, ahead, step, w.bristle[0], inertia)
        if some and inertia[3, 3] != 0.0:
            add_turned(inertia, at.pose, w.bed[0].turn, at.arm, at.added)


@part
def total(W, k):
    """Component k of all terms together."""
    found = 0.0
    for term in range(TERMS):
        found += W[term, k]
    return found


@part
def weigh(f, E, A, pose, ahead, step, bristle, inertia):
    """Add the inertia of a strip or a ball with a force f (3,) N, rows E with anchors A, to that of its body.

    Frame of the body, upper triangle, as of `facets_added_mass`; pose: where the step begins.
    """
    (fx, fy, fz), (bx, by, bz) = f, middle(E)
    r = turned(axes(ahead), (bx, by, bz))
    vx, vy, vz = moving(ahead[4], ahead[5], r)
    ex, ey, ez = minus(plus(ahead[3], r), middle(A))
    if bristle.parted and bristle.friction != SMOOTH:
        qx, qy = drive_across((ex, ey), (vx, vy), bristle)
        mass = secant(norm((fx, fy)), norm((qx, qy)), norm((ex, ey)), norm((vx, vy)), bristle, step)
        qz = bristle.u_y * drive_along(ez, vz, bristle)
        upward = secant(abs(fz), abs(qz), abs(ez), abs(vz), bristle, step)
        add_point(mass, bx, by, bz, inertia)
        add_inertia(upward - mass, pose[2, 0], pose[2, 1], pose[2, 2], bx, by, bz, inertia)
        return
    share, tau = factors((ex, ey, ez), (vx, vy, vz), bristle)
    q = norm((share * ex + tau * vx, share * ey + tau * vy, share * ez + tau * vz))
    if q == 0.0:
        return
    growth = step * (share * step + tau) * norm(f)
    add_point(growth / q, bx, by, bz, inertia)


@part
def middle(rows):
    """Mean of the places (m) in the first three columns of rows."""
    n, x, y, z = 1.0 / rows.shape[0], 0.0, 0.0, 0.0
    for i in range(rows.shape[0]):
        x, y, z = x + n * rows[i, 0], y + n * rows[i, 1], z + n * rows[i, 2]
    return x, y, z


@part
def secant(force, q, stretch, speed, bristle, step):
    """Mass (kg) of a bristle with its components apart, from the lengths of its force, q, stretch and velocity."""
    if q == 0.0:
        return 0.0
    share = min(1.0, bristle.u_y / stretch) if stretch > 0.0 else 1.0
    tau = bristle.tau
    if speed > 0.0:
        tau = max(tau, (q - share * stretch) / speed)
    return step * (share * step + tau) * force / q
