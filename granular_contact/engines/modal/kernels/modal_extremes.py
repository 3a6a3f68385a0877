"""What is greatest in the motion of modal pendulums, and when they touch the medium, from the rows of their runs.

Between two rows a quantity is the cubic through both values and rates; `results.interpolation` has the same for any
method of solution, with its error.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from granular_contact.engines.modal.kernels.modal import modal_stations, place_stations, within_reach
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import piece, rows
from granular_contact.jit.records import fields, record_dtype


class LineExtremes(NamedTuple):
    """Extremes of a line over the rows of a run, the fields of a record of EXTREMES.

    Of stations below the surface: speed, the greatest (m/s), and left and right, the least and the greatest x (m), for
    which the half width of the line counts. Of all stations, at rows only: deepest, the greatest depth, and lowest, the
    least height (m). Of the ends of the line, between rows, too: greatest depth (m), when it is reached (s), and
    touch, the time (s) at which the first end gets below the surface, NaN for never.
    """

    speed: float = 0.0
    deepest: float = -np.inf
    lowest: float = np.inf
    left: float = np.inf
    right: float = -np.inf
    greatest: float = -np.inf
    when: float = np.nan
    touch: float = np.nan


EXTREMES = record_dtype(fields("f8", *LineExtremes._fields))
NOT_IN_STEP = 2.0
SHARE = 4.0 / 27.0  # of a step's length times a rate at its end: by how much that rate may add to a value inside
ROUND_OFF = 1e-12


class Lines(NamedTuple):
    """Lines of stations of several runs, one after another.

    geometry (runs, stations): records of `modal`; starts (lines + 1,): first station of each; every (lines,): which
    stations are ends that count; surface (runs,), beside, drop (runs, lines): height of the surface, half the width and
    how far below its stations a line reaches (m).
    """

    geometry: Any
    starts: Any
    every: Any
    surface: Any
    beside: Any
    drop: Any


@part
def powers(a, b, a_rate, b_rate):
    """Coefficients of x, x^2 and x^3 of a step's cubic, x from 0 to 1; rates times the length of the step."""
    rise = b - a
    return a_rate, 3.0 * rise - 2.0 * a_rate - b_rate, a_rate + b_rate - 2.0 * rise


@part
def turns(c1, c2, c3):
    """Places at which a cubic turns round, the lesser first; NaN for none. Each in the form that does not cancel."""
    q = -(c2 + math.copysign(math.sqrt(max(c2 * c2 - 3.0 * c1 * c3, 0.0)), c2))
    if c2 * c2 - 3.0 * c1 * c3 < 0.0:
        return np.nan, np.nan
    x, y = q / (3.0 * c3), c1 / q
    return (y, x) if y < x else (x, y)


@part(inline=True)
def bound(a, b, a_rate, b_rate):
    """What a step's cubic does not pass."""
    more = max(a_rate, 0.0) + max(-b_rate, 0.0)
    return max(a, b) + SHARE * more + ROUND_OFF * (abs(a) + abs(b))


@part(inline=True)
def greatest(a, b, a_rate, b_rate, best):
    """The greatest value inside a step that is above `best`, and its place; `best` and `NOT_IN_STEP` for none."""
    where = NOT_IN_STEP
    if bound(a, b, a_rate, b_rate) > best:
        c1, c2, c3 = powers(a, b, a_rate, b_rate)
        for x in turns(c1, c2, c3):
            value = a + x * (c1 + x * (c2 + x * c3))
            if 0.0 < x < 1.0 and value > best:
                best, where = value, x
    return best, where


@part
def crossing(a, b, a_rate, b_rate):
    """Where in a step, which begins at or below zero, its cubic first gets above it; `NOT_IN_STEP` if it does not."""
    if not bound(a, b, a_rate, b_rate) > 0.0:
        return NOT_IN_STEP
    c1, c2, c3 = powers(a, b, a_rate, b_rate)
    first, second = turns(c1, c2, c3)
    low = 0.0
    for high in (first, second, 1.0):
        if not 0.0 < high <= 1.0:
            continue
        if (b if high == 1.0 else a + high * (c1 + high * (c2 + high * c3))) > 0.0:
            for _ in range(60):  # bisection, to round-off
                middle = 0.5 * (low + high)
                if a + middle * (c1 + middle * (c2 + middle * c3)) > 0.0:
                    high = middle
                else:
                    low = middle
            return 0.5 * (low + high)
        low = high
    return NOT_IN_STEP


@part(inline=True)
def note(P, V, i, z, beside, extremes):
    """Take on the extremes of a station at depth z (m); roots are taken where they may be needed."""
    extremes.deepest, extremes.lowest = max(extremes.deepest, z), min(extremes.lowest, P[i, 1])
    if not z > 0.0 or P.shape[0] < 2:
        return
    square = V[i, 0] * V[i, 0] + V[i, 1] * V[i, 1]
    if square > extremes.speed * extremes.speed:
        extremes.speed = math.sqrt(square)
    if P[i, 0] - beside < extremes.left or P[i, 0] + beside > extremes.right:
        k = min(i, P.shape[0] - 2)
        x, y = P[k + 1, 0] - P[k, 0], P[k + 1, 1] - P[k, 1]
        wide = beside * abs(y) / math.sqrt(x * x + y * y)
        extremes.left = min(extremes.left, P[i, 0] - wide)
        extremes.right = max(extremes.right, P[i, 0] + wide)


