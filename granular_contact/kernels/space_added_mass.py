"""`added_mass` of bodies in space: facets, strips of bars and balls.

`rows`: how many rows of `elements` an element takes, 2 for the strips of a bar; inner: clusters for all elements of a
cluster but its last, without the free end face. See `space_bodies` for other arguments; `of_bed` (bodies,) are the
places of the bodies in poses, wrench, added and seen.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels import space_law as law
from granular_contact.kernels.added_mass import add_inertia, add_point, advance, to_world
from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.facets import COLUMNS, SHEARED, SIDE
from granular_contact.kernels.friction import SMOOTH
from granular_contact.kernels.friction import drive as drive_along
from granular_contact.kernels.law import TERMS
from granular_contact.kernels.planar_friction import drive as drive_across
from granular_contact.kernels.space_bodies import DEEPEST, bound, may_touch, release
from granular_contact.kernels.space_friction import drive


@kernel(nogil=True)
def follow(bodies, of_bed, clusters, elements, anchors, active, ground, medium, poses, step, seen):
    """End of a step at these poses: anchors follow, and what the next may touch is chosen.

    seen (bodies, 3), of `space_law.DEPTH` and its neighbours, is brought up to date; of what is out of reach the depth
    is a bound.
    """
    near = np.empty(2)
    for b in range(bodies.shape[0]):
        body, pose, saw = bodies[b], poses[of_bed[b]], seen[of_bed[b]]
        bound(body, pose, ground, near)
        within, deepest = may_touch(near, step), near[DEEPEST]
        if not within:
            saw[law.DEPTH] = max(saw[law.DEPTH], deepest)
        for c in range(body.first, body.last):
            now = within
            if within:
                bound(clusters[c], pose, ground, near)
                now = may_touch(near, step)
            s, e = clusters[c].first, clusters[c].last
            if now and active[c]:
                law.follow(elements[s:e], anchors[s:e], clusters[c], pose, ground, medium[0], saw)
            elif now:
                release(elements, anchors, clusters[c], pose)
            if within and not (now and active[c]):
                saw[law.DEPTH] = max(saw[law.DEPTH], near[DEEPEST])
            active[c] = now


@kernel(nogil=True)
def begin(bodies, of_bed, clusters, elements, anchors, active, ground, poses, step, seen):
    """Begin at these poses: no bristle is stretched; seen as of `follow`, all depths are bounds."""
    near = np.empty(2)
    for b in range(bodies.shape[0]):
        body, pose, saw = bodies[b], poses[of_bed[b]], seen[of_bed[b]]
        for c in range(body.first, body.last):
            release(elements, anchors, clusters[c], pose)
            bound(clusters[c], pose, ground, near)
            saw[law.DEPTH] = max(saw[law.DEPTH], near[DEEPEST])
            active[c] = may_touch(near, step)


@kernel(nogil=True)
def resist(
    bodies, of_bed, clusters, inner, elements, anchors, active, ground, medium, bristle, rows, poses, then, step, turn,
    arms, wrench, added,
):  # fmt: skip
    """Add forces where the step ends to wrench, and inertia to added.

    Both are about the reference point of a body where it starts. then (bodies, 6, 3): poses with the velocities at the
    end of the step; turn (3, 3) as of `space_bodies`.
    """
    W, ahead, near = np.empty((TERMS, 6)), np.empty((6, 3)), np.empty(2)
    for b in range(bodies.shape[0]):
        body, at = bodies[b], of_bed[b]
        advance(poses[at], then[at], step, ahead)
        for c in range(body.first, body.last):
            if not active[c]:
                continue
            bound(clusters[c], ahead, ground, near)
            if near[DEEPEST] <= 0.0:
                continue
            W[:] = 0.0
            s, e = clusters[c].first, clusters[c].last
            law.forces(elements[s:e], anchors[s:e], clusters[c], ahead, ground, medium[0], W)
            if not W.any():
                continue
            for k in range(6):
                wrench[at, k] += total(W, k)
            if elements.shape[1] == COLUMNS:
                on = (elements[s:e], anchors[s:e], ground, medium[0])
                weigh_facets(*on, poses[at], ahead, step, bristle[0], turn, arms[at], added[at])
                continue
            for i in range(s, e - rows + 1):
                W[:] = 0.0
                E, A = elements[i : i + rows], anchors[i : i + rows]
                law.forces(E, A, clusters[c] if i == e - rows else inner[c], ahead, ground, medium[0], W)
                fx, fy, fz = total(W, 0), total(W, 1), total(W, 2)
                if fx != 0.0 or fy != 0.0 or fz != 0.0:
                    weigh(fx, fy, fz, E, A, poses[at], ahead, step, bristle[0], turn, arms[at], added[at])


@part
def total(W, k):
    """Component k of all terms together."""
    found = 0.0
    for term in range(TERMS):
        found += W[term, k]
    return found


@part
def weigh_facets(elements, anchors, ground, medium, pose, ahead, step, bristle, turn, arm, added):
    """Add the inertia of facets to that of their body.

    The force on one is that at its centroid; on one that the surface cuts, in the middle of what is below. Written out
    as `facets.facet_forces` is, which is several times as fast as with functions for each vector.
    """
    r00, r01, r02 = ahead[0, 0], ahead[0, 1], ahead[0, 2]
    r10, r11, r12 = ahead[1, 0], ahead[1, 1], ahead[1, 2]
    r20, r21, r22 = ahead[2, 0], ahead[2, 1], ahead[2, 2]
    x0, y0, z0 = ahead[3, 0], ahead[3, 1], ahead[3, 2]
    v0, v1, v2 = ahead[4, 0], ahead[4, 1], ahead[4, 2]
    w0, w1, w2 = ahead[5, 0], ahead[5, 1], ahead[5, 2]
    q0, q1, q2 = r00 * w0 + r10 * w1 + r20 * w2, r01 * w0 + r11 * w1 + r21 * w2, r02 * w0 + r12 * w1 + r22 * w2
    height, risex, risey, steep = ground[0], ground[1], ground[2], ground[3]
    for i in range(elements.shape[0]):
        bx, by, bz = elements[i, 0], elements[i, 1], elements[i, 2]
        rx, ry, rz = (
            r00 * bx + r01 * by + r02 * bz,
            r10 * bx + r11 * by + r12 * bz,
            r20 * bx + r21 * by + r22 * bz,
        )
        px, py, pz = x0 + rx, y0 + ry, z0 + rz
        z, reach = height + risex * px + risey * py - pz, elements[i, 3] * steep
        if z <= -reach:
            continue
        cx, cy, cz = elements[i, 4], elements[i, 5], elements[i, 6]
        nx, ny, nz = (
            r00 * cx + r01 * cy + r02 * cz,
            r10 * cx + r11 * cy + r12 * cz,
            r20 * cx + r21 * cy + r22 * cz,
        )
        vx, vy, vz = v0 + w1 * rz - w2 * ry, v1 + w2 * rx - w0 * rz, v2 + w0 * ry - w1 * rx
        ex, ey, ez = px - anchors[i, 0], py - anchors[i, 1], pz - anchors[i, 2]
        side, spread = elements[i, SIDE], 0.0
        if side != 0.0:
            tx, ty, tz = cy * q2 - cz * q1, cz * q0 - cx * q2, cx * q1 - cy * q0
            za = tx * elements[i, 8] + ty * elements[i, 9] + tz * elements[i, 10]
            zb = tx * elements[i, 11] + ty * elements[i, 12] + tz * elements[i, 13]
            spread = max(abs(za), abs(zb), abs(za + zb))
            if nx * vx + ny * vy + nz * vz <= -spread and nx * ex + ny * ey + nz * ez <= 0.0:
                continue
        qx, qy, qz, tau = drive(ex, ey, ez, vx, vy, vz, bristle)
        q, h = math.sqrt(qx * qx + qy * qy + qz * qz), math.sqrt(ex * ex + ey * ey + ez * ez)
        along = nx * qx + ny * qy + nz * qz + tau * spread
        if q == 0.0 or (side != 0.0 and along <= 0.0):
            continue
        mean = z if z > reach else 0.5 * (z + reach)
        way = anchors[i, SHEARED] + h if anchors.shape[1] > 3 else np.inf
        gx, gy, gz, sx, sy, sz = law.facet(mean, nx, ny, nz, vx, vy, vz, ex, ey, ez, spread, side, way, medium)
        fx, fy, fz = mean * gx + sx, mean * gy + sy, mean * gz + sz
        share = 0.0 if bristle.friction == SMOOTH else min(1.0, bristle.u_y / h) if h > 0.0 else 1.0
        growth = step * (share * step + tau) * elements[i, 7] * math.sqrt(fx * fx + fy * fy + fz * fz)
        if growth == 0.0:
            continue
        rx, ry, rz = (
            pose[0, 0] * bx + pose[0, 1] * by + pose[0, 2] * bz,
            pose[1, 0] * bx + pose[1, 1] * by + pose[1, 2] * bz,
            pose[2, 0] * bx + pose[2, 1] * by + pose[2, 2] * bz,
        )
        x = arm[0] + turn[0, 0] * rx + turn[1, 0] * ry + turn[2, 0] * rz
        y = arm[1] + turn[0, 1] * rx + turn[1, 1] * ry + turn[2, 1] * rz
        z = arm[2] + turn[0, 2] * rx + turn[1, 2] * ry + turn[2, 2] * rz
        add_point(growth / q, x, y, z, added)
        if side != 0.0 and along < q:
            nx, ny, nz = (
                turn[0, 0] * nx + turn[1, 0] * ny + turn[2, 0] * nz,
                turn[0, 1] * nx + turn[1, 1] * ny + turn[2, 1] * nz,
                turn[0, 2] * nx + turn[1, 2] * ny + turn[2, 2] * nz,
            )
            add_inertia(growth / along - growth / q, nx, ny, nz, x, y, z, added)


@part
def weigh(fx, fy, fz, E, A, pose, ahead, step, bristle, turn, arm, added):
    """Add the inertia of a strip or a ball with this force (N), rows E with anchors A, to that of its body."""
    n = 1.0 / E.shape[0]
    bx, by, bz, ax, ay, az = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(E.shape[0]):
        bx, by, bz = bx + n * E[i, 0], by + n * E[i, 1], bz + n * E[i, 2]
        ax, ay, az = ax + n * A[i, 0], ay + n * A[i, 1], az + n * A[i, 2]
    w, v = ahead[5], ahead[4]
    rx, ry, rz = turned(ahead, bx, by, bz)
    vx, vy, vz = v[0] + w[1] * rz - w[2] * ry, v[1] + w[2] * rx - w[0] * rz, v[2] + w[0] * ry - w[1] * rx
    ex, ey, ez = ahead[3, 0] + rx - ax, ahead[3, 1] + ry - ay, ahead[3, 2] + rz - az
    rx, ry, rz = turned(pose, bx, by, bz)
    x, y, z = to_world(turn, rx, ry, rz)
    x, y, z = x + arm[0], y + arm[1], z + arm[2]
    if bristle.parted and bristle.friction != SMOOTH:
        qx, qy = drive_across(ex, ey, vx, vy, bristle)
        mass = secant(math.hypot(fx, fy), math.hypot(qx, qy), math.hypot(ex, ey), math.hypot(vx, vy), bristle, step)
        qz = bristle.u_y * drive_along(ez, vz, bristle)
        upward = secant(abs(fz), abs(qz), abs(ez), abs(vz), bristle, step)
        add_point(mass, x, y, z, added)
        add_inertia(upward - mass, turn[2, 0], turn[2, 1], turn[2, 2], x, y, z, added)
        return
    qx, qy, qz, tau = drive(ex, ey, ez, vx, vy, vz, bristle)
    q, h = math.sqrt(qx * qx + qy * qy + qz * qz), math.sqrt(ex * ex + ey * ey + ez * ez)
    if q == 0.0:
        return
    share = 0.0 if bristle.friction == SMOOTH else min(1.0, bristle.u_y / h) if h > 0.0 else 1.0
    growth = step * (share * step + tau) * math.sqrt(fx * fx + fy * fy + fz * fz)
    add_point(growth / q, x, y, z, added)


@part
def turned(R, x, y, z):
    """A vector (3,) of the frame of a body in that of the bed."""
    return (
        R[0, 0] * x + R[0, 1] * y + R[0, 2] * z,
        R[1, 0] * x + R[1, 1] * y + R[1, 2] * z,
        R[2, 0] * x + R[2, 1] * y + R[2, 2] * z,
    )


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
