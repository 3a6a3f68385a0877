"""Facets with forces that are made implicit: their wrench, and the inertia that stands for how it changes in a step.

As `facets.facet_forces`, with one look at each facet for both. The inertia of a body is added up in its own frame,
where centroids and normals stay as they are, and is turned once.
"""

from __future__ import annotations

import math

from granular_contact.engines.mujoco.kernels.added_mass import add_inertia, add_point
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_blocks import (
    AREA,
    CENTRE,
    LANES,
    ONE_SIDE,
    ROW,
    ROWS,
    E,
    N,
    V,
    Z,
    spread,
)
from granular_contact.sand.kernels.facet_slopes import force
from granular_contact.sand.kernels.facets import add_up
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.kernels.space_friction import factors_of_facet
from granular_contact.sand.kernels.vectors import at, cross


@part
def held_facets(elements, anchors, cluster, pose, ground, medium, step, bristle, W, inertia):
    """Add the wrench on facets at a pose (6, 3) to W (6,), and what they add to the inertia (6, 6) of their body.

    W as of one term of `space_law.forces`. inertia is about the reference point, for angular velocity and then
    velocity, frame of the body; its upper triangle alone is filled.
    """
    B, M, each, first = room2(ROWS, LANES), room2(2, LANES), room2(TERMS, 6), 0
    clear(each)
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, B))
        if n == 0:
            continue
        law.facets(medium, (B, n))
        add_up(B, n, each)
        weigh(B, n, step, bristle, M)
        for k in range(n):
            if M[0, k] == 0.0 and M[1, k] == 0.0:
                continue
            i = int(B[ROW, k])
            x, y, z = elements[i, 0], elements[i, 1], elements[i, 2]
            mass, along = M[0, k], M[1, k]
            reach = elements[i, 3] * ground[3]
            if B[CENTRE, k] < reach:  # as if the surface did not cut it: in a step it may get all below
                whole = 0.5 * (B[CENTRE, k] + reach) * elements[i, 7] / (B[AREA, k] * B[Z, k])
                mass, along = mass * whole, along * whole
            add_point(mass, x, y, z, inertia)
            if along != 0.0:
                add_inertia(along, elements[i, 4], elements[i, 5], elements[i, 6], x, y, z, inertia)
    for term in range(TERMS):
        for k in range(6):
            W[k] += each[term, k]


@part(inline=True)
def weigh(B, n, step, bristle, M):
    """Set M[0] (kg) to the masses of the facets of a block, and M[1] to what each has more of along its normal.

    Nothing where q is 0, or n . q not positive: such a facet has no bristle to weigh, or is not loaded. Where both
    the resistance and what is loaded of a facet grow with q, up to `pressed` (see `facet_blocks`), the force
    grows with its square, so the slope is twice the secant: with the secant alone a step would overshoot by as much as
    it was off, and what stands would not come to rest.
    """
    smooth = bristle.friction == SMOOTH
    for k in range(n):
        ex, ey, ez, vx, vy, vz = B[E, k], B[E + 1, k], B[E + 2, k], B[V, k], B[V + 1, k], B[V + 2, k]
        share, tau, turns = factors_of_facet((ex, ey, ez), (vx, vy, vz), bristle)
        if smooth:
            share, tau, turns = 0.0, 1.0, 1.0
        qx, qy, qz = share * ex + tau * vx, share * ey + tau * vy, share * ez + tau * vz
        q = math.sqrt(qx * qx + qy * qy + qz * qz)
        s = spread(B, k, qx, qy, qz, turns)
        along = B[N, k] * qx + B[N + 1, k] * qy + B[N + 2, k] * qz + s
        fades = B[ONE_SIDE, k] != 0.0 and bristle.pressed > EDGE * q and along < bristle.pressed + 2.0 * s
        if B[ONE_SIDE, k] == 0.0:
            along = q
        fx, fy, fz = force(B, 0, k), force(B, 1, k), force(B, 2, k)
        grown = step * (share * step + tau) * math.sqrt(fx * fx + fy * fy + fz * fz)
        M[0, k] = M[1, k] = 0.0
        if q > 0.0 and along > 0.0:
            M[0, k] = (2.0 if fades else 1.0) * grown / q
            M[1, k] = max(0.0, grown * (1.0 / along - 1.0 / q))


@part
def add_turned(inertia, pose, turn, arm, added):
    """Add an inertia in the frame of a body, its upper triangle, to added (6, 6); arm (3,) and turn as there."""
    B, T = room2(6, 6), room2(6, 6)  # twist in the frame of the body by that in the world
    clear(B)
    for i in range(3):
        for j in range(3):
            r = turn[0, j] * pose[0, i] + turn[1, j] * pose[1, i] + turn[2, j] * pose[2, i]
            B[i, j] = B[3 + i, 3 + j] = r
        B[3 + i, 0], B[3 + i, 1], B[3 + i, 2] = cross(arm, at(B, 3 + i, 3))
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
