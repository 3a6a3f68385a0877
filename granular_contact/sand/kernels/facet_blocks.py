"""A block of facets of which a law finds the tractions in one call: its layout, what leads, and what laws fill.

What a law needs of a facet stands in columns of the block, one number after another for the facets, and its equations
are written for one facet in a loop over them, all inlined and without branches where that is easy: so compilers make
vector instructions of it, which hide how long roots and quotients take.

Only what leads is loaded. With the direction of motion u at the centroid, n . u grows along a and b by s_a and s_b, as
the body turns and as the surface does. A facet counts with g = clip((n . u + s) / (edge + 2 s), 0, 1), s^2 = s_a^2 +
s_b^2: the share of it that leads, n . u being spread evenly over as much as has its mean square, and the fading in of
`plates` where nothing turns. Of a body that rests, with bristles below their yield, the faces beside
it would be loaded or not within a hundredth of a micrometre; so there edge is no angle, but n . q reaches `pressed`, a
part of the yield displacement, before the face is loaded as a whole [ours]. A ball that slides along slowly has up to
1 % less resistance by it, and 4 % less lift, as the flat parts of its underside are loaded in part; at 10 mm/s it has
all.
"""

from __future__ import annotations

import math

from granular_contact.jit.chosen import chosen_by
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room2
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.kernels.space_friction import factors_of_facet
from granular_contact.sand.kernels.vectors import times

# A block (ROWS, LANES): facets that are loaded, in columns, so that a law treats several of them in one instruction.
LANES = 32
# What a law is told, see `space_law.facets`: mean depth of what is immersed, normal, velocity, stretch of the bristle,
# spread along a and b, side, shear displacement. Three rows each where vectors are.
Z, N, V, E, SPREAD, ONE_SIDE, SHEAR = 0, 1, 4, 7, 10, 12, 13
# The immersed area (m^2), by how much the terms of the law scatter, where they act from the reference point (m), the
# depth of the centroid (m), the row in elements; and what the law fills, its tractions.
AREA, FIRST, SECOND, AT_FIRST, AT_SECOND, CENTRE, ROW = 14, 15, 16, 17, 20, 23, 24
GROWING, CONSTANT = 25, 28
# What `lead` fills: the direction in which the law sees the facet move, and the share of its static force. By how much
# the normal of the facet turns along a and along b, three rows each.
U, SHARE, TURN = 31, 34, 35
ROWS = 41
NOTED = GROWING  # rows that `facet_paths` works in before the law fills them


@chosen_by("m")
def stress(n, u, m):
    """Stress per depth (3,) N/m^3 on an element with the normal n that moves in the direction u, z up; even in n."""


@chosen_by("m")
def traction(z, n, u, side, j, m):
    """Stresses (3,) Pa of the first and of the second term of a law at a depth z > 0 (m), else as of `stress`.

    side as of `space_law.facets`: where it is 1 the facet leads, if in part alone, so that n . u at its centroid may be
    below 0; j (m): shear displacement.
    """


@chosen_by("m")
def inertia(n, v, side, m):
    """Stress (3,) Pa of the second term of a law with a `stress`, which the velocity v (m/s) makes; side as there."""


@chosen_by("m")
def force(z, n, v, e, spread, side, j, m):
    """Tractions, two of (3,), of a law that says all of them by itself, on one facet; see `space_law.facets`."""


@part(inline=True)
def spread(B, k, x, y, z, factor):
    """By how much n . (x, y, z) differs within a facet: s as above, m/s of a velocity.

    factor: that of the velocity in (x, y, z), 0 of what does not differ where the body turns.
    """
    a = factor * B[SPREAD, k] + B[TURN, k] * x + B[TURN + 1, k] * y + B[TURN + 2, k] * z
    b = factor * B[SPREAD + 1, k] + B[TURN + 3, k] * x + B[TURN + 4, k] * y + B[TURN + 5, k] * z
    return math.sqrt(a * a + b * b)


@part(inline=True)
def vector(B, row, k):
    """A vector (3,) of a facet of a block."""
    return B[row, k], B[row + 1, k], B[row + 2, k]


