"""Forces and added inertia of bodies that move in a plane: stations of contact lines; see `added_mass`.

The plane is spanned by the x and z axes of the frame of the bed. facing (3,): direction in the frame of a body that
lies along x at the angle 0. Of a view `w`: ends, geometry, lines, profile, medium and anchors as in `batches`;
held_places (lines,): places of the bodies of the lines in held; reaches (lines,) m: largest distance of a line from the
reference point of its body. The inertia of a line in the plane is a (3, 3) matrix for x, y and the angle.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.engines.mujoco.kernels.added_mass import STEP_ARRAYS
from granular_contact.engines.mujoco.kernels.held_bodies import advance
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear, room1, room2, rows
from granular_contact.sand.kernels import lines as line_kernels
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.friction import drive as drive_along
from granular_contact.sand.kernels.kinematics import stations
from granular_contact.sand.kernels.law import TERMS, forces
from granular_contact.sand.kernels.planar_friction import factors
from granular_contact.sand.kernels.planar_sand import LINES
from granular_contact.sand.kernels.proximity import may_touch
from granular_contact.sand.kernels.surface import height

DEPTH, SPEED, LOWEST = 0, 1, 2  # places in the immersion of a body, as in `space_law`


@part
def planar_motion(pose, facing, q, v):
    """Fill q and v (3,) with x, y (m), the angle (rad) and their rates, from a pose (6, 3)."""
    x = pose[0, 0] * facing[0] + pose[0, 1] * facing[1] + pose[0, 2] * facing[2]
    y = pose[2, 0] * facing[0] + pose[2, 1] * facing[1] + pose[2, 2] * facing[2]
    q[0], q[1], q[2] = pose[3, 0], pose[3, 2], math.atan2(y, x)
    v[0], v[1], v[2] = pose[4, 0], pose[4, 2], -pose[5, 1]


@part
def most_stations(ends):
    """Largest number of stations of a line."""
    n = 0
    for r in range(ends.shape[0] - 1):
        n = max(n, ends[r + 1, 0] - ends[r, 0])
    return n


# Arrays of a batch, see above; active (lines,): whether a line may touch the surface in this step.
BATCH = Layout(
    "lines in MuJoCo",
    **LINES.of("ends", "geometry", "lines", "profile", "medium", "anchors", "active"),
    **STEP_ARRAYS,
    reaches=(float, 1),
)
view = BATCH.view


@kernel(nogil=True)
def act(addresses):
    """As `space_added_mass.act`."""
    w = view(addresses)
    if w.bed[0].starts:
        clear(w.anchors)
    if w.bed[0].starts or w.bed[0].elapsed > 0.0:
        follow(w)
    resist(w)


@part(allocates=True)
def follow(w):
    """End a step at the present poses: let anchors follow, and mark the lines that may touch in the next step.

    If a motion starts here, no bristle is stretched. The immersions of the bodies are updated; for lines out of reach
    the depth is an upper bound.
    """
    ends, geometry, lines, profile, medium = w.ends, w.geometry, w.lines, w.profile, w.medium
    anchors, active, reaches = w.anchors, w.active, w.reaches
    step, starts = w.bed[0].step, w.bed[0].starts
    n = most_stations(ends)
    P, V, q, v = np.empty((n, 2)), np.empty((n, 2)), room1(3), room1(3)
    highest = np.max(profile[:, 1])
    for r in range(lines.shape[0]):
        s, e = ends[r, 0], ends[r + 1, 0]
        body = w.held[w.held_places[r]]
        pose, immersion = rows(body.pose, 0, 6), body.immersion
        if profile.shape[0] == 1:
            speed = abs(pose[4, 2]) + abs(pose[5, 1]) * reaches[r]
            deepest = highest - pose[3, 2] + reaches[r]
            if not starts and not may_touch(deepest, speed, step):
                immersion[DEPTH] = max(immersion[DEPTH], deepest)
                active[r] = False
                continue
        p, velocity = P[: e - s], V[: e - s]
        planar_motion(pose, body.facing, q, v)
        stations(q, v, rows(geometry, s, e - s), p, velocity)
        deepest, speed = -np.inf, 0.0
        for i in range(e - s):
            surface, slope = height(profile, p[i, 0])
            z = surface - p[i, 1] + lines[r].drop
            deepest = max(deepest, z)
            speed = max(speed, abs(velocity[i, 1]) + abs(slope * velocity[i, 0]))
            if z > 0.0:
                immersion[SPEED] = max(immersion[SPEED], math.hypot(velocity[i, 0], velocity[i, 1]))
                immersion[LOWEST] = min(immersion[LOWEST], p[i, 1] - lines[r].drop)
        immersion[DEPTH] = max(immersion[DEPTH], deepest)
        if deepest <= 0.0 or starts or not active[r]:
            line_kernels.release(p, rows(anchors, s, e - s), medium[0])
        else:
            line_kernels.drag_anchors(p, rows(anchors, s, e - s), lines[r], profile, medium[0])
        active[r] = may_touch(deepest, speed, step)


@part(allocates=True)
def resist(w):
    """As `space_added_mass.resist`."""
    ends, geometry, lines, profile, medium = w.ends, w.geometry, w.lines, w.profile, w.medium
    anchors, active = w.anchors, w.active
    n, step, bristle = most_stations(ends), w.bed[0].step, w.bristle[0]
    P, V, F, q, v = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2)), room1(3), room1(3)
    Q, end_pose, totals, inertia = np.empty((n, 4)), room2(6, 3), room2(TERMS, 3), room2(3, 3)
    clear(totals)
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, e, body = ends[r, 0], ends[r + 1, 0], w.held[w.held_places[r]]
        k = e - s
        advance(body.pose, body.predicted_pose, step, end_pose)
        planar_motion(end_pose, body.facing, q, v)
        stations(q, v, rows(geometry, s, e - s), P[:k], V[:k])
        if not line_kernels.immersed(P[:k], lines[r], profile):
            continue
        forces(P[:k], V[:k], rows(anchors, s, e - s), lines[r], profile, medium[0], F[:k], totals)
        find_drives(P[:k], V[:k], rows(anchors, s, e - s), bristle, step, F[:k], Q[:k])
        clear(inertia)
        for i in range(k):
            fx, fy = F[i, 0], F[i, 1]
            if fx == 0.0 and fy == 0.0:
                continue
            x, y = P[i, 0] - q[0], P[i, 1] - q[1]
            body.wrench[0] += fx
            body.wrench[2] += fy
            body.wrench[4] -= x * fy - y * fx
            add_station_inertia(fx, fy, Q, max(0, i - 1), min(k, i + 2), bristle, x, y, inertia)
            if lines[r].side != 0.0:
                for j in range(max(0, i - 1), min(k - 1, i + 1)):
                    add_normal_inertia(fx, fy, P, Q, i, j, lines[r].side, x, y, inertia)
        add_planar_inertia(inertia, w.bed[0].turn, body.arm, body.added_inertia)


@part
def add_planar_inertia(inertia, turn, arm, added):
    """Add an inertia in the plane (3, 3) to an added inertia (6, 6) of the body, in the world frame.

    inertia is about the reference point, added about the point of twists; arm (3,) m, world frame: from the latter to
    the former. turn (3, 3): rotation from the world to the frame of the bed.
    """
    J = room2(3, 6)  # rates of x, y and the angle of the reference point by the twist
    clear(J)
    for k in range(3):
        J[0, 3 + k], J[1, 3 + k], J[2, k] = turn[0, k], turn[2, k], -turn[1, k]
    for row in range(2):  # velocity of the reference point by rotation about the point of twists
        a, b, c = J[row, 3], J[row, 4], J[row, 5]
        J[row, 0], J[row, 1], J[row, 2] = arm[1] * c - arm[2] * b, arm[2] * a - arm[0] * c, arm[0] * b - arm[1] * a
    for i in range(3):
        for j in range(3):
            if inertia[i, j] == 0.0:
                continue
            for a in range(6):
                k = inertia[i, j] * J[i, a]
                for b in range(6):
                    added[a, b] += k * J[j, b]


@part
def add_directed_mass(mass, nx, ny, x, y, inertia):
    """Add a mass (kg) at x, y (m) from the reference point, which acts along n alone, to an inertia (3, 3)."""
    direction = nx, ny, x * ny - y * nx
    for i in range(3):
        for j in range(3):
            inertia[i, j] += mass * direction[i] * direction[j]


@part
def find_drives(P, V, anchors, bristle, step, F, Q):
    """Fill Q (n, 4): the components x, y of q (m) at each station, and their h (s h + tau) of `added_mass` (s^2).

    Stations without a force F (n, 2) whose neighbours have none either are skipped.
    """
    n = P.shape[0]
    for i in range(n):
        needed = False
        for j in range(max(0, i - 1), min(n, i + 2)):
            needed = needed or F[j, 0] != 0.0 or F[j, 1] != 0.0
        if not needed:
            continue
        ex, ey, vx, vy = P[i, 0] - anchors[i, 0], P[i, 1] - anchors[i, 1], V[i, 0], V[i, 1]
        if bristle.by_component and bristle.friction != SMOOTH:
            qx, qy = bristle.u_y * drive_along(ex, vx, bristle), bristle.u_y * drive_along(ey, vy, bristle)
            Q[i, 0], Q[i, 1] = qx, qy
            Q[i, 2], Q[i, 3] = growth(ex, vx, qx, bristle, step), growth(ey, vy, qy, bristle, step)
            continue
        share, tau = factors((ex, ey), (vx, vy), bristle)
        Q[i, 0], Q[i, 1] = share * ex + tau * vx, share * ey + tau * vy
        Q[i, 2] = Q[i, 3] = step * (share * step + tau)


@part
def growth(e, v, q, bristle, step):
    """Factor h (s h + tau) (s^2) of one component, from stretch e (m), velocity v (m/s) and drive q (m)."""
    share = min(1.0, bristle.u_y / abs(e)) if e != 0.0 else 1.0
    tau = max(bristle.tau, abs(q - share * e) / abs(v)) if v != 0.0 else bristle.tau
    return step * (share * step + tau)


@part
def add_station_inertia(fx, fy, Q, first, last, bristle, x, y, inertia):
    """Add the added inertia of a station with a force (N) at x, y (m) from the reference point to inertia (3, 3).

    first, last: range of the station and its neighbours, of which the largest q is taken.
    """
    qx, qy, gx, gy = 0.0, 0.0, 0.0, 0.0
    for i in range(first, last):
        qx, qy = max(qx, abs(Q[i, 0])), max(qy, abs(Q[i, 1]))
        gx, gy = max(gx, Q[i, 2]), max(gy, Q[i, 3])
    fx, fy = abs(fx), abs(fy)
    if not bristle.by_component or bristle.friction == SMOOTH:
        square = qx * qx + qy * qy
        if square > 0.0:
            mass = max(gx, gy) * math.sqrt((fx * fx + fy * fy) / square)
            add_directed_mass(mass, 1.0, 0.0, x, y, inertia)
            add_directed_mass(mass, 0.0, 1.0, x, y, inertia)
        return
    if qx > 0.0:
        add_directed_mass(gx * fx / qx, 1.0, 0.0, x, y, inertia)
    if qy > 0.0:
        add_directed_mass(gy * fy / qy, 0.0, 1.0, x, y, inertia)


@part
def add_normal_inertia(fx, fy, P, Q, i, j, side, x, y, inertia):
    """Add the added mass of station i along the normal of strip j of an outline, beyond its isotropic added mass."""
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
        add_directed_mass(mass, nx, ny, x, y, inertia)
