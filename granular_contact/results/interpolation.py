"""Numbers of a history between its accepted steps, so that none of them depends on which instants were stored.

Between two steps of length h a quantity with known rate is the cubic through both values and rates (Hermite); it is
off by h^4 / 384 times the fourth derivative, and by h^2 / 60 times a jump of the second at most, as at a stop. A rate
that is not known is that of the parabola through three neighbours.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.values.arrays import Vector

Spans = list[tuple[float, float]]


class Track(NamedTuple):
    """Values (n,) of a quantity at the instants of a history, and its rates (n,)."""

    values: Vector
    rates: Vector


def rates(time: Vector, values: Vector) -> Vector:
    """Rates (n, ...) of values (n, ...) whose own rates are not known."""
    if len(time) < 2:
        return np.zeros_like(values)
    found: Vector = np.gradient(values, time, axis=0, edge_order=2 if len(time) > 2 else 1)
    return found


def at_times(time: Vector, values: Vector, slopes: Vector, at: Vector) -> Vector:
    """Values (k, ...) at times (k,) s of a history (n, ...) with its rates (n, ...); held beyond its ends."""
    if len(time) < 2:
        return np.repeat(values[:1], len(at), axis=0)
    i = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    step = (time[i + 1] - time[i]).reshape(-1, *[1] * (values.ndim - 1))
    x = np.clip((at - time[i]) / (time[i + 1] - time[i]), 0.0, 1.0).reshape(step.shape)
    found: Vector = (
        (1 + 2 * x) * (1 - x) ** 2 * values[i]
        + x * (1 - x) ** 2 * step * slopes[i]
        + x**2 * (3 - 2 * x) * values[i + 1]
        + x**2 * (x - 1) * step * slopes[i + 1]
    )
    return found


AT_ONCE = 1e-9  # s: two instants on either side of a jump
# Integrals over a step of products of the cubics by which values and rates at its ends count (a beam's mass matrix).
_PRODUCTS = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0


def squared(time: Vector, values: Vector) -> float:
    """Integral of the square of a history (n,) whose rates are not known; what decays within few steps counts right.

    Between instants that lie less than AT_ONCE apart it jumps.
    """
    cuts = np.flatnonzero(np.diff(time) < AT_ONCE) + 1
    return sum(_squared(*piece) for piece in zip(np.split(time, cuts), np.split(values, cuts), strict=True))


def _squared(time: Vector, values: Vector) -> float:
    step = np.diff(time)
    if not len(step):
        return 0.0
    # No steeper than three times the gentler of both neighbours (Fritsch and Carlson 1980): a change within a short
    # step would else swing over the long one beside it.
    secants = np.abs(np.diff(values) / step)
    most = 3.0 * np.minimum(np.append(secants, secants[-1]), np.append(secants[0], secants))
    slopes = np.clip(rates(time, values), -most, most)
    ends = np.stack([values[:-1], step * slopes[:-1], values[1:], step * slopes[1:]])
    return float(np.sum(step * np.sum(ends * (_PRODUCTS @ ends), axis=0)))


def greatest(time: Vector, tracks: Iterable[Track]) -> tuple[float, float]:
    """Greatest value that any of these quantities gets, and when (s)."""
    several = list(tracks)
    values = np.array([track.values for track in several])
    if not values.size:
        return -np.inf, float(time[0])
    row, k = np.unravel_index(int(values.argmax()), values.shape)
    best, when = float(values[row, k]), float(time[k])
    if np.isnan(best):  # of a run that failed by running away
        return _greatest_number(time, values)
    _, most = _between(time, several)
    for row in np.flatnonzero((most > best).any(axis=1)):
        places, extremes = _extremes(time, several[row], np.flatnonzero(most[row] > best))
        if len(extremes) and extremes.max() > best:
            place = int(extremes.argmax())
            best, when = float(extremes[place]), float(places[place])
    return best, when


def _greatest_number(time: Vector, values: Vector) -> tuple[float, float]:
    """The same of values at the steps alone, some of which are no numbers."""
    known = np.where(np.isnan(values), -np.inf, values)
    row, k = np.unravel_index(int(known.argmax()), known.shape)
    return float(known[row, k]), float(time[k])


def _between(time: Vector, tracks: Sequence[Track]) -> tuple[Vector, Vector]:
    """Bounds (tracks, n - 1), least and greatest, of the cubics of every step.

    Values at the ends are averaged; the rate at either end adds 4 / 27 of the step at most.
    """
    values, slopes = (np.array(both) for both in zip(*tracks, strict=True))
    a, b, most = values[:, :-1], values[:, 1:], 4.0 / 27.0 * np.diff(time)
    with np.errstate(over="ignore", invalid="ignore"):  # of a run that failed by running away
        into, out = most * slopes[:, :-1], -most * slopes[:, 1:]
        near = 1e-12 * (np.abs(a) + np.abs(b))  # round-off
        low = np.minimum(a, b) + np.minimum(into, 0.0) + np.minimum(out, 0.0) - near
        high = np.maximum(a, b) + np.maximum(into, 0.0) + np.maximum(out, 0.0) + near
    return low, high


def _extremes(time: Vector, track: Track, steps: NDArray[np.int64]) -> tuple[Vector, Vector]:
    """Instants within some steps at which the cubics of a quantity turn round, and its values there."""
    step, (c1, c2, c3) = time[steps + 1] - time[steps], _powers(time, track, steps)
    # c1 + 2 c2 x + 3 c3 x^2 = 0; of the two forms of its roots each the one that does not cancel.
    root = c2 * c2 - 3.0 * c1 * c3
    k = np.flatnonzero(root >= 0.0)
    q = -(c2[k] + np.where(c2[k] < 0.0, -1.0, 1.0) * np.sqrt(root[k]))
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.stack([q / (3.0 * c3[k]), c1[k] / q])
        inside = (x > 0.0) & (x < 1.0)
    k, x = np.broadcast_to(k, inside.shape)[inside], x[inside]
    order = np.lexsort((x, k))
    k, x = k[order], x[order]
    values = track.values[steps[k]] + x * (c1[k] + x * (c2[k] + x * c3[k]))
    return time[steps[k]] + x * step[k], values


def _powers(time: Vector, track: Track, steps: NDArray[np.int64]) -> tuple[Vector, Vector, Vector]:
    """Coefficients (steps,) of x, x^2 and x^3 of the cubics of some steps, x from 0 to 1 in each."""
    step, rise = time[steps + 1] - time[steps], track.values[steps + 1] - track.values[steps]
    return _cubics(rise, step * track.rates[steps], step * track.rates[steps + 1])


def _cubics(rise: Vector, a: Vector, b: Vector) -> tuple[Vector, Vector, Vector]:
    """Coefficients of x, x^2 and x^3 of cubics that rise by so much, with the slopes a at 0 and b at 1."""
    return a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise


def above_zero(time: Vector, tracks: Iterable[Track]) -> Spans:
    """Spans [from, to] (s) in which any of these quantities is above zero, one after another."""
    several = list(tracks)
    if not several or not len(time):
        return []
    found = [
        _changes(time, track, np.flatnonzero(steps))
        for track, steps in zip(several, _crossed(time, several), strict=True)
    ]
    zeros = iter(_zeros(time, several, [one.between for one in found]).tolist())
    spans: Spans = []
    for one in found:
        edges = [one.first] * one.starts + [next(zeros) for _ in one.between] + [one.last] * one.ends
        spans += zip(edges[::2], edges[1::2], strict=True)
    return _united(spans)


def first_above_zero(time: Vector, tracks: Iterable[Track]) -> float | None:
    """When (s) any of these quantities is first above zero; None where none ever is."""
    several = list(tracks)
    if not several or not len(time):
        return None
    if any(track.values[0] > 0.0 for track in several):
        return float(time[0])
    crossed = _crossed(time, several)
    for k in np.flatnonzero(crossed.any(axis=0)):  # of which mostly the first is one
        part = slice(k, k + 2)
        here = [Track(several[row].values[part], several[row].rates[part]) for row in np.flatnonzero(crossed[:, k])]
        if spans := above_zero(time[part], here):
            return spans[0][0]
    return None


def _crossed(time: Vector, tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """Steps (tracks, n - 1) in which the sign of a quantity may change."""
    least, most = _between(time, tracks)
    return ~((least > 0.0) | (most <= 0.0))


class _Changes(NamedTuple):
    """Where a quantity changes its sign, (k, 2) s: between two times; whether it is above zero at both ends (s)."""

    between: Vector
    first: float
    last: float
    starts: bool
    ends: bool


def _changes(time: Vector, track: Track, steps: NDArray[np.int64]) -> _Changes:
    """Of one quantity, whose sign may change in some steps only; between two times it turns nowhere."""
    between, extremes = _extremes(time, track, steps)
    places = np.concatenate([time, between])
    order = np.argsort(places, kind="stable")
    places, values = places[order], np.concatenate([track.values, extremes])[order]
    up = values > 0.0
    change = np.flatnonzero(up[1:] != up[:-1])
    pairs = np.column_stack([places[change], places[change + 1]])
    return _Changes(pairs, float(places[0]), float(places[-1]), bool(up[0]), bool(up[-1]))


def _zeros(time: Vector, tracks: Sequence[Track], between: Sequence[Vector]) -> Vector:
    """Where quantities pass zero, each between its pairs of times (k, 2) s, one after another; by bisection."""
    low, high = np.concatenate(between).T
    rows = np.repeat(np.arange(len(tracks)), [len(pairs) for pairs in between])
    i = np.clip(np.searchsorted(time, low, side="right") - 1, 0, len(time) - 2)
    values, slopes = (np.array(both) for both in zip(*tracks, strict=True))
    start, step, c0, rise = time[i], time[i + 1] - time[i], values[rows, i], values[rows, i + 1] - values[rows, i]
    c1, c2, c3 = _cubics(rise, step * slopes[rows, i], step * slopes[rows, i + 1])
    a, b = (low - start) / step, (high - start) / step
    rises = c0 + b * (c1 + b * (c2 + b * c3)) > 0.0
    for _ in range(60):  # to round-off
        middle = 0.5 * (a + b)
        beyond = (c0 + middle * (c1 + middle * (c2 + middle * c3)) > 0.0) == rises
        a, b = np.where(beyond, a, middle), np.where(beyond, middle, b)
    zeros: Vector = start + step * 0.5 * (a + b)
    return zeros


def _united(spans: Spans) -> Spans:
    """Spans that overlap or meet made one."""
    joined: Spans = []
    for begin, end in sorted(spans):
        if joined and begin <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(end, joined[-1][1])
        else:
            joined.append((begin, end))
    return joined


def positive_part(time: Vector, values: Vector) -> float:
    """Integral over time (s) of a quantity (n,) where it is above zero, straight between the steps."""
    a, b, step = values[:-1], values[1:], np.diff(time)
    crossing = (a > 0.0) != (b > 0.0)
    width = np.abs(a) + np.abs(b)
    share = np.where(crossing, np.maximum(a, b) / np.where(crossing, width, 1.0), 1.0)
    high = np.maximum(a, 0.0) + np.maximum(b, 0.0)
    return float(np.sum(0.5 * step * share * high))