@part
def place_some(row, m, geometry, every, surface, P, V):
    """Place the stations of a line that may count, and give those between its ends: the first, and the one behind.

    Of a straight line these are what may be immersed: ends of it, or of what is immersed, have all that is greatest.
    """
    n, q, v = geometry.shape[0], rows(row, 1, m), rows(row, 1 + m, m)
    if every == 1:
        modal_stations(q, v, geometry, P, V)
        return 0, n
    c, s = math.cos(q[0]), math.sin(q[0])
    first, some = within_reach(c, s, q, geometry, surface)
    for k, count in ((0, 1), (first, some), (n - 1, 1)):
        place_stations(c, s, q, v, rows(geometry, k, count), rows(P, k, count), rows(V, k, count))
    return first, first + some


@part(inline=True)
def next_place(i, first, behind, n):
    """The station of a line to be looked at after the i-th, see `place_some`; n behind its last."""
    i += 1
    if i < first:
        i = first
    return n - 1 if behind <= i < n else i


@part
def look_at_line(table, m, geometry, every, sizes, room, depths, extremes):
    """One line over the rows of a run.

    sizes: height of the surface, half the width, how far below (m), see Lines; room: three times (stations, 2).
    """
    n, (surface, beside, drop), (P, V, before) = geometry.shape[0], sizes, room
    for t in range(table.shape[0]):
        now, h = table[t, 0], 0.0 if t == 0 else table[t, 0] - table[t - 1, 0]
        touched = NOT_IN_STEP
        first, behind = place_some(piece(table, t, table.shape[1]), m, geometry, every, surface + drop, P, V)
        i = 0
        while i < n:
            z, rate = surface - P[i, 1] + drop, -V[i, 1]
            note(P, V, i, z, beside, extremes)
            if every == 1 or i == 0 or i == n - 1:
                touched = min(touched, look_at_end(now, h, z, rate, piece(before, i, 2), extremes))
                depths[t] = max(depths[t], z)
            i = next_place(i, first, behind, n)
        if touched < NOT_IN_STEP:
            extremes.touch = now - h + h * touched


@part(inline=True)
def look_at_end(now, h, z, rate, before, extremes):
    """Take on the depth of an end and its rate at a row, h (s) after the one before; where in between it touches.

    before (2,): both at that row; h is 0 at the first row.
    """
    touched = NOT_IN_STEP
    if z > extremes.greatest:
        extremes.greatest, extremes.when = z, now
    if h == 0.0:
        touched = 0.0 if z > 0.0 else touched
    else:
        a, a_rate, b_rate = before[0], h * before[1], h * rate
        best, where = greatest(a, z, a_rate, b_rate, extremes.greatest)
        if where < NOT_IN_STEP:
            extremes.greatest, extremes.when = best, now - h + h * where
        if np.isnan(extremes.touch):
            touched = crossing(a, z, a_rate, b_rate)
    before[0], before[1] = z, rate
    return touched


@part
def look_at_bend(table, m, side, bend):
    """Fill bend (2,) with the greatest deflection (m) to a side, 1 or -1, and when (s)."""
    a, a_rate = 0.0, 0.0
    bend[0], bend[1] = -np.inf, table[0, 0]
    for t in range(table.shape[0]):
        b, b_rate = 0.0, 0.0
        for k in range(1, m):
            b += side * table[t, 1 + k]
            b_rate += side * table[t, 1 + m + k]
        if b > bend[0]:
            bend[0], bend[1] = b, table[t, 0]
        if t > 0:
            h = table[t, 0] - table[t - 1, 0]
            best, where = greatest(a, b, h * a_rate, h * b_rate, bend[0])
            if where < NOT_IN_STEP:
                bend[0], bend[1] = best, table[t - 1, 0] + h * where
        a, a_rate = b, b_rate


@kernel(nogil=True)
def find_extremes(first, table, m, w, room, depths, extremes, bends):
    """Fill depths (rows,) m with those of the deepest ends, extremes, and bends (runs, 2, 2) as of `look_at_bend`.

    first (runs + 1,): first row of each run in table (rows, from 1 + 2 m), which has time, m coordinates and m rates;
    w: Lines; room (3, stations, 2) to work in; extremes (runs, lines): records of EXTREMES, which come with the numbers
    of `LineExtremes()`, as depths come with -inf.
    """
    for run in range(first.shape[0] - 1):
        own = rows(table, first[run], first[run + 1] - first[run])
        geometry, deep = piece(w.geometry, run, w.geometry.shape[1]), rows(depths, first[run], own.shape[0])
        of_lines, bend = piece(extremes, run, extremes.shape[1]), piece(bends, run, 2)
        for r in range(w.every.shape[0]):
            n = w.starts[r + 1] - w.starts[r]
            sizes, line = (w.surface[run], w.beside[run, r], w.drop[run, r]), rows(geometry, w.starts[r], n)
            to_work_in = piece(room, 0, n), piece(room, 1, n), piece(room, 2, n)
            look_at_line(own, m, line, w.every[r], sizes, to_work_in, deep, of_lines[r])
        if m > 1:
            look_at_bend(own, m, 1.0, piece(bend, 0, 2))
            look_at_bend(own, m, -1.0, piece(bend, 1, 2))
