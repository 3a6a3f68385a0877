"""Batches: contact lines of any bodies in one medium, which `planar_sand` treats in one call.

A call from Python costs more than the law on a few strips, so it is paid once for hundreds of bodies. Arrays of a
batch, and arguments of the functions here:

    system_q, system_v  coordinates (without reference values) and rates of the whole system, views of the engine's
                        memory
    reference           reference values of the system's coordinates
    active              (lines,) whether a line may touch the surface in this step; the others are skipped
    ends                (lines + 1, 2) first station and first coordinate of each line; last row: their numbers in all
    places              (coordinates, 2) index of each coordinate of a line in the system and in the bed
    geometry            stations of all lines, one after another
    lines               (lines,) records of `law`
    profile, medium     see `law.Contact`; medium (1,)
    anchors             (stations, 2) m, the friction state; (stations, 6) with the columns of `path_length`
    room, body          work arrays, see `work`
    columns             (lines, 3), see `lines`
    proximity           (lines, 3), see `proximity`

The last forces on a line stay in `room` and `body`, with the coordinates they belong to. A step usually ends at the
state of the last evaluation, so `accept` reuses these forces; so does `tangent`, which the engine usually calls at
the state of its last call of `force`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import APPROACH, DEEPEST, may_touch

BLOCK = 6  # rows of `body` before a line's tangent
# Rows at the end of `body` for each line: coordinates and rates of its last forces, their totals, the forces, and the
# rates of the iteration before: the last ones that were different. KEPT: number of these rows.
COORDINATES, RATES, TOTALS, FORCES, BEFORE = 0, 1, 2, 3, 4
KEPT = 5


def work(ends: Any, anchors: Any) -> tuple[Any, Any]:
    """Work arrays `room` and `body`: six arrays for all stations; rows for coordinates, a tangent and kept forces."""
    coordinates = int(np.max(np.diff(ends[:, 1]), initial=0))
    lines = len(ends) - 1
    return np.zeros((6, *anchors.shape)), np.full(
        (BLOCK + coordinates + KEPT * lines, max(coordinates, 3 * TERMS)), np.nan
    )


@part
def gather(system_q, system_v, reference, places, q, v):
    """Fill q and v with the coordinates and rates of a line; places (coordinates, 2): its rows of `places`."""
    for i in range(places.shape[0]):
        index = places[i, 0]
        q[i] = system_q[index] + reference[index]
        v[i] = system_v[index]


@part
def keep(body, row, q, v, f, totals):
    """Keep the generalised forces f at q and v, and their totals, in the rows from `row` on."""
    moved = False
    for i in range(q.shape[0]):
        moved = moved or body[row + RATES, i] != v[i]
    for i in range(q.shape[0]):
        if moved:
            body[row + BEFORE, i] = body[row + RATES, i]
        body[row + COORDINATES, i], body[row + RATES, i], body[row + FORCES, i] = q[i], v[i], f[i]
    for term in range(TERMS):
        for k in range(3):
            body[row + TOTALS, 3 * term + k] = totals[term, k]


@part
def known_at(body, row, q, v):
    """Return whether the kept forces belong to q and v."""
    known = True
    for i in range(q.shape[0]):
        known = known and body[row + COORDINATES, i] == q[i] and body[row + RATES, i] == v[i]
    return known


@part
def recall(body, row, q, v, totals):
    """Return whether the kept forces belong to q and v, and fill totals with theirs; then mark them as invalid."""
    known = known_at(body, row, q, v)
    if known:
        for term in range(TERMS):
            for k in range(3):
                totals[term, k] = body[row + TOTALS, 3 * term + k]
    body[row + COORDINATES, 0] = np.nan
    return known


@part
def update_active(proximity, step, active):
    """Fill active (lines,): whether a line may touch the surface within a step (s); return whether any may."""
    reached = False
    for r in range(active.shape[0]):
        active[r] = may_touch(proximity[r, DEEPEST], proximity[r, APPROACH], step)
        reached = reached or active[r]
    return reached
