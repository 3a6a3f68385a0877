"""Contact lines in one medium in one call: friction state, force, tangent, end of a step, active set.

A batch holds lines on any bodies in one medium, so a call from Python, which costs more than the law on a few strips,
is paid once for hundreds of bodies. Arguments that they share:

    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory
    reference           reference values of the system's coordinates
    active              (lines,) whether a line may touch the surface in this step; the others are passed over
    ends                (lines + 1, 2) first station and first coordinate of each line, and the ends of the last
    places              (coordinates, 2) place of each coordinate of a line in the system and among those of the bed
    geometry            stations of all lines, one after another
    lines               (lines,) records of `law`
    profile, medium     see `kernels.lines`; medium (1,)
    anchors             (stations, 2) m, the friction state; (stations, 6) with those of `path_length`
    room, body          to work in, see `work`

Forces that `force` found for a line stay in `room` and `body` with the coordinates that they belong to. A step mostly
ends where the last forces were asked for, and then `accept` takes them from there: they are not computed again. Nor
does `tangent` compute them, which the engine asks for where it asked for forces before.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.kernels import lines as one
from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.law import TERMS, line_force
from granular_contact.kernels.memory import clear, piece, room2, rows

# Of proximity (lines, 3): depth of the deepest station (m), speed at which one approaches the surface (m/s), greatest
# depth so far (m).
DEEPEST, APPROACH, EVER = 0, 1, 2
BLOCK = 6  # rows of `body` before a line's tangent
# Rows at the end of `body` for each line: coordinates and rates of its last forces, their totals, and these; and the
# rates of the forces before these, which were others.
KEPT, RATES, BEFORE = 5, 1, 4


def work(ends: Any, anchors: Any) -> tuple[Any, Any]:
    """Room for all lines: seven times for their stations, and rows for coordinates, a tangent and what is kept."""
    coordinates = int(np.max(np.diff(ends[:, 1]), initial=0))
    lines = len(ends) - 1
    return np.zeros((7, *anchors.shape)), np.full(
        (BLOCK + coordinates + KEPT * lines, max(coordinates, 3 * TERMS)), np.nan
    )


@part
def gather(system_q, system_v, reference, places, q, v):
    """Fill q and v with the coordinates at these places of the system."""
    for i in range(places.shape[0]):
        at = places[i, 0]
        q[i] = system_q[at] + reference[at]
        v[i] = system_v[at]


@part
def keep(body, row, q, v, f, totals):
    """Keep the generalised forces f found at q and v, and their totals."""
    moved = False
    for i in range(q.shape[0]):
        moved = moved or body[row + RATES, i] != v[i]
    for i in range(q.shape[0]):
        if moved:
            body[row + BEFORE, i] = body[row + RATES, i]
        body[row, i], body[row + 1, i], body[row + 3, i] = q[i], v[i], f[i]
    for term in range(TERMS):
        for k in range(3):
            body[row + 2, 3 * term + k] = totals[term, k]


@part
def known_at(body, row, q, v):
    """Whether the last forces were found at q and v."""
    known = True
    for i in range(q.shape[0]):
        known = known and body[row, i] == q[i] and body[row + 1, i] == v[i]
    return known


@part
def recall(body, row, q, v, totals):
    """Whether the last forces were found at q and v, with their totals; they are not known any more from then on."""
    known = known_at(body, row, q, v)
    if known:
        for term in range(TERMS):
            for k in range(3):
                totals[term, k] = body[row + 2, 3 * term + k]
    body[row, 0] = np.nan
    return known


@part
def force(
    system_q, system_v, reference, active, ends, places, geometry, lines, profile, medium, anchors, room, body, out
):  # fmt: skip
    """Add the generalised forces of the active lines to out, the coordinates of the bed."""
    totals = room2(TERMS, 3)
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v, f = piece(body, 0, m), piece(body, 1, m), piece(body, 2, m)
        gather(system_q, system_v, reference, rows(places, c, m), q, v)
        clear(f)
        clear(totals)
        line_force(
            q, v, rows(geometry, s, n), lines[r], profile, medium[0], rows(anchors, s, n),
            rows(piece(room, 0, s + n), s, n), rows(piece(room, 1, s + n), s, n), rows(piece(room, 2, s + n), s, n),
            totals, f,
        )  # fmt: skip
        keep(body, body.shape[0] - KEPT * (lines.shape[0] - r), q, v, f, totals)
        for i in range(m):
            out[places[c + i, 1]] += f[i]


@part
def tangent(
    system_q, system_v, reference, active, ends, places, geometry, lines, profile, medium, anchors, room, body, fq, fv,
    triplets, count,
):  # fmt: skip
    """Append the entries of fq df/dq + fv df/dv as rows (row, column, value) to the first `count` triplets.

    Rows and columns are coordinates of the bed; entries of zero are left out. Returns the new count.
    """
    totals = room2(TERMS, 3)
    for r in range(lines.shape[0]):
        if not active[r]:
            continue
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v, block = piece(body, 0, m), piece(body, 1, m), rows(body, BLOCK, m)
        gather(system_q, system_v, reference, rows(places, c, m), q, v)
        clear(block)
        row = body.shape[0] - KEPT * (lines.shape[0] - r)
        P, f = rows(piece(room, 0, s + n), s, n), piece(body, row + 3, m)
        if not known_at(body, row, q, v):
            clear(f)
            clear(totals)
            line_force(
                q, v, rows(geometry, s, n), lines[r], profile, medium[0], rows(anchors, s, n),
                P, rows(piece(room, 1, s + n), s, n), rows(piece(room, 2, s + n), s, n), totals, f,
            )  # fmt: skip
            keep(body, row, q, v, f, totals)
        if not one.immersed(P, lines[r], profile):
            continue
        one.differences(
            q, v, piece(body, row + BEFORE, m), rows(geometry, s, n), lines[r], profile, medium[0], rows(anchors, s, n),
            piece(room, 3, n), piece(room, 4, n), piece(room, 5, n), rows(body, 3, 3), f, fq, fv, block,
        )  # fmt: skip
        for i in range(m):
            for j in range(m):
                if block[i, j] != 0.0:
                    triplets[count, 0], triplets[count, 1] = places[c + i, 1], places[c + j, 1]
                    triplets[count, 2] = block[i, j]
                    count += 1
    return count


@part
def accept(
    system_q, system_v, reference, ends, places, geometry, lines, profile, medium, anchors, room, body, row, columns,
    proximity, begins,
):  # fmt: skip
    """End of a step for all lines, see `lines.accept`; columns (lines, 3), proximity (lines, 3) is filled."""
    totals = room2(TERMS, 3)
    for r in range(lines.shape[0]):
        s, n = ends[r, 0], ends[r + 1, 0] - ends[r, 0]
        c, m = ends[r, 1], ends[r + 1, 1] - ends[r, 1]
        q, v = piece(body, 0, m), piece(body, 1, m)
        gather(system_q, system_v, reference, rows(places, c, m), q, v)
        known = recall(body, body.shape[0] - KEPT * (lines.shape[0] - r), q, v, totals)
        proximity[r, DEEPEST], proximity[r, APPROACH] = one.accept(
            q, v, rows(geometry, s, n), lines[r], profile, medium[0], rows(anchors, s, n),
            rows(piece(room, 0, s + n), s, n), rows(piece(room, 1, s + n), s, n), rows(piece(room, 2, s + n), s, n),
            room, totals, piece(body, 2, m), row, columns[r], begins, known,
        )  # fmt: skip
        proximity[r, EVER] = max(proximity[r, EVER], proximity[r, DEEPEST])


@kernel
def update_active(proximity, step, active):
    """Mark the lines that may touch the surface within a step (s), at four times their speed; whether there are any.

    active (lines,) is filled.
    """
    some = False
    for r in range(active.shape[0]):
        active[r] = proximity[r, DEEPEST] + 4.0 * step * (proximity[r, APPROACH] + 10.0 * step) > -1e-3
        some = some or active[r]
    return some
