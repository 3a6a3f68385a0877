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
from granular_contact.sand.kernels.facet_blocks import spread, vector
from granular_contact.sand.kernels.facet_records import LANES, as_facets, block_room
from granular_contact.sand.kernels.facet_slopes import force
from granular_contact.sand.kernels.facets import add_up
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.ground import GROWTH
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.kernels.space_friction import factors_of_facet
from granular_contact.sand.kernels.vectors import at, cross, xyz


@part
def held_facets(elements, anchors, cluster, pose, ground, medium, step, bristle, W, inertia):
    """Add the wrench on facets at a pose (6, 3) to W (6,), and what they add to the inertia (6, 6) of their body.

    W as of one term of `space_law.forces`. inertia is about the reference point, for angular velocity and then
    velocity, frame of the body; its upper triangle alone is filled.
    """
    block, M, each, first = block_room(), room2(2, LANES), room2(TERMS, 6), 0
    facets = as_facets(elements)
    clear(each)
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, block))
        if n == 0:
            continue
        law.facets(medium, (block, n))
        add_up(block, n, each)
        weigh(block, n, step, bristle, M)
        for k in range(n):
            if M[0, k] == 0.0 and M[1, k] == 0.0:
                continue
            facet = facets[block.row[k]]
            x, y, z = xyz(facet.centroid)
            mass, along = M[0, k], M[1, k]
            reach = facet.reach * ground[GROWTH]
            if block.centroid_depth[k] < reach:  # as if the surface did not cut it: in a step it may get all below
                whole = 0.5 * (block.centroid_depth[k] + reach) * facet.area / (block.area[k] * block.depth[k])
                mass, along = mass * whole, along * whole
            add_point(mass, x, y, z, inertia)
            if along != 0.0:
                add_inertia(along, facet.normal[0], facet.normal[1], facet.normal[2], x, y, z, inertia)
    for term in range(TERMS):
        for k in range(6):
            W[k] += each[term, k]


@part(inline=True)
def weigh(block, n, step, bristle, M):
    """Set M[0] (kg) to the masses of the facets of a block, and M[1] to what each has more of along its normal.

    Nothing where q is 0, or n . q not positive: such a facet has no bristle to weigh, or is not loaded. Where both
    the resistance and what is loaded of a facet grow with q, up to `pressed` (see `facet_blocks`), the force
    grows with its square, so the slope is twice the secant: with the secant alone a step would overshoot by as much as
    it was off, and what stands would not come to rest.
    """
    smooth = bristle.friction == SMOOTH
    for k in range(n):
        (ex, ey, ez), (vx, vy, vz) = vector(block.stretch, k), vector(block.velocity, k)
        nx, ny, nz = vector(block.normal, k)
        share, tau, turns = factors_of_facet((ex, ey, ez), (vx, vy, vz), bristle)
        if smooth:
            share, tau, turns = 0.0, 1.0, 1.0
        qx, qy, qz = share * ex + tau * vx, share * ey + tau * vy, share * ez + tau * vz
        q = math.sqrt(qx * qx + qy * qy + qz * qz)
        s = spread(block, k, qx, qy, qz, turns)
        along = nx * qx + ny * qy + nz * qz + s
        fades = block.side[k] != 0.0 and bristle.pressed > EDGE * q and along < bristle.pressed + 2.0 * s
        if block.side[k] == 0.0:
            along = q
        fx, fy, fz = force(block, 0, k), force(block, 1, k), force(block, 2, k)
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
