"""Extremes of the motion of modal pendulums, and their touch of the medium, from the rows of their runs.

Between two rows a quantity is interpolated by the cubic Hermite polynomial of both values and rates.
`results.interpolation` does the same for any method of solution, and estimates the error.
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
SHARE = 4.0 / 27.0  # greatest value of the cubic that is 0 at both ends, with rate 1 at one of them and 0 at the other
ROUND_OFF = 1e-12


class Lines(NamedTuple):
    """Lines of stations of several runs, one line after another.

    geometry (runs, stations): records of `modal`; starts (lines + 1,): first station of each line; every (lines,): step
    between stations that count as ends, 1 if all do; surface (runs,): height of the surface (m); beside, drop (runs,
    lines): half the width of a line, and how far it extends below its stations (m).
    """

    geometry: Any
    starts: Any
    every: Any
    surface: Any
    beside: Any
    drop: Any


@part
def powers(a, b, a_rate, b_rate):
    """Coefficients of x, x^2 and x^3 of the cubic of a step, x in [0, 1]; rates are multiplied by its length."""
    rise = b - a
    return a_rate, 3.0 * rise - 2.0 * a_rate - b_rate, a_rate + b_rate - 2.0 * rise


@part
def turns(c1, c2, c3):
    """Stationary points of a cubic, the lesser first, NaN if there are none; each in the form without cancellation."""
    q = -(c2 + math.copysign(math.sqrt(max(c2 * c2 - 3.0 * c1 * c3, 0.0)), c2))
    if c2 * c2 - 3.0 * c1 * c3 < 0.0:
        return np.nan, np.nan
    x, y = q / (3.0 * c3), c1 / q
    return (y, x) if y < x else (x, y)


@part(inline=True)
def bound(a, b, a_rate, b_rate):
    """Upper bound of the cubic of a step."""
    more = max(a_rate, 0.0) + max(-b_rate, 0.0)
    return max(a, b) + SHARE * more + ROUND_OFF * (abs(a) + abs(b))


@part(inline=True)
def greatest(a, b, a_rate, b_rate, best):
    """Greatest value above `best` of the cubic inside a step, and its place; if there is none, `best`, NOT_IN_STEP."""
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
    """Place in a step, which begins at or below zero, where its cubic first rises above zero, else NOT_IN_STEP."""
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
    """Update the extremes by a station at depth z (m); roots are computed only where they may matter."""
    extremes.deepest, extremes.lowest = max(extremes.deepest, z), min(extremes.lowest, P[i, 1])
    if not z > 0.0 or P.shape[0] < 2:
        return
    speed_squared = V[i, 0] * V[i, 0] + V[i, 1] * V[i, 1]
    if speed_squared > extremes.speed * extremes.speed:
        extremes.speed = math.sqrt(speed_squared)
    if P[i, 0] - beside < extremes.left or P[i, 0] + beside > extremes.right:
        k = min(i, P.shape[0] - 2)
        x, y = P[k + 1, 0] - P[k, 0], P[k + 1, 1] - P[k, 1]
        wide = beside * abs(y) / math.sqrt(x * x + y * y)
        extremes.left = min(extremes.left, P[i, 0] - wide)
        extremes.right = max(extremes.right, P[i, 0] + wide)


@part
def place_extreme_stations(row, m, geometry, every, surface, P, V):
    """Place the stations of a line that may be extreme.

    Return the first of these between the ends of the line, and the index behind the last. On a straight line all
    extremes are at its ends, or at the ends of its immersed part.
    """
    n, q, v = geometry.shape[0], rows(row, 1, m), rows(row, 1 + m, m)
    if every == 1:
        modal_stations(q, v, geometry, P, V)
        return 0, n
    c, s = math.cos(q[0]), math.sin(q[0])
    first, immersed = within_reach(c, s, q, geometry, surface)
    for k, count in ((0, 1), (first, immersed), (n - 1, 1)):
        place_stations(c, s, q, v, rows(geometry, k, count), rows(P, k, count), rows(V, k, count))
    return first, first + immersed


@part(inline=True)
def next_station(i, first, behind, n):
    """Index of the station of a line to look at after the i-th, see `place_extreme_stations`; n after the last one."""
    i += 1
    if i < first:
        i = first
    return n - 1 if behind <= i < n else i


@part
def extremes_of_line(table, m, geometry, every, sizes, room, depths, extremes):
    """Update the extremes by one line, over the rows of a run.

    sizes: height of the surface, half the width, extent below the stations (m), see Lines; room: three times (stations,
    2).
    """
    n, (surface, beside, drop), (P, V, before) = geometry.shape[0], sizes, room
    for t in range(table.shape[0]):
        now, h = table[t, 0], 0.0 if t == 0 else table[t, 0] - table[t - 1, 0]
        touched = NOT_IN_STEP
        first, behind = place_extreme_stations(
            piece(table, t, table.shape[1]), m, geometry, every, surface + drop, P, V
        )
        i = 0
        while i < n:
            z, rate = surface - P[i, 1] + drop, -V[i, 1]
            note(P, V, i, z, beside, extremes)
            if every == 1 or i == 0 or i == n - 1:
                touched = min(touched, extremes_of_end(now, h, z, rate, piece(before, i, 2), extremes))
                depths[t] = max(depths[t], z)
            i = next_station(i, first, behind, n)
        if touched < NOT_IN_STEP:
            extremes.touch = now - h + h * touched


@part(inline=True)
def extremes_of_end(now, h, z, rate, before, extremes):
    """Update the extremes by the depth z and its rate of an end at a row; return where in the step before it touches.

    h (s): time since the row before, 0 at the first row; before (2,): depth and rate at that row.
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
def greatest_deflection(table, m, side, bend):
    """Fill bend (2,) with the greatest deflection (m) to a side, 1 or -1, and its time (s)."""
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
    """Fill depths (rows,) m of the deepest ends, extremes of lines, and bends (runs, 2, 2), see `greatest_deflection`.

    first (runs + 1,): first row of each run in table (rows, from 1 + 2 m), which has time, m coordinates and m rates;
    w: Lines; room (3, stations, 2): work space; extremes (runs, lines): records of EXTREMES. At the call depths are
    -inf, and extremes have the numbers of `LineExtremes()`.
    """
    for run in range(first.shape[0] - 1):
        table_of_run = rows(table, first[run], first[run + 1] - first[run])
        geometry, deep = piece(w.geometry, run, w.geometry.shape[1]), rows(depths, first[run], table_of_run.shape[0])
        of_lines, bend = piece(extremes, run, extremes.shape[1]), piece(bends, run, 2)
        for r in range(w.every.shape[0]):
            n = w.starts[r + 1] - w.starts[r]
            sizes, line = (w.surface[run], w.beside[run, r], w.drop[run, r]), rows(geometry, w.starts[r], n)
            to_work_in = piece(room, 0, n), piece(room, 1, n), piece(room, 2, n)
            extremes_of_line(table_of_run, m, line, w.every[r], sizes, to_work_in, deep, of_lines[r])
        if m > 1:
            greatest_deflection(table_of_run, m, 1.0, piece(bend, 0, 2))
            greatest_deflection(table_of_run, m, -1.0, piece(bend, 1, 2))
