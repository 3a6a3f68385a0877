"""Path lengths of stations and shear displacements of the medium, kept with the anchors of its bristles.

For media that need them the array of anchors has more columns: SHEARED, the displacement S (m) of the anchor along the
surface since its station got into the medium, or since the shear reversed, positive along the line; PATH, the path
length (m) of the station since the start; X, Y (m), its position at the end of the last step. With the unit tangent t,
the position p at the end of a step and d = t . (p - anchor)

    j = max(0, S) + max(0, d) for motion along t,      j = max(0, -S) + max(0, -d) for motion against t,
    w = PATH + |p - (X, Y)|.

So the shear displacement is counted anew where the shear reverses, as in Wong and Reece's towed wheel (1967, part II).
They place the point of reversal by the zones of failure in front of the wheel. Here it is where the surface itself
begins to move the other way, which needs no wheel, and sand that is sheared again has to be displaced as far as before
for the same stress [ours].

A bristle at its yield displacement is dragged along, so S is the path of the station along the surface since then.
At rest nothing is counted, as the bristle may be stretched and slacken again. Within a step j and w are continuous;
where the path bends their error goes with the square of the step.
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
    """Set the shear displacements ahead and back of the line at both ends of strip i.

    If S changes its sign between them, the end with the smaller |S| takes at least the other end's value in the
    direction of the other end's S.
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
    """Add an accepted step to the path of station i; then its anchor goes to (x, y) m.

    immersed: whether the station is immersed.
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
        slip = (tx * (x - anchors[i, 0]) + ty * (y - anchors[i, 1])) / length
        anchors[i, SHEARED] = slip + (anchors[i, SHEARED] if slip * anchors[i, SHEARED] >= 0.0 else 0.0)


@part
def start(P, anchors):
    """Begin at the stations (n, 2) m, without stretched bristles; paths are counted from here."""
    for i in range(P.shape[0]):
        anchors[i, 0], anchors[i, 1] = P[i, 0], P[i, 1]
        if anchors.shape[1] > SHEARED:
            anchors[i, SHEARED], anchors[i, PATH] = 0.0, 0.0
            anchors[i, X], anchors[i, Y] = P[i, 0], P[i, 1]
