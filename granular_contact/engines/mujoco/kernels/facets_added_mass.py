"""Wrench on the facets of a body, and the inertia that makes their forces implicit in a step, see `added_mass`.

As `facets.facet_forces`; one pass over the facets computes both. The inertia is added up in the frame of the body, in
which centroids and normals are constant, and is rotated once.
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
def facet_wrench_and_inertia(elements, anchors, cluster, pose, ground, medium, step, bristle, W, inertia):
    """Add the wrench on facets at a pose (6, 3) to W (6,), and their added inertia to `inertia` (6, 6) of their body.

    W: sum of all terms, each as in `space_law.forces`. inertia: about the reference point, for angular velocity and
    then velocity, in the frame of the body; only its upper triangle is filled. step (s).
    """
    block, M, W_terms, first = block_room(), room2(2, LANES), room2(TERMS, 6), 0
    facets = as_facets(elements)
    clear(W_terms)
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, block))
        if n == 0:
            continue
        law.facets(medium, (block, n))
        add_up(block, n, W_terms)
        facet_masses(block, n, step, bristle, M)
        for k in range(n):
            if M[0, k] == 0.0 and M[1, k] == 0.0:
                continue
            facet = facets[block.row[k]]
            x, y, z = xyz(facet.centroid)
            mass, along = M[0, k], M[1, k]
            reach = facet.reach * ground[GROWTH]
            if block.centroid_depth[k] < reach:
                # The surface may cut the facet; all of it may be immersed at the end of the step.
                growth = 0.5 * (block.centroid_depth[k] + reach) * facet.area / (block.area[k] * block.depth[k])
                mass, along = mass * growth, along * growth
            add_point(mass, x, y, z, inertia)
            if along != 0.0:
                add_inertia(along, facet.normal[0], facet.normal[1], facet.normal[2], x, y, z, inertia)
    for term in range(TERMS):
        for k in range(6):
            W[k] += W_terms[term, k]


@part(inline=True)
def facet_masses(block, n, step, bristle, M):
    """Set M[0] (kg) to the added masses of the n facets of a block, and M[1] (kg) to what each adds along its normal.

    A facet with q = 0 has no stretched bristle, and one with n . q <= 0 is not loaded; both have no added mass. Up to
    `pressed` (see `facet_blocks`) the resistance and the loaded part of a facet both grow with q, so that the force
    grows with the square of q and the tangent is twice the secant. With the secant alone a step would overshoot by as
    much as the state was off, and a body that stands would not come to rest.
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
        is_partly_loaded = block.side[k] != 0.0 and bristle.pressed > EDGE * q and along < bristle.pressed + 2.0 * s
        if block.side[k] == 0.0:
            along = q
        fx, fy, fz = force(block, 0, k), force(block, 1, k), force(block, 2, k)
        mass_times_q = step * (share * step + tau) * math.sqrt(fx * fx + fy * fy + fz * fz)
        M[0, k] = M[1, k] = 0.0
        if q > 0.0 and along > 0.0:
            M[0, k] = (2.0 if is_partly_loaded else 1.0) * mass_times_q / q
            M[1, k] = max(0.0, mass_times_q * (1.0 / along - 1.0 / q))


@part
def add_rotated_inertia(inertia, pose, turn, arm, added):
    """Add an inertia (6, 6) in the frame of a body, given by its upper triangle, to added (6, 6) in the world frame.

    inertia is about the reference point, added about the point of twists; arm (3,) m, world frame: from the latter to
    the former. pose (6, 3): of the body in the frame of the bed; turn (3, 3): rotation from the world to that frame.
    """
    B, T = room2(6, 6), room2(6, 6)  # B: twist in the frame of the body by the twist in the world; T: inertia B
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