@part(inline=True)
def write(a, B, row, k):
    """Write a vector (3,) of a facet into a block."""
    B[row, k], B[row + 1, k], B[row + 2, k] = a


@part
def lead(B, n, m):
    """Fill rows U and SHARE of a block: the directions u in which a law sees facets move, and the shares g s."""
    rest = m.v_eps if m.friction == SMOOTH else m.u_y
    Q = room2(5, LANES)  # q and its factor of what v differs by, see `space_friction.factors_of_facet`; 1 / |q|
    D = room2(4, LANES)  # what is filled
    if m.friction == SMOOTH:
        for k in range(n):
            Q[0, k], Q[1, k], Q[2, k], Q[3, k] = B[V, k], B[V + 1, k], B[V + 2, k], 1.0
    else:
        for k in range(n):
            by_e, by_v, Q[3, k] = factors_of_facet(vector(B, E, k), vector(B, V, k), m)
            for i in range(3):
                Q[i, k] = by_e * B[E + i, k] + by_v * B[V + i, k]
    for k in range(n):
        x, y, z = Q[0, k], Q[1, k], Q[2, k]
        h = math.sqrt(x * x + y * y + z * z)
        still = h == 0.0  # then any direction will do
        one = 0.0 if still else 1.0 / h
        D[0, k] = B[N, k] if still else one * x
        D[1, k] = B[N + 1, k] if still else one * y
        D[2, k] = B[N + 2, k] if still else one * z
        D[3, k] = min(1.0, h / rest)
        Q[4, k] = one
    if m.friction == SMOOTH:
        for k in range(n):
            D[3, k] = math.tanh(math.sqrt(Q[0, k] * Q[0, k] + Q[1, k] * Q[1, k] + Q[2, k] * Q[2, k]) / rest)
    for k in range(n):
        one = Q[4, k]
        s = spread(B, k, D[0, k], D[1, k], D[2, k], Q[3, k] * one)
        along = B[N, k] * D[0, k] + B[N + 1, k] * D[1, k] + B[N + 2, k] * D[2, k]
        g = min(1.0, max(0.0, (along + s) / (max(EDGE, m.pressed * one) + 2.0 * s)))
        D[3, k] *= 1.0 if B[ONE_SIDE, k] == 0.0 else g
    for row in range(4):
        for k in range(n):
            B[U + row, k] = D[row, k]


@part
def traction_facets(B, n, m):
    """Static tractions of a law with a `traction`; arguments and result as of `space_law.facets`.

    Over a facet the first term counts as growing in proportion to the depth, which errs by the square of its size.
    """
    for k in range(n):
        share, z = B[SHARE, k], B[Z, k]
        first, second = traction(z, vector(B, N, k), vector(B, U, k), B[ONE_SIDE, k], B[SHEAR, k], m)
        write(times(share / z, first), B, GROWING, k)
        write(times(share, second), B, CONSTANT, k)


@part
def static_facets(B, n, m):
    """Static tractions of a law with a `stress`; arguments and result as of `space_law.facets`."""
    S = room2(3, LANES)
    for k in range(n):
        share = B[SHARE, k]
        x, y, z = stress(vector(B, N, k), vector(B, U, k), m)
        S[0, k], S[1, k], S[2, k] = share * x, share * y, share * z
    for row in range(3):
        for k in range(n):
            B[GROWING + row, k], B[CONSTANT + row, k] = S[row, k], 0.0


@part
def own_facets(B, n, m):
    """Tractions of a law with a `force`; arguments and result as of `space_law.facets`."""
    for k in range(n):
        v = vector(B, V, k)
        s = spread(B, k, v[0], v[1], v[2], 1.0)
        first, second = force(B[Z, k], vector(B, N, k), v, vector(B, E, k), s, B[ONE_SIDE, k], B[SHEAR, k], m)
        write(first, B, GROWING, k)
        write(second, B, CONSTANT, k)


@part
def inertial_facets(B, n, m):
    """Tractions of a law with a `stress` and an `inertia`; arguments and result as of `space_law.facets`."""
    static_facets(B, n, m)
    for k in range(n):
        write(inertia(vector(B, N, k), vector(B, V, k), B[ONE_SIDE, k], m), B, CONSTANT, k)
