"""Facets in a layer: what lies below its top less what lies below its bottom.

Compiled for media in layers alone, see `space_joining`. With the moments s, m, o, p of `facet_parts` below an edge at
the depth D, where depths count from that edge, those of depths that count from the surface are

    int dA = A s,    int z dA = A (m + D s),    int d dA = A o,    int z d dA = A (p + D o).
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.facet_parts import immersed_part

LEAST = 1e-13  # of a facet: less than that is round-off of the difference


@part
def between(four, z, za, zb, a, b, top, bottom):
    """As `facet_parts.immersed_part`, of what lies between the depths top and bottom (m, 0 <= top)."""
    s, m, ox, oy, oz, px, py, pz = immersed_part(four, z - top, za, zb, a, b)
    if s <= 0.0 or bottom <= top:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    m, px, py, pz = m + top * s, px + top * ox, py + top * oy, pz + top * oz
    if z + abs(za) + abs(zb) > bottom:
        t, n, ux, uy, uz, vx, vy, vz = immersed_part(four, z - bottom, za, zb, a, b)
        s, m, ox, oy, oz = s - t, m - n - bottom * t, ox - ux, oy - uy, oz - uz
        px, py, pz = px - vx - bottom * ux, py - vy - bottom * uy, pz - vz - bottom * uz
    if s <= LEAST or m <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return s, s * min(bottom, max(top, m / s)), ox, oy, oz, px, py, pz
