"""All media in the plane, in one call from Python: force, tangent, end of a step, active lines.

Shared arguments:

    sand                (media, addresses): addresses of the arrays of each batch, of the layout LINES (`jit.layout`)
    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear, piece, room2, rows
from granular_contact.sand.kernels import lines as contact_lines
from granular_contact.sand.kernels.batches import (
    BEFORE,
    BLOCK,
    FORCES,
    KEPT,
    gather,
    keep,
    known_at,
    recall,
)
from granular_contact.sand.kernels.batches import update_active as mark
from granular_contact.sand.kernels.kinematics import STATION
from granular_contact.sand.kernels.law import LAW, LINE, TERMS, Contact, line_accept, line_force
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, GREATEST, touches_in

LINES = Layout(
    "lines",
    reference=(float, 1),
    **dict.fromkeys(("profile", "anchors", "body", "proximity"), (float, 2)),
    **dict.fromkeys(("ends", "places", "columns"), (np.int64, 2)),
    active=(np.bool_, 1),
    geometry=(STATION, 1),
    lines=(LINE, 1),
    medium=(LAW, 1),
    room=(float, 3),
)
_view = LINES.view


@part
def batch(sand, b):
    """View of the arrays of batch b."""
    return _view(piece(sand, b, sand.shape[1]))


@part
def evaluate(w, r, q, v, f, totals):
    """Fill f (m,) and totals (TERMS, 3) with the forces on line r of a batch at q and v, and keep them."""
    body = w.body
    clear(f)
    clear(totals)
    line_force(q, v, contact_of(w, r), totals, f)
    keep(body, body.shape[0] - KEPT * (w.lines.shape[0] - r), q, v, f, totals)


@part
def contact_of(w, r):
    """Line r of a batch, with its own rows of `room`, which keep its last P, V and F."""
    return on_line(w, r, 0, w.ends[r, 0])


@part
def on_line(w, r, row, first):
    """Line r of a batch, with P, V and F in three rows of `room`, from this row and this station on."""
    ends, profile, medium, room = w.ends, w.profile, w.medium, w.room
    s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
    stations, anchors = rows(w.geometry, s, n), rows(w.anchors, s, n)
    P, V, F = piece(room, row, n, first), piece(room, row + 1, n, first), piece(room, row + 2, n, first)
    return Contact(stations, rows(w.lines, r, 1), profile, medium, anchors, P, V, F)


@kernel
def force(sand, system_q, system_v, out):
    """Add the generalised forces on all active lines to out (coordinates of the bed,)."""
    totals = room2(TERMS, 3)
    for b in range(sand.shape[0]):
        w = batch(sand, b)
        active, ends, body = w.active, w.ends, w.body
        for r in range(active.shape[0]):
            if not active[r]:
                continue
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v, f = piece(body, 0, m), piece(body, 1, m), piece(body, 2, m)
            indices = rows(w.places, c, m)
            gather(system_q, system_v, w.reference, indices, q, v)
            evaluate(w, r, q, v, f, totals)
            for i in range(m):
                out[indices[i, 1]] += f[i]


@kernel
def tangent(sand, system_q, system_v, fq, fv, triplets):
    """Fill triplets with the entries of fq df/dq + fv df/dv as rows (row, column, value), and return their number.

    Rows and columns are coordinates of the bed; entries of zero are left out.
    """
    totals, count = room2(TERMS, 3), 0
    for b in range(sand.shape[0]):
        w = batch(sand, b)
        active, ends, body, lines = w.active, w.ends, w.body, w.lines
        for r in range(active.shape[0]):
            if not active[r]:
                continue
            s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v, block = piece(body, 0, m), piece(body, 1, m), rows(body, BLOCK, m)
            P = piece(w.room, 0, n, s)
            indices, row = rows(w.places, c, m), body.shape[0] - KEPT * (active.shape[0] - r)
            gather(system_q, system_v, w.reference, indices, q, v)
            f = piece(body, row + FORCES, m)
            if not known_at(body, row, q, v):
                evaluate(w, r, q, v, f, totals)
            if not contact_lines.immersed(P, lines[r], w.profile):
                continue
            clear(block)
            contact = on_line(w, r, 3, 0)
            contact_lines.differences(q, v, piece(body, row + BEFORE, m), contact, rows(body, 3, 3), f, fq, fv, block)
            for i in range(m):
                for j in range(m):
                    if block[i, j] != 0.0:
                        triplets[count, 0], triplets[count, 1], triplets[count, 2] = (
                            indices[i, 1],
                            indices[j, 1],
                            block[i, j],
                        )
                        count += 1
    return count


@kernel
def accept(sand, system_q, system_v, row, begins):
    """End a step of all lines, see `lines.accept`, and add it to a row of the history."""
    totals = room2(TERMS, 3)
    for b in range(sand.shape[0]):
        w = batch(sand, b)
        ends, lines, body, proximity = w.ends, w.lines, w.body, w.proximity
        for r in range(lines.shape[0]):
            c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
            q, v = piece(body, 0, m), piece(body, 1, m)
            gather(system_q, system_v, w.reference, rows(w.places, c, m), q, v)
            known = recall(body, body.shape[0] - KEPT * (lines.shape[0] - r), q, v, totals)
            contact, out, columns = contact_of(w, r), piece(body, 2, m), w.columns[r]
            deepest, speed = line_accept(q, v, contact, totals, out, row, columns, begins, known)
            proximity[r, DEEPEST], proximity[r, APPROACH] = deepest, speed
            proximity[r, GREATEST] = max(proximity[r, GREATEST], deepest)


@kernel
def update_active(sand, step):
    """Mark the lines that may touch the surface within a step (s), see `batches`; return whether any may."""
    reached = False
    for b in range(sand.shape[0]):
        w = batch(sand, b)
        reached = mark(w.proximity, step, w.active) or reached
    return reached


@kernel
def soonest(sand):
    """Time (s) after `accept` until the first line above the surface may touch it; infinite if none may."""
    least = np.inf
    for b in range(sand.shape[0]):
        least = min(least, touches_in(batch(sand, b).proximity))
    return least
