"""What all media in the plane do, in one call from Python: `batches` for one medium after another.

Arguments that they share:

    sand                (media, words): of each batch where its arrays are, in the order of `SAND`, see `lending`
    system_q, system_v  as in `batches`
"""

from __future__ import annotations

import numpy as np
from numba import from_dtype, types

from granular_contact.kernels import batches
from granular_contact.kernels.compiled import kernel
from granular_contact.kernels.kinematics import STATION
from granular_contact.kernels.law import LAW, LINE
from granular_contact.kernels.lending import lender
from granular_contact.kernels.memory import piece

SAND = (
    *("reference", "active", "ends", "places", "geometry", "lines", "profile", "medium"),
    *("anchors", "room", "body", "columns", "proximity"),
)
_0, _1, _2, _3, _4, _5, _6, _7, _8, _9, _10, _11, _12 = range(len(SAND))
_row, _rows, _room = (lender(types.Array(types.float64, axes, "C")) for axes in (1, 2, 3))
_flags, _numbers = lender(types.Array(types.boolean, 1, "C")), lender(types.Array(types.int64, 2, "C"))
_stations, _lines, _media = (lender(types.Array(from_dtype(kind), 1, "C")) for kind in (STATION, LINE, LAW))


@kernel
def force(sand, system_q, system_v, out):
    """Add the generalised forces of all active lines to out, the coordinates of the bed."""
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        batches.force(
            system_q, system_v, _row(w, _0), _flags(w, _1), _numbers(w, _2), _numbers(w, _3), _stations(w, _4),
            _lines(w, _5), _rows(w, _6), _media(w, _7), _rows(w, _8), _room(w, _9), _rows(w, _10), out,
        )  # fmt: skip


@kernel
def tangent(sand, system_q, system_v, fq, fv, triplets):
    """Fill triplets with the entries of fq df/dq + fv df/dv, as `batches.tangent` does, and return their number."""
    count = 0
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        count = batches.tangent(
            system_q, system_v, _row(w, _0), _flags(w, _1), _numbers(w, _2), _numbers(w, _3), _stations(w, _4),
            _lines(w, _5), _rows(w, _6), _media(w, _7), _rows(w, _8), _room(w, _9), _rows(w, _10), fq, fv, triplets,
            count,
        )  # fmt: skip
    return count


@kernel
def accept(sand, system_q, system_v, row, begins):
    """End of a step for all lines, added to a row of the history."""
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        batches.accept(
            system_q, system_v, _row(w, _0), _numbers(w, _2), _numbers(w, _3), _stations(w, _4), _lines(w, _5),
            _rows(w, _6), _media(w, _7), _rows(w, _8), _room(w, _9), _rows(w, _10), row, _numbers(w, _11),
            _rows(w, _12), begins,
        )  # fmt: skip


@kernel
def update_active(sand, step):
    """Mark the lines that may touch the surface within a step (s), see `batches`; whether there are any."""
    some = False
    for b in range(sand.shape[0]):
        w = piece(sand, b, sand.shape[1])
        some = batches.update_active(_rows(w, _12), step, _flags(w, _1)) or some
    return some


@kernel
def soonest(sand):
    """Time (s) after `accept` until the first of the lines above the surface may touch it; infinite of none."""
    least = np.inf
    for b in range(sand.shape[0]):
        proximity = _rows(piece(sand, b, sand.shape[1]), _12)
        for r in range(proximity.shape[0]):
            depth, speed = proximity[r, batches.DEEPEST], proximity[r, batches.APPROACH]
            if depth < 0.0 < speed:
                least = min(least, -depth / speed)
    return least
