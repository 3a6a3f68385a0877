"""Batches: contact lines on any bodies in one medium, of which `planar_sand` treats all at once.

So a call from Python, which costs more than the law on a few strips, is paid once for hundreds of bodies. Arrays of a
batch, and arguments of the functions here:

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
    columns             (lines, 3), see `lines`
    proximity           (lines, 3), see there

Forces that `planar_sand.force` found for a line stay in `room` and `body` with the coordinates that they belong to. A
step mostly ends where the last forces were asked for, and then `accept` takes them from there: they are not computed
again. Nor does `tangent` compute them, which the engine asks for where it asked for forces before.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, may_touch

BLOCK = 6  # rows of `body` before a line's tangent
# Rows at the end of `body` for each line: coordinates and rates of its last forces, their totals, and these; and the
# rates of the forces before these, which were others.
KEPT, RATES, BEFORE = 5, 1, 4


def work(ends: Any, anchors: Any) -> tuple[Any, Any]:
    """Room for all lines: six times for their stations, and rows for coordinates, a tangent and what is kept."""
    coordinates = int(np.max(np.diff(ends[:, 1]), initial=0))
    lines = len(ends) - 1
    return np.zeros((6, *anchors.shape)), np.full(
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
def update_active(proximity, step, active):
    """Mark the lines that may touch the surface within a step (s); whether there are any.

    active (lines,) is filled.
    """
    some = False
    for r in range(active.shape[0]):
        active[r] = may_touch(proximity[r, DEEPEST], proximity[r, APPROACH], step)
        some = some or active[r]
    return some
