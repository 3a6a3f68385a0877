"""How far a surface has moved in the medium, kept with the anchors of its bristles.

Where a medium asks for it the array of the anchors has two more columns: SHEARED, the way (m) of the anchor along the
surface since its station got into the medium, and PATH, its whole way (m) since the start. A bristle at its yield
displacement is dragged along, so a column and the bristle together are the way of the station,

    j = SHEARED + |t . (p - anchor)|,    w = PATH + |p - anchor|,

which are continuous within a step, and only as fine as the steps where the path bends. At rest nothing is counted: the
bristle may be stretched and slacken again.
"""

from __future__ import annotations

import math

from numba import njit

SHEARED, PATH = 2, 3  # columns
COLUMNS = 4


@njit(cache=True, no_cfunc_wrapper=True)
def shear_displacement(P, anchors, i, tx, ty):
    """Way j (m) of the station i on an element with the unit tangent t."""
    return anchors[i, SHEARED] + abs(tx * (P[i, 0] - anchors[i, 0]) + ty * (P[i, 1] - anchors[i, 1]))


@njit(cache=True, no_cfunc_wrapper=True)
def path(P, anchors, i):
    """Way w (m) of the station i."""
    return anchors[i, PATH] + math.hypot(P[i, 0] - anchors[i, 0], P[i, 1] - anchors[i, 1])


@njit(cache=True, no_cfunc_wrapper=True)
def count_ways(P, anchors, i, x, y, immersed):
    """Count the way of the anchor of station i to (x, y) m, before it goes there; immersed: whether the station is."""
    dx, dy = x - anchors[i, 0], y - anchors[i, 1]
    anchors[i, PATH] += math.hypot(dx, dy)
    if not immersed:
        anchors[i, SHEARED] = 0.0
        return
    before, after = max(0, i - 1), min(P.shape[0] - 1, i + 1)
    tx, ty = P[after, 0] - P[before, 0], P[after, 1] - P[before, 1]
    length = math.hypot(tx, ty)
    if length > 0.0:
        anchors[i, SHEARED] += abs(tx * dx + ty * dy) / length
