"""Tangent of the wrench on facets: its derivative by the motion of their body, added up facet by facet.

A facet at r from the reference point moves by p = x + t x r where its body moves by x and turns by t. With the tangent
K = fq dF/dp + fv dF/dp' of the force F on each facet, the tangent of the wrench (F, r x F) by (x, t) is

    sum  (1; [r]) K (1, -[r]),    [r] t = r x t.

K is by differences of the law alone, with bristle and velocity moved along each axis; its part by the depth is exact,
as int z dA over the immersed part of a facet grows by A dz. It takes one pass over the facets and four calls of the
law, where differences of the wrench would take one more of both than a body has coordinates. The turn of normals and of
forces is left out: it changes forces by F t, which is small beside F t r / u_y by a bristle that yields at u_y.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_records import LANES, block_room
from granular_contact.sand.kernels.facets import add_up
from granular_contact.sand.kernels.ground import PLANE, RISE_X, RISE_Y, surface_at
from granular_contact.sand.kernels.lines import difference


@part
def facet_slopes(elements, anchors, cluster, pose, ground, medium, fq, fv, S, W):
    """`space_law.slopes` of facets."""
    block, F, K, first = block_room(), room2(3, LANES), room2(9, LANES), 0
    d = difference(pose[law.POSITION], fq, fv)
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, block))
        if n == 0:
            continue
        law.facets(medium, (block, n))
        add_up(block, n, W)
        begin(block, n, fq, pose, ground, medium, F, K)
        for axis in range(3):
            move(block, n, axis, d * fq, d * fv)
            if medium.lead != 0:
                law.lead(medium, (block, n))
            law.facets(medium, (block, n))
            move(block, n, axis, -d * fq, -d * fv)
            for i in range(3):
                for k in range(n):
                    K[3 * axis + i, k] += (force(block, i, k) - F[i, k]) / d
        add_slopes(block, n, K, S)


@part(inline=True)
def force(block, i, k):
    """Component i of the force (N) on facet k of a block."""
    growing = block.depth[k] * block.scatter[0, k] * block.growing[i, k]
    return block.area[k] * (growing + block.scatter[1, k] * block.constant[i, k])


@part
def begin(block, n, fq, pose, ground, medium, F, K):
    """Fill F (3, LANES) with the forces on n facets, and K (9, LANES) with fq times their derivatives by the depth.

    Row 3 j + i of K: derivative of the force along axis i by the displacement along axis j.
    """
    plane, arm = room1(PLANE), block.growing_arm
    for k in range(n):
        surface_at(pose[law.POSITION, 0] + arm[0, k], pose[law.POSITION, 1] + arm[1, k], ground, medium, plane)
        for i in range(3):
            F[i, k] = force(block, i, k)
            by_depth = fq * block.area[k] * block.scatter[0, k] * block.growing[i, k]
            K[i, k], K[3 + i, k], K[6 + i, k] = plane[RISE_X] * by_depth, plane[RISE_Y] * by_depth, -by_depth


@part
def move(block, n, axis, by_q, by_v):
    """Move the bristles of n facets by by_q (m) along an axis, and their velocities by by_v (m/s)."""
    for k in range(n):
        block.stretch[axis, k] += by_q
        block.velocity[axis, k] += by_v


@part
def add_slopes(block, n, K, S):
    """Add the tangents K (9, LANES) of the forces on n facets to the tangent S (6, 6) of the wrench."""
    R = room2(3, 6)
    for k in range(n):
        x, y, z = block.growing_arm[0, k], block.growing_arm[1, k], block.growing_arm[2, k]
        for i in range(3):
            a, b, c = K[i, k], K[3 + i, k], K[6 + i, k]
            R[i, 0], R[i, 1], R[i, 2] = a, b, c
            R[i, 3], R[i, 4], R[i, 5] = y * c - z * b, z * a - x * c, x * b - y * a
        for j in range(6):
            fx, fy, fz = R[0, j], R[1, j], R[2, j]
            S[0, j] += fx
            S[1, j] += fy
            S[2, j] += fz
            S[3, j] += y * fz - z * fy
            S[4, j] += z * fx - x * fz
            S[5, j] += x * fy - y * fx
