"""Facets in a layer: what lies below its top less what lies below its bottom.

Compiled for media in layers alone, see `space_joining`. Over either part the depth below its upper edge is integrated
as in `facets`; with the edge D, the share s of the facet that lies deeper, its centroid o, its mean depth m below the
edge and its centre of pressure h there,

    int dA = A s,    int d dA = A s o,    int z dA = A s (m + D),    int z d dA = A s (m h + D o).
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.facets import immersion

LEAST = 1e-13  # of a facet: less than that is round-off of the difference


@part
def between(z, za, zb, ax, ay, az, bx, by, bz, top, bottom):
    """As `facets.immersion`, of what lies between the depths top and bottom (m, 0 <= top)."""
    s, m, ox, oy, oz, hx, hy, hz = immersion(z - top, za, zb, ax, ay, az, bx, by, bz)
    if s <= 0.0 or bottom <= top:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    d = s * (m + top)
    px, py, pz = s * ox, s * oy, s * oz
    qx, qy, qz = s * m * hx + top * px, s * m * hy + top * py, s * m * hz + top * pz
    if z + max(za, zb, -za - zb) > bottom:
        below, m, ox, oy, oz, hx, hy, hz = immersion(z - bottom, za, zb, ax, ay, az, bx, by, bz)
        s, d = s - below, d - below * (m + bottom)
        px, py, pz = px - below * ox, py - below * oy, pz - below * oz
        qx, qy, qz = (
            qx - below * (m * hx + bottom * ox),
            qy - below * (m * hy + bottom * oy),
            qz - below * (m * hz + bottom * oz),
        )
    if s <= LEAST or d <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    mean = min(bottom, max(top, d / s))
    k, one = 1.0 / d, 1.0 / s
    return s, mean, one * px, one * py, one * pz, k * qx, k * qy, k * qz
