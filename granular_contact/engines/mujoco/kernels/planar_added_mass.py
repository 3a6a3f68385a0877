"""`added_mass` of bodies that move in a plane: contact lines, whose elements are their stations.

The plane is spanned by the x and z axes of the frame of the bed. facing (3,) of a body: what of its frame lies along x
where its angle is 0. ends, geometry, lines, profile, medium and anchors are those of `batches`; of_bed
(lines,) are the places of their bodies in held, reaches (lines,) how far lines reach from the
reference points of these (m). Inertia of a line in the plane is a (3, 3) matrix for x, y and the angle.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.engines.mujoco.kernels.added_mass import OF_STEP
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear, room1, room2, rows
from granular_contact.sand.kernels import lines as one
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.friction import drive as drive_along
from granular_contact.sand.kernels.kinematics import stations
from granular_contact.sand.kernels.law import TERMS, forces
from granular_contact.sand.kernels.planar_friction import factors
from granular_contact.sand.kernels.planar_sand import LINES
from granular_contact.sand.kernels.proximity import may_touch
from granular_contact.sand.kernels.surface import height

DEPTH, SPEED, LOWEST = 0, 1, 2  # of seen (bodies, 3), as of `space_law`


@part
def flatten(pose, facing, q, v):
    """Fill q and v (3,) with x, y (m), the angle (rad) and their rates from a pose (6, 3)."""
    x = pose[0, 0] * facing[0] + pose[0, 1] * facing[1] + pose[0, 2] * facing[2]
    y = pose[2, 0] * facing[0] + pose[2, 1] * facing[1] + pose[2, 2] * facing[2]
    q[0], q[1], q[2] = pose[3, 0], pose[3, 2], math.atan2(y, x)
    v[0], v[1], v[2] = pose[4, 0], pose[4, 2], -pose[5, 1]


@part
def longest(ends):
    """Most stations of a line."""
    n = 0
    for r in range(ends.shape[0] - 1):
        n = max(n, ends[r + 1, 0] - ends[r, 0])
    return n


# See above; active (lines,): which may touch the surface in this step.
BATCH = Layout(
    "lines in MuJoCo",
    **LINES.of("ends", "geometry", "lines", "profile", "medium", "anchors", "active"),
    **OF_STEP,
    reaches=(float, 1),
)
view = BATCH.view


@kernel(nogil=True)
def act(addresses):
    """As `space_added_mass.act`."""
    w = view(addresses)
    if w.bed[0].begins:
        clear(w.anchors)
    if w.bed[0].begins or w.bed[0].passed > 0.0:
        follow(w)
    resist(w)


@part(allocates=True)
def follow(w):
    """End of a step at these poses: anchors follow; what the next may touch is active.

    Where a motion begins here no bristle is stretched. seen is brought up to date; of what is out of reach the depth is
    a bound.
    """
    ends, geometry, lines, profile, medium = w.ends, w.geometry, w.lines, w.profile, w.medium
    anchors, active, reaches = w.anchors, w.active, w.reaches
    step, begins = w.bed[0].step, w.bed[0].begins
    n = longest(ends)
    P, V, q, v = np.empty((n, 2)), np.empty((n, 2)), room1(3), room1(3)
    highest = np.max(profile[:, 1])
    for r in range(lines.shape[0]):
        s, e = ends[r, 0], ends[r + 1, 0]
        body = w.held[w.of_bed[r]]
        pose, saw = rows(body.pose, 0, 6), body.seen
        if profile.shape[0] == 1:
            speed = abs(pose[4, 2]) + abs(pose[5, 1]) * reaches[r]
            deepest = highest - pose[3, 2] + reaches[r]
            if not begins and not may_touch(deepest, speed, step):
                saw[DEPTH] = max(saw[DEPTH], deepest)
                active[r] = False
                continue
        p, velocity = P[: e - s], V[: e - s]
        flatten(pose, body.facing, q, v)
        stations(q, v, rows(geometry, s, e - s), p, velocity)
        deepest, speed = -np.inf, 0.0
        for i in range(e - s):
            surface, slope = height(profile, p[i, 0])
            z = surface - p[i, 1] + lines[r].drop
            deepest = max(deepest, z)
            speed = max(speed, abs(velocity[i, 1]) + abs(slope * velocity[i, 0]))
            if z > 0.0:
                saw[SPEED] = max(saw[SPEED], math.hypot(velocity[i, 0], velocity[i, 1]))
                saw[LOWEST] = min(saw[LOWEST], p[i, 1] - lines[r].drop)
        saw[DEPTH] = max(saw[DEPTH], deepest)
        if deepest <= 0.0 or begins or not active[r]:
            one.release(p, rows(anchors, s, e - s), medium[0])
        else:
            one.drag_anchors(p, rows(anchors, s, e - s), lines[r], profile, medium[0])
        active[r] = may_touch(deepest, speed, step)


@part(allocates=True)
def resist(w):
    """As `space_added_mass.resist`."""
    ends, geometry, lines, profile, medium = w.ends, w.geometry, w.lines, w.profile, w.medium
    anchors, active = w.anchors, w.active
    n, step = longest(ends), w.bed[0].step
    P, V, F, q, v = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2)), room1(3), room1(3)
    Q, ahead, totals, flat = np.empty((n, 4)), room2(6, 3), room2(TERMS, 3), room2(3, 3)
    clear(totals)
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, e, body = ends[r, 0], ends[r + 1, 0], w.held[w.of_bed[r]]
        k = e - s
        advance(body.pose, body.then, step, ahead)
        flatten(ahead, body.facing, q, v)
        stations(q, v, rows(geometry, s, e - s), P[:k], V[:k])
        if not one.immersed(P[:k], lines[r], profile):
            continue
        forces(P[:k], V[:k], rows(anchors, s, e - s), lines[r], profile, medium[0], F[:k], totals)
        stretch(P[:k], V[:k], rows(anchors, s, e - s), w.bristle[0], step, F[:k], Q[:k])
        clear(flat)
        for i in range(k):
            fx, fy = F[i, 0], F[i, 1]
            if fx == 0.0 and fy == 0.0:
                continue
            x, y = P[i, 0] - q[0], P[i, 1] - q[1]
            body.wrench[0] += fx
            body.wrench[2] += fy
            body.wrench[4] -= x * fy - y * fx
            weigh(fx, fy, Q, max(0, i - 1), min(k, i + 2), w.bristle[0], x, y, flat)
            if lines[r].side != 0.0:
                for j in range(max(0, i - 1), min(k - 1, i + 1)):
                    lean(fx, fy, P, Q, i, j, lines[r].side, x, y, flat)
        spread_out(flat, w.bed[0].turn, body.arm, body.added)


@part
def spread_out(flat, turn, arm, added):
    """Add an inertia in the plane (3, 3) to that of a body (6, 6) about a point from which the old one is at arm."""
    J = room2(3, 6)
    clear(J)
    for k in range(3):
        J[0, 3 + k], J[1, 3 + k], J[2, k] = turn[0, k], turn[2, k], -turn[1, k]
    for row in range(2):  # velocity of the reference point where the body turns about the other
        a, b, c = J[row, 3], J[row, 4], J[row, 5]
        J[row, 0], J[row, 1], J[row, 2] = arm[1] * c - arm[2] * b, arm[2] * a - arm[0] * c, arm[0] * b - arm[1] * a
    for i in range(3):
        for j in range(3):
            if flat[i, j] == 0.0:
                continue
            for a in range(6):
                k = flat[i, j] * J[i, a]
                for b in range(6):
                    added[a, b] += k * J[j, b]


@part
def add_along(mass, nx, ny, x, y, flat):
    """Add a mass (kg) at x, y (m) from the reference point that is felt along n alone."""
    motion = nx, ny, x * ny - y * nx
    for i in range(3):
        for j in range(3):
            flat[i, j] += mass * motion[i] * motion[j]


@part
def stretch(P, V, anchors, m, step, F, Q):
    """Fill Q (n, 4) with q, x and y, and how its components grow with those of the velocity there (s^2).

    Where a station and its neighbours have no force F (n, 2) they are not needed.
    """
    n = P.shape[0]
    for i in range(n):
        needed = False
        for j in range(max(0, i - 1), min(n, i + 2)):
            needed = needed or F[j, 0] != 0.0 or F[j, 1] != 0.0
        if not needed:
            continue
        ex, ey, vx, vy = P[i, 0] - anchors[i, 0], P[i, 1] - anchors[i, 1], V[i, 0], V[i, 1]
        if m.parted and m.friction != SMOOTH:
            qx, qy = m.u_y * drive_along(ex, vx, m), m.u_y * drive_along(ey, vy, m)
            Q[i, 0], Q[i, 1] = qx, qy
            Q[i, 2], Q[i, 3] = growth(ex, vx, qx, m, step), growth(ey, vy, qy, m, step)
            continue
        share, tau = factors((ex, ey), (vx, vy), m)
        Q[i, 0], Q[i, 1] = share * ex + tau * vx, share * ey + tau * vy
        Q[i, 2] = Q[i, 3] = step * (share * step + tau)


@part
def growth(e, v, q, m, step):
    """How one component of q grows with its velocity (s^2), of a bristle with this stretch (m)."""
    share = min(1.0, m.u_y / abs(e)) if e != 0.0 else 1.0
    tau = max(m.tau, abs(q - share * e) / abs(v)) if v != 0.0 else m.tau
    return step * (share * step + tau)


@part
def weigh(fx, fy, Q, first, last, m, x, y, flat):
    """Add the inertia of a station with a force (N); q is the greatest of its own and of its neighbours'."""
    qx, qy, gx, gy = 0.0, 0.0, 0.0, 0.0
    for i in range(first, last):
        qx, qy = max(qx, abs(Q[i, 0])), max(qy, abs(Q[i, 1]))
        gx, gy = max(gx, Q[i, 2]), max(gy, Q[i, 3])
    fx, fy = abs(fx), abs(fy)
    if not m.parted or m.friction == SMOOTH:
        square = qx * qx + qy * qy
        if square > 0.0:
            mass = max(gx, gy) * math.sqrt((fx * fx + fy * fy) / square)
            add_along(mass, 1.0, 0.0, x, y, flat)
            add_along(mass, 0.0, 1.0, x, y, flat)
        return
    if qx > 0.0:
        add_along(gx * fx / qx, 1.0, 0.0, x, y, flat)
    if qy > 0.0:
        add_along(gy * fy / qy, 0.0, 1.0, x, y, flat)


@part
def lean(fx, fy, P, Q, i, j, side, x, y, flat):
    """Add what station i feels along the normal of strip j of an outline, beyond what it feels anyway."""
    cx, cy = side * (P[j + 1, 0] - P[j, 0]), side * (P[j + 1, 1] - P[j, 1])
    length = math.sqrt(cx * cx + cy * cy)
    if length == 0.0:
        return
    nx, ny = -cy / length, cx / length
    along = max(nx * Q[j, 0] + ny * Q[j, 1], nx * Q[j + 1, 0] + ny * Q[j + 1, 1])
    square = max(Q[j, 0] ** 2 + Q[j, 1] ** 2, Q[j + 1, 0] ** 2 + Q[j + 1, 1] ** 2)
    if not 0.0 < along * along < square:
        return
    mass = 0.5 * max(Q[i, 2], Q[i, 3]) * math.sqrt(fx * fx + fy * fy) * (1.0 / abs(along) - 1.0 / math.sqrt(square))
    if along > 0.0:
        add_along(mass, nx, ny, x, y, flat)
