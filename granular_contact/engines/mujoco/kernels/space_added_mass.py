"""Forces and added inertia of bodies in space: facets, strips of bars and balls; see `added_mass`.

`rows`: number of rows of `elements` that belong to one element, 2 for the strips of a bar. Of a view `w`:
inner_clusters: clusters without a free end face, for all elements of a cluster but the last. held_places (bodies,):
places of the bodies of the batch in held. See `space_bodies` for the other arrays, and `held_bodies` for held and bed.
"""

from __future__ import annotations

from granular_contact.engines.mujoco.kernels.added_mass import STEP_ARRAYS, add_inertia, add_point
from granular_contact.engines.mujoco.kernels.facets_added_mass import add_rotated_inertia, facet_wrench_and_inertia
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear, room1, room2
from granular_contact.jit.memory import rows as row_slice
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_records import COLUMNS
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.friction import drive as drive_along
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.planar_friction import drive as drive_across
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, may_touch
from granular_contact.sand.kernels.space_clusters import bound, bound_cluster, reach_below, release
from granular_contact.sand.kernels.space_friction import factors
from granular_contact.sand.kernels.vectors import axes, minus, norm, plus, plus_cross, turned

# Arrays of `space_law.BODIES`, and those above; active (clusters,): whether a cluster may touch the surface in this
# step.
BATCH = Layout(
    "elements in MuJoCo",
    **law.BODIES.of("bodies", "clusters", "elements", "anchors", "active", "ground", "medium"),
    **STEP_ARRAYS,
    inner_clusters=(law.CLUSTER, 1),
)
view = BATCH.view


@kernel(nogil=True)
def act(addresses, rows):
    """Process a step for the elements of one medium: `begin` or `follow`, then `resist`."""
    w = view(addresses)
    begin_or_follow(w, False)
    resist(w, rows)


@part
def begin_or_follow(w, floor):
    """Call `begin` or `follow` for each body, if a motion starts or a step ended; floor: whether this is a floor."""
    if not w.bed[0].starts and not w.bed[0].elapsed > 0.0:
        return
    for b in range(w.bodies.shape[0]):
        held, body = w.held[w.held_places[b]], w.bodies[b]
        pose, immersion = row_slice(held.pose, 0, 6), row_slice(held.floor_immersion if floor else held.immersion, 0, 3)
        if w.bed[0].starts:
            begin(w, body, pose, w.bed[0].step, immersion)
        else:
            follow(w, body, pose, w.bed[0].step, immersion)


@part
def follow(w, body, pose, step, immersion):
    """End a step of a body at this pose: let anchors follow, and mark the clusters that may touch in the next step.

    immersion (3,), see `space_law.DEPTH`, is updated. For clusters out of reach its depth is an upper bound.
    """
    bounds, clusters, active, ground, medium = room1(2), w.clusters, w.active, w.ground, w.medium
    elements, anchors = w.elements, w.anchors
    bound(body, pose, ground, medium[0], bounds)
    body_may_touch, deepest = may_touch(bounds[DEEPEST], bounds[APPROACH], step), bounds[DEEPEST]
    if not body_may_touch:
        immersion[law.DEPTH] = max(immersion[law.DEPTH], deepest)
    for c in range(body.first, body.last):
        cluster, may = clusters[c], body_may_touch
        if body_may_touch:
            bound_cluster(cluster, pose, ground, medium[0], bounds)
            may = may_touch(bounds[DEEPEST], bounds[APPROACH], step)
        s, e = cluster.first, cluster.last
        if may and active[c]:
            E, A = row_slice(elements, s, e - s), row_slice(anchors, s, e - s)
            law.follow(medium[0], (E, A, cluster, pose, ground, immersion))
        elif may:
            release(elements, anchors, cluster, pose, medium[0], False)
        if body_may_touch and not (may and active[c]):
            immersion[law.DEPTH] = max(immersion[law.DEPTH], bounds[DEEPEST])
        active[c] = may


@part
def begin(w, body, pose, step, immersion):
    """Start a body at this pose with unstretched bristles; immersion as in `follow`, all depths are upper bounds."""
    bounds, medium = room1(2), w.medium[0]
    for c in range(body.first, body.last):
        cluster = w.clusters[c]
        release(w.elements, w.anchors, cluster, pose, medium, True)
        bound_cluster(cluster, pose, w.ground, medium, bounds)
        immersion[law.DEPTH] = max(immersion[law.DEPTH], bounds[DEEPEST])
        w.active[c] = may_touch(bounds[DEEPEST], bounds[APPROACH], step)


