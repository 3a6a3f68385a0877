"""What all media in the plane do, in one call from Python: force, tangent, end of a step, active set.

Arguments that they share:

    sand                (media, words): of each batch where its arrays are, in the order of `SAND`, see `lending`
    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.lending import lender
from granular_contact.jit.memory import clear, piece, room2, rows
from granular_contact.sand.kernels import lines as one
from granular_contact.sand.kernels.batches import (
    APPROACH,
    BEFORE,
    BLOCK,
    DEEPEST,
    EVER,
    KEPT,
    gather,
    keep,
    known_at,
    recall,
)
from granular_contact.sand.kernels.batches import update_active as mark
from granular_contact.sand.kernels.kinematics import STATION
from granular_contact.sand.kernels.law import LAW, LINE, TERMS, Contact, line_accept, line_force

SAND = (
    *("reference", "active", "ends", "places", "geometry", "lines", "profile", "medium"),
    *("anchors", "room", "body", "columns", "proximity"),
)
REFERENCE, ACTIVE, ENDS, PLACES, GEOMETRY, LINES, PROFILE, MEDIUM, ANCHORS, ROOM, BODY, *_OF_STEPS = range(len(SAND))
COLUMNS, PROXIMITY = _OF_STEPS
_row, _rows, _room = (lender(np.float64, axes) for axes in (1, 2, 3))
_flags, _numbers = lender(np.bool_, 1), lender(np.int64, 2)
_stations, _lines, _media = (lender(kind, 1) for kind in (STATION, LINE, LAW))


@part
def ask(w, r, q, v, f, totals):
    """Fill f (m,) and totals (TERMS, 3) with the forces on line r of a batch at q and v, and keep them."""
    body = _rows(w, BODY)
    clear(f)
    clear(totals)
    line_force(q, v, contact_of(w, r), totals, f)
    keep(body, body.shape[0] - KEPT * (_lines(w, LINES).shape[0] - r), q, v, f, totals)


@part
def contact_of(w, r):
    """Line r of a batch, with room of its own, which keeps what was found last."""
    ends = _numbers(w, ENDS)
    s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
    return on_line(w, r, part_of(w, 0, s, n), part_of(w, 1, s, n), part_of(w, 2, s, n))


@part
def on_line(w, r, P, V, F):
    """Line r of a batch with this room."""
    ends, profile, medium = _numbers(w, ENDS), _rows(w, PROFILE), _media(w, MEDIUM)
    s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
    stations, anchors = rows(_stations(w, GEOMETRY), s, n), rows(_rows(w, ANCHORS), s, n)
    return Contact(stations, rows(_lines(w, LINES), r, 1), profile, medium, anchors, P, V, F)


@part
def part_of(w, k, first, count):
    """Room k for the stations of a line."""
    return rows(piece(_room(w, ROOM), k, first + count), first, count)


@kernel
def force(sand, system_q, system_v, out):
    """Add the generalised forces of all active lines to out, the coordinates of the bed."""
    totals = room2(TERMS, 3)
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        active, ends, body = _flags(w, ACTIVE), _numbers(w, ENDS), _rows(w, BODY)
        for r in range(active.shape[0]):
            if not active[r]:
                continue
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v, f = piece(body, 0, m), piece(body, 1, m), piece(body, 2, m)
            at = rows(_numbers(w, PLACES), c, m)
            gather(system_q, system_v, _row(w, REFERENCE), at, q, v)
            ask(w, r, q, v, f, totals)
            for i in range(m):
                out[at[i, 1]] += f[i]


@kernel
def tangent(sand, system_q, system_v, fq, fv, triplets):
    """Fill triplets with the entries of fq df/dq + fv df/dv as rows (row, column, value), and return their number.

    Rows and columns are coordinates of the bed; entries of zero are left out.
    """
    totals, count = room2(TERMS, 3), 0
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        active, ends, body, lines = _flags(w, ACTIVE), _numbers(w, ENDS), _rows(w, BODY), _lines(w, LINES)
        for r in range(active.shape[0]):
            if not active[r]:
                continue
            s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v, block, P = piece(body, 0, m), piece(body, 1, m), rows(body, BLOCK, m), part_of(w, 0, s, n)
            at, row = rows(_numbers(w, PLACES), c, m), body.shape[0] - KEPT * (active.shape[0] - r)
            gather(system_q, system_v, _row(w, REFERENCE), at, q, v)
            f, room = piece(body, row + 3, m), _room(w, ROOM)
            if not known_at(body, row, q, v):
                ask(w, r, q, v, f, totals)
            if not one.immersed(P, lines[r], _rows(w, PROFILE)):
                continue
            clear(block)
            contact = on_line(w, r, piece(room, 3, n), piece(room, 4, n), piece(room, 5, n))
            one.differences(q, v, piece(body, row + BEFORE, m), contact, rows(body, 3, 3), f, fq, fv, block)
            for i in range(m):
                for j in range(m):
                    if block[i, j] != 0.0:
                        triplets[count, 0], triplets[count, 1], triplets[count, 2] = at[i, 1], at[j, 1], block[i, j]
                        count += 1
    return count


@kernel
def accept(sand, system_q, system_v, row, begins):
    """End of a step for all lines, see `lines.accept`, added to a row of the history."""
    totals = room2(TERMS, 3)
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        ends, lines, body, proximity = _numbers(w, ENDS), _lines(w, LINES), _rows(w, BODY), _rows(w, PROXIMITY)
        for r in range(lines.shape[0]):
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v = piece(body, 0, m), piece(body, 1, m)
            gather(system_q, system_v, _row(w, REFERENCE), rows(_numbers(w, PLACES), c, m), q, v)
            known = recall(body, body.shape[0] - KEPT * (lines.shape[0] - r), q, v, totals)
            contact, out, columns = contact_of(w, r), piece(body, 2, m), _numbers(w, COLUMNS)[r]
            deepest, speed = line_accept(q, v, contact, totals, out, row, columns, begins, known)
            proximity[r, DEEPEST], proximity[r, APPROACH] = deepest, speed
            proximity[r, EVER] = max(proximity[r, EVER], deepest)


@kernel
def update_active(sand, step):
    """Mark the lines that may touch the surface within a step (s), see `batches`; whether there are any."""
    some = False
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        some = mark(_rows(w, PROXIMITY), step, _flags(w, ACTIVE)) or some
    return some


@kernel
def soonest(sand):
    """Time (s) after `accept` until the first of the lines above the surface may touch it; infinite of none."""
    least = np.inf
    for b in range(sand.shape[0]):
        proximity = _rows(piece(sand, b, sand.shape[1]), PROXIMITY)
        for r in range(proximity.shape[0]):
            depth, speed = proximity[r, DEEPEST], proximity[r, APPROACH]
            if depth < 0.0 < speed:
                least = min(least, -depth / speed)
    return least
