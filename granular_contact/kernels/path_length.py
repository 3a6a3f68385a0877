"""Path lengths of stations and shear displacements of the medium, kept with the anchors of its bristles.

Where a medium asks for it the array of the anchors has more columns: SHEARED, the path length (m) of the anchor along
the surface since its station got into the medium; PATH, the path length (m) of the station since the start, and X, Y
(m), where it was at the end of the last step. With the unit tangent t and the place p at the end of a step

    j = SHEARED + |t . (p - anchor)|,    w = PATH + |p - (X, Y)|.

A bristle at its yield displacement is dragged along, so that j is the path of the station along the surface since then;
where a body rests it is not counted, as the bristle may be stretched and slacken again. Both are continuous within a
step, and where the path bends they err by the square of the step.
"""

from __future__ import annotations

import math

from granular_contact.kernels.compiled import part

SHEARED, PATH, X, Y = 2, 3, 4, 5  # columns
COLUMNS = 6


@part
def shear_displacement(P, anchors, i, tx, ty):
    """Shear displacement j (m) at the station i on an element with the unit tangent t."""
    return anchors[i, SHEARED] + abs(tx * (P[i, 0] - anchors[i, 0]) + ty * (P[i, 1] - anchors[i, 1]))


@part
def path_length(P, anchors, i):
    """Path length w (m) of the station i."""
    dx, dy = P[i, 0] - anchors[i, X], P[i, 1] - anchors[i, Y]
    return anchors[i, PATH] + math.sqrt(dx * dx + dy * dy)


@part
def count_shear(P, anchors, i, line):
    """Note in the line how far the medium was sheared at both ends of strip i."""
    cx, cy = P[i + 1, 0] - P[i, 0], P[i + 1, 1] - P[i, 1]
    length = math.sqrt(cx * cx + cy * cy)
    if length > 0.0:
        tx, ty = cx / length, cy / length
        line.j0 = shear_displacement(P, anchors, i, tx, ty)
        line.j1 = shear_displacement(P, anchors, i + 1, tx, ty)


@part
def count_path(P, anchors, i, x, y, immersed):
    """Add to the path of station i in a step that is accepted, before its anchor goes to (x, y) m.

    immersed: whether the station is.
    """
    anchors[i, PATH] = path_length(P, anchors, i)
    anchors[i, X], anchors[i, Y] = P[i, 0], P[i, 1]
    if not immersed:
        anchors[i, SHEARED] = 0.0
        return
    before, after = max(0, i - 1), min(P.shape[0] - 1, i + 1)
    tx, ty = P[after, 0] - P[before, 0], P[after, 1] - P[before, 1]
    length = math.sqrt(tx * tx + ty * ty)
    if length > 0.0:
        anchors[i, SHEARED] += abs(tx * (x - anchors[i, 0]) + ty * (y - anchors[i, 1])) / length


@part
def start(P, anchors):
    """Begin at the stations (n, 2) m: no bristle is stretched, and paths are counted from here."""
    for i in range(P.shape[0]):
        anchors[i, 0], anchors[i, 1] = P[i, 0], P[i, 1]
        if anchors.shape[1] > SHEARED:
            anchors[i, SHEARED], anchors[i, PATH] = 0.0, 0.0
            anchors[i, X], anchors[i, Y] = P[i, 0], P[i, 1]
