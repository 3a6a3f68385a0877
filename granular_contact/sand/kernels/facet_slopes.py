"""How the wrench on facets follows the motion of their body: Newton's matrix, facet by facet.

A facet at r from the reference point moves by p = x + t x r where its body moves by x and turns by t. With the slope
K = fq dF/dp + fv dF/dp' of the force on each, the wrench (F, r x F) follows (x, t) by

    sum  (1; [r]) K (1, -[r]),    [r] t = r x t.

K is by differences of the law alone, with bristle and velocity moved along each axis; of depth it is exact, as over the
immersed part of a facet int z dA grows by A dz. One look at the facets and four at the law, where differences of the
wrench would take as many of both as a body has coordinates, and one. Left out is what the turn of normals and of forces
does: F t beside F t r / u_y, of a bristle that yields at u_y.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1, room2
from granular_contact.sand.kernels import space_law as law
from granular_contact.sand.kernels.facet_blocks import (
    AREA,
    AT_FIRST,
    CONSTANT,
    FIRST,
    GROWING,
    LANES,
    ROWS,
    SECOND,
    E,
    V,
    Z,
)
from granular_contact.sand.kernels.facets import add_up
from granular_contact.sand.kernels.ground import PLANE, surface_at
from granular_contact.sand.kernels.lines import difference


@part
def facet_slopes(elements, anchors, cluster, pose, ground, medium, fq, fv, S, W):
    """`space_law.slopes` of facets."""
    B, F, D, first = room2(ROWS, LANES), room2(3, LANES), room2(9, LANES), 0
    d = difference(pose[3], fq, fv)
    while first < elements.shape[0]:
        first, n = law.gather(medium, (elements, anchors, cluster, pose, ground, first, B))
        if n == 0:
            continue
        law.facets(medium, (B, n))
        add_up(B, n, W)
        begin(B, n, fq, pose, ground, medium, F, D)
        for axis in range(3):
            move(B, n, axis, d * fq, d * fv)
            if medium.lead != 0:
                law.lead(medium, (B, n))
            law.facets(medium, (B, n))
            move(B, n, axis, -d * fq, -d * fv)
            for i in range(3):
                for k in range(n):
                    D[3 * axis + i, k] += (force(B, i, k) - F[i, k]) / d
        add_slopes(B, n, D, S)


@part(inline=True)
def force(B, i, k):
    """Component i of the force (N) on a facet of a block."""
    growing, constant = B[Z, k] * B[FIRST, k] * B[GROWING + i, k], B[SECOND, k] * B[CONSTANT + i, k]
    return B[AREA, k] * (growing + constant)


@part
def begin(B, n, fq, pose, ground, medium, F, D):
    """Fill F (3, LANES) with the forces of a block, and D (9, LANES) with what they follow of depth."""
    plane = room1(PLANE)
    for k in range(n):
        surface_at(pose[3, 0] + B[AT_FIRST, k], pose[3, 1] + B[AT_FIRST + 1, k], ground, medium, plane)
        for i in range(3):
            F[i, k] = force(B, i, k)
            of_depth = fq * B[AREA, k] * B[FIRST, k] * B[GROWING + i, k]
            D[i, k], D[3 + i, k], D[6 + i, k] = plane[1] * of_depth, plane[2] * of_depth, -of_depth


@part
def move(B, n, axis, by_q, by_v):
    """Move the bristles of a block by by_q (m) along an axis, and their velocities by by_v (m/s)."""
    for k in range(n):
        B[E + axis, k] += by_q
        B[V + axis, k] += by_v


@part
def add_slopes(B, n, D, S):
    """Add what the facets of a block with the slopes D (9, LANES) do to S (6, 6)."""
    R = room2(3, 6)
    for k in range(n):
        x, y, z = B[AT_FIRST, k], B[AT_FIRST + 1, k], B[AT_FIRST + 2, k]
        for i in range(3):
            a, b, c = D[i, k], D[3 + i, k], D[6 + i, k]
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