@part
def resist(w, rows):
    """Add the forces at the predicted end of the step to the wrenches of bodies, and their inertia to `added_inertia`.

    A wrench is computed about the reference point at the predicted end of the step, and applied at that point's
    position at the start.
    """
    W, end_pose, inertia, step = room2(TERMS, 6), room2(6, 3), room2(6, 6), w.bed[0].step
    clusters, elements, anchors, ground = w.clusters, w.elements, w.anchors, w.ground
    medium, bristle = w.medium[0], w.bristle[0]
    for b in range(w.bodies.shape[0]):
        body, held, is_near = w.bodies[b], w.held[w.held_places[b]], False
        wrench = row_slice(held.wrench, 0, 6)
        for c in range(body.first, body.last):
            if not w.active[c]:
                continue
            cluster = clusters[c]
            if not is_near:
                advance(held.pose, held.predicted_pose, step, end_pose)
                clear(inertia)
                is_near = True
            if reach_below(cluster, end_pose, ground, medium) <= 0.0:
                continue
            s, e = cluster.first, cluster.last
            if elements.shape[1] == COLUMNS:
                E, A = row_slice(elements, s, e - s), row_slice(anchors, s, e - s)
                facet_wrench_and_inertia(E, A, cluster, end_pose, ground, medium, step, bristle, wrench, inertia)
                continue
            for i in range(s, e - rows + 1):
                clear(W)
                E, A = row_slice(elements, i, rows), row_slice(anchors, i, rows)
                law.forces(medium, (E, A, cluster if i == e - rows else w.inner_clusters[c], end_pose, ground, W))
                f = total(W, 0), total(W, 1), total(W, 2)
                if f != (0.0, 0.0, 0.0):
                    for k in range(6):
                        wrench[k] += total(W, k)
                    add_element_inertia(f, E, A, held.pose, end_pose, step, bristle, inertia)
        if is_near and inertia[3, 3] != 0.0:
            add_rotated_inertia(inertia, held.pose, w.bed[0].turn, held.arm, held.added_inertia)


@part
def total(W, k):
    """Component k of the sum of all terms."""
    component = 0.0
    for term in range(TERMS):
        component += W[term, k]
    return component


@part
def add_element_inertia(f, E, A, pose, end_pose, step, bristle, inertia):
    """Add the added inertia of a strip or a ball with the force f (3,) N to the inertia of its body.

    E, A: rows of the element and of its anchors. pose, end_pose (6, 3): at the start and at the predicted end of the
    step. inertia (6, 6): as in `facets_added_mass.facet_wrench_and_inertia`.
    """
    (fx, fy, fz), (bx, by, bz) = f, mean_position(E)
    r = turned(axes(end_pose), (bx, by, bz))
    vx, vy, vz = plus_cross(end_pose[4], end_pose[5], r)
    ex, ey, ez = minus(plus(end_pose[3], r), mean_position(A))
    if bristle.by_component and bristle.friction != SMOOTH:
        qx, qy = drive_across((ex, ey), (vx, vy), bristle)
        mass = secant_mass(norm((fx, fy)), norm((qx, qy)), norm((ex, ey)), norm((vx, vy)), bristle, step)
        qz = bristle.u_y * drive_along(ez, vz, bristle)
        vertical_mass = secant_mass(abs(fz), abs(qz), abs(ez), abs(vz), bristle, step)
        add_point(mass, bx, by, bz, inertia)
        add_inertia(vertical_mass - mass, pose[2, 0], pose[2, 1], pose[2, 2], bx, by, bz, inertia)
        return
    share, tau = factors((ex, ey, ez), (vx, vy, vz), bristle)
    q = norm((share * ex + tau * vx, share * ey + tau * vy, share * ez + tau * vz))
    if q == 0.0:
        return
    growth = step * (share * step + tau) * norm(f)
    add_point(growth / q, bx, by, bz, inertia)


@part
def mean_position(rows):
    """Mean of the positions (m) in the first three columns of rows."""
    n, x, y, z = 1.0 / rows.shape[0], 0.0, 0.0, 0.0
    for i in range(rows.shape[0]):
        x, y, z = x + n * rows[i, 0], y + n * rows[i, 1], z + n * rows[i, 2]
    return x, y, z


@part
def secant_mass(force, q, stretch, speed, bristle, step):
    """Added mass (kg) of one component of a bristle, from the magnitudes of its force, q, stretch and velocity."""
    if q == 0.0:
        return 0.0
    share = min(1.0, bristle.u_y / stretch) if stretch > 0.0 else 1.0
    tau = bristle.tau
    if speed > 0.0:
        tau = max(tau, (q - share * stretch) / speed)
    return step * (share * step + tau) * force / q
