"""Effect of a medium on one contact line, in the coordinates of its body: force, tangent, end of a step.

Shared arguments:
    q, v        (m,) coordinates (reference values included) and rates of the body
    contact     `law.Contact`: the line, its medium and its friction state
    totals      (TERMS, 3), see `law`

`force` and `accept` are called by their addresses in the record of the medium, as `law.line_force` and
`law.line_accept`: so they are compiled once, and not again within each caller. `planar_sand` calls them for many lines.
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import clear, piece, room2
from granular_contact.sand.kernels import law
from granular_contact.sand.kernels.friction import SWITCH
from granular_contact.sand.kernels.kinematics import SPATIAL, scatter, spacing, stations
from granular_contact.sand.kernels.law import LINE, TERMS, count_path, drag_anchor, forces, line_force
from granular_contact.sand.kernels.path_length import start
from granular_contact.sand.kernels.surface import height

__all__ = ["DEPTH", "FIRST", "LEFT", "LINE", "LOWEST", "RIGHT", "SPEED", "TIME"]

# First columns of a history row: time (s), depth of the deepest point (m), and of the immersed stations the greatest
# speed (m/s), the least height and the least and greatest x (m) that they reach. The bed lays out the other columns;
# `columns` (3,) are those of a line's power, of the terms of its medium and of the resultant on its body.
TIME, DEPTH, SPEED, LOWEST, LEFT, RIGHT, FIRST = range(7)


@part
def drag_anchors(P, anchors, line, profile, m):
    """Move the anchors after an accepted step: dragged along at the ends of immersed strips, else put at stations."""
    n = P.shape[0]
    before, below = False, height(profile, P[0, 0])[0] - P[0, 1] + line.drop > 0.0  # immersed: station i - 1, i
    for i in range(n):
        after = i + 1 < n and height(profile, P[i + 1, 0])[0] - P[i + 1, 1] + line.drop > 0.0
        x, y = P[i, 0], P[i, 1]
        if before or below or after:
            x, y = drag_anchor((x, y), (anchors[i, 0], anchors[i, 1]), m)
        if anchors.shape[1] > 2:
            count_path(P, anchors, i, x, y, below, m)
        anchors[i, 0], anchors[i, 1] = x, y
        before, below = below, after


@part
def release(P, anchors, m):
    """Put every anchor at its station."""
    for i in range(P.shape[0]):
        if anchors.shape[1] > 2:
            count_path(P, anchors, i, P[i, 0], P[i, 1], False, m)
        anchors[i, 0], anchors[i, 1] = P[i, 0], P[i, 1]


@part
def immersed(P, line, profile):
    """Return whether any station is below the surface."""
    below = False
    for i in range(P.shape[0]):
        below = below or height(profile, P[i, 0])[0] - P[i, 1] + line.drop > 0.0
    return below


@part
def upright(P, i):
    """Sine of the angle between the line at station i and the horizontal; 1 for a ball, which has no length."""
    j = i + 1 if i + 1 < P.shape[0] else i - 1
    x, y = P[j, 0] - P[i, 0], P[j, 1] - P[i, 1]
    length = math.sqrt(x * x + y * y)
    return abs(y) / length if length > 0.0 else 1.0


@part
def place(q, v, contact):
    """Fill positions and velocities of the stations."""
    if contact.geometry[0].kind == SPATIAL:
        law.spatial_stations(contact.medium[0], (q, v, contact.geometry, contact.P, contact.V))
    else:
        stations(q, v, contact.geometry, contact.P, contact.V)


@part
def force(q, v, contact, totals, out):
    """Add the generalised forces to out (m,) and to the totals."""
    geometry, line, medium = contact.geometry, contact.line[0], contact.medium[0]
    P, F = contact.P, contact.F
    place(q, v, contact)
    if not immersed(P, line, contact.profile):
        return
    forces(P, contact.V, contact.anchors, line, contact.profile, medium, F, totals)
    if geometry[0].kind == SPATIAL:
        law.spatial_scatter(medium, (q, geometry, F, out))
    else:
        scatter(q, geometry, P, F, out)


@part
def accept(q, v, contact, totals, out, row, columns, begins, known):
    """End a step: let the anchors follow; add power, depth, speed and totals to a history row.

    out (m,): work array; begins: a motion begins here instead, without any stretched bristle. known: P, V, F and
    totals belong to this state already. Returns the line's depth (m, negative above the surface) and the greatest speed
    at which a station approaches the surface (m/s).
    """
    P, V, F, anchors, line = contact.P, contact.V, contact.F, contact.anchors, contact.line[0]
    profile, medium = contact.profile, contact.medium[0]
    if not known:
        place(q, v, contact)
        if immersed(P, line, profile):
            clear(totals)
            line_force(q, v, contact, totals, out)
    deepest, speed = -np.inf, 0.0
    for i in range(P.shape[0]):
        surface, slope = height(profile, P[i, 0])
        z = surface - P[i, 1] + line.drop
        deepest = max(deepest, z)
        speed = max(speed, abs(V[i, 1]) + abs(slope * V[i, 0]))
        if z > 0.0:
            square = V[i, 0] * V[i, 0] + V[i, 1] * V[i, 1]
            if square > row[SPEED] * row[SPEED]:
                row[SPEED] = math.sqrt(square)
            row[LOWEST] = min(row[LOWEST], P[i, 1] - line.drop)
            if P[i, 0] - line.beside < row[LEFT] or P[i, 0] + line.beside > row[RIGHT]:
                beside = line.beside * upright(P, i)
                row[LEFT], row[RIGHT] = min(row[LEFT], P[i, 0] - beside), max(row[RIGHT], P[i, 0] + beside)
    row[DEPTH] = max(row[DEPTH], deepest)
    if begins:
        start(P, anchors)
        return deepest, speed
    if deepest <= 0.0:
        release(P, anchors, medium)
        return deepest, speed
    drag_anchors(P, anchors, line, profile, medium)
    power, terms, body = columns[0], columns[1], columns[2]
    for i in range(P.shape[0]):
        row[power] += F[i, 0] * V[i, 0] + F[i, 1] * V[i, 1]
    for term in range(TERMS):
        for k in range(3):
            row[terms + 3 * term + k] += totals[term, k]
            row[body + k] += totals[term, k]
    return deepest, speed


@part
def difference(q, fq, fv):
    """Step d of a finite difference that moves a coordinate by d fq and its rate by d fv.

    Coordinates move by at most 10 nm, rates by 1 um/s, a small part of the yield displacement, yet far
    above the round-off of q. A rate counts by its displacement over the time SWITCH: if d fq alone had to exceed
    round-off, then a kilometre from the origin short steps would move rates by more than a face needs to begin to lead,
    and the Jacobian would mislead Newton's method.
    """
    greatest = 1.0
    for j in range(q.shape[0]):
        greatest = max(greatest, abs(q[j]))
    largest_q, largest_v = max(abs(fq), 1e-300), max(abs(fv), 1e-300)
    d = min(1e-8 / largest_q, 1e-6 / largest_v)
    return max(d, 1e-12 * greatest / max(largest_q, SWITCH * largest_v))


@part
def chord(d, v, v_before, fv):
    """Step of the difference of one coordinate: to its rate of the iteration before, if that is farther than d."""
    far = (v_before - v) / fv if fv != 0.0 else 0.0
    return far if abs(far) > d else d


@part
def differences(q, v, v_before, contact, room, at_state, fq, fv, out):
    """Add fq df/dq + fv df/dv of the generalised forces f of an immersed line to out (m, m).

    at_state (m,): f at q and v; v_before (m,): rates of the iteration before; room (3, m): work array.

    q and v are moved together, by d fq and d fv along each coordinate, see `difference`; to v_before if that is
    farther, see `chord`. The tangent of a bristle that yields is zero, below the yield it is steep: with these tangents
    Newton's method may alternate between both branches, while the chord between them leads it to their intersection.
    Coordinates with no generalised force in common are moved at the same time.
    """
    size, totals, moved = q.shape[0], room2(TERMS, 3), piece(room, 0, q.shape[0])
    q_there, v_there, least = piece(room, 1, size), piece(room, 2, size), difference(q, fq, fv)
    for j in range(size):
        q_there[j], v_there[j] = q[j], v[j]
    apart = 0 if contact.line[0].resultant else spacing(contact.geometry)
    together = size if apart == 0 else apart
    for first in range(min(together, size)):
        for j in range(first, size, together):
            d = chord(least, v[j], v_before[j], fv)
            q_there[j] += d * fq
            v_there[j] += d * fv
        clear(moved)
        line_force(q_there, v_there, contact, totals, moved)
        for j in range(first, size, together):
            q_there[j], v_there[j] = q[j], v[j]
            node, d = j // 4, chord(least, v[j], v_before[j], fv)
            low, high = (0, size) if apart == 0 else (max(0, 4 * (node - 1)), min(size, 4 * (node + 2)))
            for i in range(low, high):
                out[i, j] += (moved[i] - at_state[i]) / d
