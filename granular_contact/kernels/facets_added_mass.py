"""Facets with forces that are made implicit: their wrench, and the inertia that stands for how it changes in a step.

As `facets.facet_forces`, with one look at each facet for both: the law is what takes time. The inertia of a body is
added up in its own frame, where centroids and normals stay as they are, and is turned once.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels import space_law as law
from granular_contact.kernels.compiled import part
from granular_contact.kernels.facets import SHEARED, SIDE, along_square, immersion
from granular_contact.kernels.friction import SMOOTH
from granular_contact.kernels.memory import clear, room2
from granular_contact.kernels.space_friction import drive


@part
def held_facets(elements, anchors, pose, ground, medium, step, bristle, W, inertia):
    """Add the wrench on facets at a pose (6, 3) to W (6,), and what they add to the inertia (6, 6) of their body.

    W as of one term of `space_law.forces`. inertia is about the reference point, for angular velocity and then
    velocity, frame of the body; its upper triangle alone is filled.
    """
    r00, r01, r02 = pose[0, 0], pose[0, 1], pose[0, 2]
    r10, r11, r12 = pose[1, 0], pose[1, 1], pose[1, 2]
    r20, r21, r22 = pose[2, 0], pose[2, 1], pose[2, 2]
    x0, y0, z0 = pose[3, 0], pose[3, 1], pose[3, 2]
    v0, v1, v2 = pose[4, 0], pose[4, 1], pose[4, 2]
    w0, w1, w2 = pose[5, 0], pose[5, 1], pose[5, 2]
    height, risex, risey, steep = ground[0], ground[1], ground[2], ground[3]
    dx, dy, dz = risex * r00 + risey * r10 - r20, risex * r01 + risey * r11 - r21, risex * r02 + risey * r12 - r22
    q0, q1, q2 = r00 * w0 + r10 * w1 + r20 * w2, r01 * w0 + r11 * w1 + r21 * w2, r02 * w0 + r12 * w1 + r22 * w2
    depth = height + risex * x0 + risey * y0 - z0  # of the reference point
    s0, s1, s2, s3, s4, s5 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(elements.shape[0]):
        bx, by, bz = elements[i, 0], elements[i, 1], elements[i, 2]
        z = depth + dx * bx + dy * by + dz * bz
        if z + elements[i, 3] * steep <= 0.0:
            continue
        rx, ry, rz = (
            r00 * bx + r01 * by + r02 * bz,
            r10 * bx + r11 * by + r12 * bz,
            r20 * bx + r21 * by + r22 * bz,
        )
        cx, cy, cz = elements[i, 4], elements[i, 5], elements[i, 6]
        nx, ny, nz = (
            r00 * cx + r01 * cy + r02 * cz,
            r10 * cx + r11 * cy + r12 * cz,
            r20 * cx + r21 * cy + r22 * cz,
        )
        vx, vy, vz = v0 + w1 * rz - w2 * ry, v1 + w2 * rx - w0 * rz, v2 + w0 * ry - w1 * rx
        ex, ey, ez = x0 + rx - anchors[i, 0], y0 + ry - anchors[i, 1], z0 + rz - anchors[i, 2]
        # Along the facet n . v differs by (n x w) . d, seen from the body.
        tx, ty, tz = cy * q2 - cz * q1, cz * q0 - cx * q2, cx * q1 - cy * q0
        ax, ay, az = elements[i, 8], elements[i, 9], elements[i, 10]
        gx, gy, gz = elements[i, 11], elements[i, 12], elements[i, 13]
        za, zb = tx * ax + ty * ay + tz * az, tx * gx + ty * gy + tz * gz
        spread = max(abs(za), abs(zb), abs(za + zb))
        side = elements[i, SIDE]
        if side != 0.0 and nx * vx + ny * vy + nz * vz <= -spread and nx * ex + ny * ey + nz * ez <= 0.0:
            continue  # nothing that it is led by, neither motion nor bristle
        za, zb = dx * ax + dy * ay + dz * az, dx * gx + dy * gy + dz * gz
        if medium.layered:
            share, mean, ox, oy, oz, hx, hy, hz = law.in_layer(z, za, zb, ax, ay, az, gx, gy, gz, medium)
        else:
            share, mean, ox, oy, oz, hx, hy, hz = immersion(z, za, zb, ax, ay, az, gx, gy, gz)
        if share <= 0.0:
            continue
        j = np.inf
        if anchors.shape[1] > 3:
            j = anchors[i, SHEARED] + math.sqrt(along_square(ex, ey, ez, nx, ny, nz))
        gx, gy, gz, qx, qy, qz = law.facet(mean, nx, ny, nz, vx, vy, vz, ex, ey, ez, spread, side, j, medium)
        area = elements[i, 7] * share
        k = area * mean
        gx, gy, gz, qx, qy, qz = k * gx, k * gy, k * gz, area * qx, area * qy, area * qz
        ax, ay, az = (
            rx + r00 * hx + r01 * hy + r02 * hz,
            ry + r10 * hx + r11 * hy + r12 * hz,
            rz + r20 * hx + r21 * hy + r22 * hz,
        )
        hx, hy, hz = (
            rx + r00 * ox + r01 * oy + r02 * oz,
            ry + r10 * ox + r11 * oy + r12 * oz,
            rz + r20 * ox + r21 * oy + r22 * oz,
        )
        fx, fy, fz = gx + qx, gy + qy, gz + qz
        s0, s1, s2 = s0 + fx, s1 + fy, s2 + fz
        s3, s4, s5 = (
            s3 + ay * gz - az * gy + hy * qz - hz * qy,
            s4 + az * gx - ax * gz + hz * qx - hx * qz,
            s5 + ax * gy - ay * gx + hx * qy - hy * qx,
        )
        square = fx * fx + fy * fy + fz * fz
        if square > 0.0:
            qx, qy, qz, tau = drive(ex, ey, ez, vx, vy, vz, bristle)
            along = nx * qx + ny * qy + nz * qz + tau * spread
            far = math.sqrt(ex * ex + ey * ey + ez * ez)
            part = 0.0 if bristle.friction == SMOOTH else min(1.0, bristle.u_y / far) if far > 0.0 else 1.0
            reach = elements[i, 3] * steep
            if z < reach:  # as if the surface did not cut it: in a step it may get all below
                square *= (0.5 * (z + reach) / (share * mean)) ** 2
            k, q = step * (part * step + tau) * math.sqrt(square), math.sqrt(qx * qx + qy * qy + qz * qz)
            weigh(k, q, along if side != 0.0 else q, bx, by, bz, cx, cy, cz, inertia)
    W[0] += s0
    W[1] += s1
    W[2] += s2
    W[3] += s3
    W[4] += s4
    W[5] += s5


@part
def weigh(k, q, along, x, y, z, nx, ny, nz, A):
    """Add a mass k / q (kg) at a place (m), and along the normal n there k / along, to the upper triangle of A (6, 6).

    Nothing where q is 0, or along is not positive: such an element has no bristle to weigh, or is not loaded.
    """
    if q == 0.0 or along <= 0.0:
        return
    m = k / q
    mx, my, mz = m * x, m * y, m * z
    A[0, 0] += my * y + mz * z
    A[1, 1] += mx * x + mz * z
    A[2, 2] += mx * x + my * y
    A[0, 1] -= mx * y
    A[0, 2] -= mx * z
    A[1, 2] -= my * z
    A[0, 4] -= mz
    A[0, 5] += my
    A[1, 3] += mz
    A[1, 5] -= mx
    A[2, 3] -= my
    A[2, 4] += mx
    A[3, 3] += m
    A[4, 4] += m
    A[5, 5] += m
    if along >= q:
        return
    m = k / along - m
    a, b, c = y * nz - z * ny, z * nx - x * nz, x * ny - y * nx
    d, e, f, g = m * nx, m * ny, m * nz, m * a
    h, i = m * b, m * c
    A[0, 0] += g * a
    A[0, 1] += g * b
    A[0, 2] += g * c
    A[0, 3] += g * nx
    A[0, 4] += g * ny
    A[0, 5] += g * nz
    A[1, 1] += h * b
    A[1, 2] += h * c
    A[1, 3] += h * nx
    A[1, 4] += h * ny
    A[1, 5] += h * nz
    A[2, 2] += i * c
    A[2, 3] += i * nx
    A[2, 4] += i * ny
    A[2, 5] += i * nz
    A[3, 3] += d * nx
    A[3, 4] += d * ny
    A[3, 5] += d * nz
    A[4, 4] += e * ny
    A[4, 5] += e * nz
    A[5, 5] += f * nz


@part
def add_turned(inertia, pose, turn, arm, added):
    """Add an inertia in the frame of a body, its upper triangle, to added (6, 6); arm (3,) and turn as there."""
    B, T = room2(6, 6), room2(6, 6)  # twist in the frame of the body by that in the world
    clear(B)
    for i in range(3):
        for j in range(3):
            r = turn[0, j] * pose[0, i] + turn[1, j] * pose[1, i] + turn[2, j] * pose[2, i]
            B[i, j] = B[3 + i, 3 + j] = r
        x, y, z = B[3 + i, 3], B[3 + i, 4], B[3 + i, 5]
        B[3 + i, 0], B[3 + i, 1], B[3 + i, 2] = (
            arm[1] * z - arm[2] * y,
            arm[2] * x - arm[0] * z,
            arm[0] * y - arm[1] * x,
        )
    for i in range(6):
        for j in range(6):
            k = 0.0
            for c in range(6):
                k += (inertia[i, c] if c >= i else inertia[c, i]) * B[c, j]
            T[i, j] = k
    for i in range(6):
        for j in range(6):
            k = 0.0
            for c in range(6):
                k += B[c, i] * T[c, j]
            added[i, j] += k
