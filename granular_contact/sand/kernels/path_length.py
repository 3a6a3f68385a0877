"""Path lengths of stations and shear displacements of the medium, kept with the anchors of its bristles.

Where a medium asks for it the array of the anchors has more columns: SHEARED, the displacement S (m) of the anchor
along the surface since its station got into the medium, or since the shear turned back, positive along the line; PATH,
the path length (m) of the station since the start, and X, Y (m), where it was at the end of the last step. With the
unit tangent t, the place p at the end of a step and d = t . (p - anchor)

    j = max(0, S) + max(0, d) of what moves along t,      j = max(0, -S) + max(0, -d) of what moves against it,
    w = PATH + |p - (X, Y)|.

So the shear displacement is counted anew where the shear turns back, as in Wong and Reece's towed wheel (1967, part
II). They place the point where it turns by the zones of failure in front of the wheel; here it is where the surface
itself begins to move the other way, which needs no wheel, and sand that is sheared again has to be displaced as far as
before for the same stress [ours].

A bristle at its yield displacement is dragged along, so that S is the path of the station along the surface since then;
where a body rests it is not counted, as the bristle may be stretched and slacken again. Within a step all this is
continuous, and where the path bends it errs by the square of the step.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

SHEARED, PATH, X, Y = 2, 3, 4, 5  # columns
COLUMNS = 6


@part
def along_line(P, anchors, i, tx, ty):
    """Displacement d (m) of the station i from its anchor along the unit tangent t."""
    return tx * (P[i, 0] - anchors[i, 0]) + ty * (P[i, 1] - anchors[i, 1])


@part
def path_length(P, anchors, i):
    """Path length w (m) of the station i."""
    dx, dy = P[i, 0] - anchors[i, X], P[i, 1] - anchors[i, Y]
    return anchors[i, PATH] + math.sqrt(dx * dx + dy * dy)


@part
def count_shear(P, anchors, i, line):
    """Note in the line how far the medium was sheared at both ends of strip i, ahead and back.

    Where the shear turns back between them, what has not turned yet goes on as at the end that has not.
    """
    cx, cy = P[i + 1, 0] - P[i, 0], P[i + 1, 1] - P[i, 1]
    length = math.sqrt(cx * cx + cy * cy)
    if length == 0.0:
        return
    tx, ty = cx / length, cy / length
    s0, s1 = anchors[i, SHEARED], anchors[i + 1, SHEARED]
    d0, d1 = along_line(P, anchors, i, tx, ty), along_line(P, anchors, i + 1, tx, ty)
    line.ahead0, line.back0 = max(0.0, s0) + max(0.0, d0), max(0.0, -s0) + max(0.0, -d0)
    line.ahead1, line.back1 = max(0.0, s1) + max(0.0, d1), max(0.0, -s1) + max(0.0, -d1)
    if s0 * s1 >= 0.0:
        return
    if abs(s0) > abs(s1):
        line.ahead1, line.back1 = max(line.ahead1, line.ahead0 * (s0 > 0.0)), max(line.back1, line.back0 * (s0 < 0.0))
    else:
        line.ahead0, line.back0 = max(line.ahead0, line.ahead1 * (s1 > 0.0)), max(line.back0, line.back1 * (s1 < 0.0))


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
        slid = (tx * (x - anchors[i, 0]) + ty * (y - anchors[i, 1])) / length
        anchors[i, SHEARED] = slid + (anchors[i, SHEARED] if slid * anchors[i, SHEARED] >= 0.0 else 0.0)


@part
def start(P, anchors):
    """Begin at the stations (n, 2) m: no bristle is stretched, and paths are counted from here."""
    for i in range(P.shape[0]):
        anchors[i, 0], anchors[i, 1] = P[i, 0], P[i, 1]
        if anchors.shape[1] > SHEARED:
            anchors[i, SHEARED], anchors[i, PATH] = 0.0, 0.0
            anchors[i, X], anchors[i, Y] = P[i, 0], P[i, 1]
