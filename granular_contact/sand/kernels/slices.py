"""Use in space of a law of surface elements that was measured in the plane [ours].

Each slice of a body along the vertical plane of its motion counts as a planar body. With the horizontal direction of
motion r and the normal n of an element, its section with this plane has the normal (n_r, n_z) / w, w^2 = n_r^2 + n_z^2,
and an element of area A has slices of area w A. So an element that moves along its own side (w = 0) has no resistance,
and an extruded planar body has the same load as in the plane.

If an element moves up or down, r has no direction: for |u_r| < UPRIGHT |n_r'|, with the horizontal direction r' of the
normal, the stress turns to the stress in the vertical plane of the normal.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.plates import stress

UPRIGHT = 0.02


@part
def slice_stress(n, u, m):
    """Stress per depth (3,) N/m^3 of a law with a planar `stress`; as `facet_blocks.stress`."""
    (nx, ny, nz), (ux, uy, uz) = n, u
    level, ahead = math.sqrt(nx * nx + ny * ny), math.sqrt(ux * ux + uy * uy)
    share = 1.0 if ahead >= UPRIGHT * level else ahead / (UPRIGHT * level)
    sx, sy, sz = 0.0, 0.0, 0.0
    if share > 0.0:
        if ahead > 0.0:
            rx, ry = ux / ahead, uy / ahead
        else:
            rx, ry = 1.0, 0.0
        nr = nx * rx + ny * ry
        w = math.sqrt(nr * nr + nz * nz)
        if w > 0.0:
            sr, sz = stress((-nz / w, nr / w), (ahead, uz), m)
            w *= share
            sx, sy, sz = w * sr * rx, w * sr * ry, w * sz
    if share < 1.0:
        rx, ry = nx / level, ny / level
        ur = ux * rx + uy * ry
        h = math.sqrt(ur * ur + uz * uz)
        sr, s = stress((-nz, level), (ur / h, uz / h), m)
        sx, sy, sz = sx + (1.0 - share) * sr * rx, sy + (1.0 - share) * sr * ry, sz + (1.0 - share) * s
    return sx, sy, sz
