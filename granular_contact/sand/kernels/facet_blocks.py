"""Tractions of a law on a block of facets, and the shares of the facets that lead.

A block (BLOCK of `facet_records`) has an array of numbers of its facets for each quantity. The equations of a law are
written for one facet, in a loop over the facets of a block, with all parts inlined and without branches where
possible: so compilers make vector instructions of the loop, which hide the latency of roots and divisions.

Only the leading part of a facet is loaded. With the direction of motion u at the centroid, n . u grows along a and b
by s_a and s_b, as the body turns and as the surface is curved. The load on a facet is multiplied by

    g = clip((n . u + s) / (edge + 2 s), 0, 1),    s^2 = s_a^2 + s_b^2:

the share of the facet that leads, for an n . u spread evenly with the same mean square, and the fade-in of `plates`
where nothing turns. On a body at rest, with bristles below their yield, faces along the bristles would switch between
loaded and not loaded within a hundredth of a micrometre. There edge is no angle: a face is loaded as a whole once
n . q reaches `pressed`, a part of the yield displacement [ours]. This reduces the resistance of a ball that slides
slowly by up to 1 %, and its lift by 4 %, as the flat parts of its underside are loaded in part; at 10 mm/s by nothing.
"""

from __future__ import annotations

import math

from granular_contact.jit.chosen import chosen_by
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import room1, room2
from granular_contact.sand.kernels.facet_records import LANES
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.kernels.plates import EDGE
from granular_contact.sand.kernels.space_friction import factors_of_facet
from granular_contact.sand.kernels.vectors import times


@chosen_by("m")
def stress(n, u, m):
    """Stress per depth (3,) N/m^3 on an element with the normal n that moves in the direction u, z up; even in n."""


@chosen_by("m")
def traction(z, n, u, side, j, m):
    """Stresses (3,) Pa of the growing and of the constant term of a law at a depth z > 0 (m).

    n, u as in `stress`; side as in FACET: a facet with side 1 leads, perhaps only in part, so that n . u at its
    centroid may be below 0; j (m): shear displacement.
    """


@chosen_by("m")
def inertia(n, v, side, m):
    """Stress (3,) Pa from the velocity v (m/s): constant term of a law with a `stress`; side as in `traction`."""


@chosen_by("m")
def force(z, n, v, e, spread, side, j, m):
    """Tractions on one facet, growing and constant (3,), of a law that needs none of the functions above.

    spread (m/s): the number s above for n . v; the other arguments are fields of BLOCK, z being `depth`.
    """


@part(inline=True)
def spread(block, k, x, y, z, factor):
    """By how much n . (x, y, z) grows from the centroid of facet k along its edges: the number s above.

    factor: factor of the velocity in the vector (x, y, z); 0 for a vector that does not change as the body turns.
    """
    turn_a, turn_b = block.turn_a, block.turn_b
    a = factor * block.spread[0, k] + turn_a[0, k] * x + turn_a[1, k] * y + turn_a[2, k] * z
    b = factor * block.spread[1, k] + turn_b[0, k] * x + turn_b[1, k] * y + turn_b[2, k] * z
    return math.sqrt(a * a + b * b)


@part(inline=True)
def vector(field, k):
    """Vector (3,) of facet k, from a field (3, LANES) of a block."""
    return field[0, k], field[1, k], field[2, k]


@part(inline=True)
def write(a, field, k):
    """Write a vector (3,) of facet k into a field (3, LANES) of a block."""
    field[0, k], field[1, k], field[2, k] = a


@part
def lead(block, n, m):
    """Fill in the directions u in which a law sees the n facets move, and the shares g s of their resistance."""
    rest = m.v_eps if m.friction == SMOOTH else m.u_y
    Q, U = room2(3, LANES), room2(3, LANES)  # q of `space_friction`, and its direction u
    differs, inverse, share = room1(LANES), room1(LANES), room1(LANES)  # factor of differences of v; 1 / |q|; g s
    stretch, velocity, normal = block.stretch, block.velocity, block.normal
    if m.friction == SMOOTH:
        for k in range(n):
            Q[0, k], Q[1, k], Q[2, k], differs[k] = velocity[0, k], velocity[1, k], velocity[2, k], 1.0
    else:
        for k in range(n):
            by_e, by_v, differs[k] = factors_of_facet(vector(stretch, k), vector(velocity, k), m)
            for i in range(3):
                Q[i, k] = by_e * stretch[i, k] + by_v * velocity[i, k]
    for k in range(n):
        x, y, z = Q[0, k], Q[1, k], Q[2, k]
        h = math.sqrt(x * x + y * y + z * z)
        still = h == 0.0  # then any direction will do
        factor = 0.0 if still else 1.0 / h
        U[0, k] = normal[0, k] if still else factor * x
        U[1, k] = normal[1, k] if still else factor * y
        U[2, k] = normal[2, k] if still else factor * z
        share[k] = min(1.0, h / rest)
        inverse[k] = factor
    if m.friction == SMOOTH:
        for k in range(n):
            share[k] = math.tanh(math.sqrt(Q[0, k] * Q[0, k] + Q[1, k] * Q[1, k] + Q[2, k] * Q[2, k]) / rest)
    for k in range(n):
        s = spread(block, k, U[0, k], U[1, k], U[2, k], differs[k] * inverse[k])
        along = normal[0, k] * U[0, k] + normal[1, k] * U[1, k] + normal[2, k] * U[2, k]
        g = min(1.0, max(0.0, (along + s) / (max(EDGE, m.pressed * inverse[k]) + 2.0 * s)))
        share[k] *= 1.0 if block.side[k] == 0.0 else g
    for row in range(3):
        for k in range(n):
            block.direction[row, k] = U[row, k]
    for k in range(n):
        block.share[k] = share[k]


@part
def traction_facets(block, n, m):
    """`space_law.facets`: static tractions of a law with a `traction`.

    Over a facet the first stress is taken as growing in proportion to the depth: the error goes with the square of
    the size of the facet.
    """
    for k in range(n):
        share, z, u = block.share[k], block.depth[k], vector(block.direction, k)
        growing, constant = traction(z, vector(block.normal, k), u, block.side[k], block.shear[k], m)
        write(times(share / z, growing), block.growing, k)
        write(times(share, constant), block.constant, k)


@part
def static_facets(block, n, m):
    """`space_law.facets`: static tractions of a law with a `stress`."""
    S = room2(3, LANES)
    for k in range(n):
        share = block.share[k]
        x, y, z = stress(vector(block.normal, k), vector(block.direction, k), m)
        S[0, k], S[1, k], S[2, k] = share * x, share * y, share * z
    for row in range(3):
        for k in range(n):
            block.growing[row, k], block.constant[row, k] = S[row, k], 0.0


@part
def own_facets(block, n, m):
    """`space_law.facets`: tractions of a law with a `force`."""
    for k in range(n):
        v, e = vector(block.velocity, k), vector(block.stretch, k)
        s = spread(block, k, v[0], v[1], v[2], 1.0)
        growing, constant = force(block.depth[k], vector(block.normal, k), v, e, s, block.side[k], block.shear[k], m)
        write(growing, block.growing, k)
        write(constant, block.constant, k)


@part
def inertial_facets(block, n, m):
    """`space_law.facets`: tractions of a law with a `stress` and an `inertia`."""
    static_facets(block, n, m)
    for k in range(n):
        v = vector(block.velocity, k)
        write(inertia(vector(block.normal, k), v, block.side[k], m), block.constant, k)
