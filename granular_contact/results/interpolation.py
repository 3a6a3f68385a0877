"""Interpolation between accepted steps: extremes, zeros and integrals that do not depend on which instants are stored.

Between two steps of length h a quantity with known rate is the cubic Hermite polynomial through both values and rates.
Its error is at most h^4 / 384 times the fourth derivative, and h^2 / 60 times a jump of the second derivative, as at a
stop. An unknown rate is taken from the parabola through three neighbouring values.
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
    """Rates (n, ...) of values (n, ...) by finite differences of second order."""
    if len(time) < 2:
        return np.zeros_like(values)
    slopes: Vector = np.gradient(values, time, axis=0, edge_order=2 if len(time) > 2 else 1)
    return slopes


def at_times(time: Vector, values: Vector, slopes: Vector, at: Vector) -> Vector:
    """Hermite interpolation of a history (n, ...) with rates (n, ...) at times (k,) s: (k, ...); constant beyond it."""
    if len(time) < 2:
        return np.repeat(values[:1], len(at), axis=0)
    i = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(time) - 2)
    step = (time[i + 1] - time[i]).reshape(-1, *[1] * (values.ndim - 1))
    x = np.clip((at - time[i]) / (time[i + 1] - time[i]), 0.0, 1.0).reshape(step.shape)
    interpolated: Vector = (
        (1 + 2 * x) * (1 - x) ** 2 * values[i]
        + x * (1 - x) ** 2 * step * slopes[i]
        + x**2 * (3 - 2 * x) * values[i + 1]
        + x**2 * (x - 1) * step * slopes[i + 1]
    )
    return interpolated


AT_ONCE = 1e-9  # s: two instants closer than this are both sides of a jump
# Integrals of products of the four Hermite shape functions over a step of length 1 (mass matrix of a beam element).
_PRODUCTS = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420.0


def squared(time: Vector, values: Vector) -> float:
    """Integral over time of the square of a history (n,) without known rates, by its Hermite cubics.

    The integral is accurate also if the history decays within a few steps. Instants less than AT_ONCE apart are the two
    sides of a jump.
    """
    cuts = np.flatnonzero(np.diff(time) < AT_ONCE) + 1
    return sum(_squared(*piece) for piece in zip(np.split(time, cuts), np.split(values, cuts), strict=True))


def _squared(time: Vector, values: Vector) -> float:
    step = np.diff(time)
    if not len(step):
        return 0.0
    # A slope is at most three times the smaller of the two neighbouring secants (Fritsch and Carlson 1980). Otherwise a
    # change within a short step would make the cubic of a long step beside it overshoot.
    secants = np.abs(np.diff(values) / step)
    most = 3.0 * np.minimum(np.append(secants, secants[-1]), np.append(secants[0], secants))
    slopes = np.clip(rates(time, values), -most, most)
    ends = np.stack([values[:-1], step * slopes[:-1], values[1:], step * slopes[1:]])
    return float(np.sum(step * np.sum(ends * (_PRODUCTS @ ends), axis=0)))


def greatest(time: Vector, tracks: Iterable[Track]) -> tuple[float, float]:
    """Greatest value of several quantities over time, between steps too, and its time (s)."""
    tracks = list(tracks)
    values = np.array([track.values for track in tracks])
    if not values.size:
        return -np.inf, float(time[0])
    row, k = np.unravel_index(int(values.argmax()), values.shape)
    best, when = float(values[row, k]), float(time[k])
    if np.isnan(best):  # a run that failed by divergence
        return _greatest_number(time, values)
    _, upper = _bounds(time, tracks)
    for row in np.flatnonzero((upper > best).any(axis=1)):
        instants, extremes = _extremes(time, tracks[row], np.flatnonzero(upper[row] > best))
        if len(extremes) and extremes.max() > best:
            index = int(extremes.argmax())
            best, when = float(extremes[index]), float(instants[index])
    return best, when


def _greatest_number(time: Vector, values: Vector) -> tuple[float, float]:
    """Greatest value at the steps and its time (s); NaN values are skipped."""
    known = np.where(np.isnan(values), -np.inf, values)
    row, k = np.unravel_index(int(known.argmax()), known.shape)
    return float(known[row, k]), float(time[k])


def _bounds(time: Vector, tracks: Sequence[Track]) -> tuple[Vector, Vector]:
    """Lower and upper bounds (tracks, n - 1) of the Hermite cubics of every step.

    The shape functions of both values sum to 1; those of the rates are at most 4 / 27 of the step.
    """
    values, slopes = (np.array(arrays) for arrays in zip(*tracks, strict=True))
    start, end, weight = values[:, :-1], values[:, 1:], 4.0 / 27.0 * np.diff(time)
    with np.errstate(over="ignore", invalid="ignore"):  # a run that failed by divergence
        from_start, from_end = weight * slopes[:, :-1], -weight * slopes[:, 1:]
        round_off = 1e-12 * (np.abs(start) + np.abs(end))
        lower = np.minimum(start, end) + np.minimum(from_start, 0.0) + np.minimum(from_end, 0.0) - round_off
        upper = np.maximum(start, end) + np.maximum(from_start, 0.0) + np.maximum(from_end, 0.0) + round_off
    return lower, upper


def _extremes(time: Vector, track: Track, steps: NDArray[np.int64]) -> tuple[Vector, Vector]:
    """Local extremes of the cubics of a quantity within the given steps: times (s) and values, in order of time."""
    step, (c1, c2, c3) = time[steps + 1] - time[steps], _powers(time, track, steps)
    # Roots of c1 + 2 c2 x + 3 c3 x^2 = 0, each in the form without cancellation.
    discriminant = c2 * c2 - 3.0 * c1 * c3
    k = np.flatnonzero(discriminant >= 0.0)
    q = -(c2[k] + np.where(c2[k] < 0.0, -1.0, 1.0) * np.sqrt(discriminant[k]))
    with np.errstate(divide="ignore", invalid="ignore"):
        x = np.stack([q / (3.0 * c3[k]), c1[k] / q])
        inside = (x > 0.0) & (x < 1.0)
    k, x = np.broadcast_to(k, inside.shape)[inside], x[inside]
    order = np.lexsort((x, k))
    k, x = k[order], x[order]
    values = track.values[steps[k]] + x * (c1[k] + x * (c2[k] + x * c3[k]))
    return time[steps[k]] + x * step[k], values


def _powers(time: Vector, track: Track, steps: NDArray[np.int64]) -> tuple[Vector, Vector, Vector]:
    """Coefficients (steps,) of x, x^2 and x^3 of the cubics of the given steps, x from 0 to 1 in each step."""
    step, rise = time[steps + 1] - time[steps], track.values[steps + 1] - track.values[steps]
    return _cubics(rise, step * track.rates[steps], step * track.rates[steps + 1])


def _cubics(rise: Vector, a: Vector, b: Vector) -> tuple[Vector, Vector, Vector]:
    """Coefficients of x, x^2 and x^3 of cubics on [0, 1] with the given rise and the slopes a at 0 and b at 1."""
    return a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise


def above_zero(time: Vector, tracks: Iterable[Track]) -> Spans:
    """Spans [from, to] (s) in which at least one quantity is above zero, in order of time."""
    tracks = list(tracks)
    if not tracks or not len(time):
        return []
    changes = [
        _changes(time, track, np.flatnonzero(steps))
        for track, steps in zip(tracks, _crossed(time, tracks), strict=True)
    ]
    zeros = iter(_zeros(time, tracks, [change.between for change in changes]).tolist())
    spans: Spans = []
    for change in changes:
        edges = [change.first] * change.starts + [next(zeros) for _ in change.between] + [change.last] * change.ends
        spans += zip(edges[::2], edges[1::2], strict=True)
    return _united(spans)


def first_above_zero(time: Vector, tracks: Iterable[Track]) -> float | None:
    """First time (s) at which at least one quantity is above zero; None if there is none."""
    tracks = list(tracks)
    if not tracks or not len(time):
        return None
    if any(track.values[0] > 0.0 for track in tracks):
        return float(time[0])
    crossed = _crossed(time, tracks)
    for k in np.flatnonzero(crossed.any(axis=0)):  # the first such step usually contains the crossing
        step = slice(k, k + 2)
        pieces = [Track(tracks[row].values[step], tracks[row].rates[step]) for row in np.flatnonzero(crossed[:, k])]
        if spans := above_zero(time[step], pieces):
            return spans[0][0]
    return None


def _crossed(time: Vector, tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """Mask (tracks, n - 1) of the steps in which the sign of a quantity may change."""
    lower, upper = _bounds(time, tracks)
    return ~((lower > 0.0) | (upper <= 0.0))


class _Changes(NamedTuple):
    """Changes of sign of a quantity.

    between: (k, 2) s, pairs of times that enclose one change each; first, last: ends of the history (s); starts, ends:
    whether the quantity is above zero there.
    """

    between: Vector
    first: float
    last: float
    starts: bool
    ends: bool


def _changes(time: Vector, track: Track, steps: NDArray[np.int64]) -> _Changes:
    """Enclose the changes of sign of a quantity, which are possible in the given steps alone.

    Between the two times of a pair the quantity is monotonic.
    """
    turns, extremes = _extremes(time, track, steps)
    instants = np.concatenate([time, turns])
    order = np.argsort(instants, kind="stable")
    instants, values = instants[order], np.concatenate([track.values, extremes])[order]
    positive = values > 0.0
    change = np.flatnonzero(positive[1:] != positive[:-1])
    pairs = np.column_stack([instants[change], instants[change + 1]])
    return _Changes(pairs, float(instants[0]), float(instants[-1]), bool(positive[0]), bool(positive[-1]))


def _zeros(time: Vector, tracks: Sequence[Track], between: Sequence[Vector]) -> Vector:
    """Times (s) at which quantities are zero, one within each pair of times (k, 2) s of a quantity, by bisection."""
    low, high = np.concatenate(between).T
    rows = np.repeat(np.arange(len(tracks)), [len(pairs) for pairs in between])
    i = np.clip(np.searchsorted(time, low, side="right") - 1, 0, len(time) - 2)
    values, slopes = (np.array(arrays) for arrays in zip(*tracks, strict=True))
    start, step, c0, rise = time[i], time[i + 1] - time[i], values[rows, i], values[rows, i + 1] - values[rows, i]
    c1, c2, c3 = _cubics(rise, step * slopes[rows, i], step * slopes[rows, i + 1])
    a, b = (low - start) / step, (high - start) / step
    rises = c0 + b * (c1 + b * (c2 + b * c3)) > 0.0
    for _ in range(60):  # to round-off
        middle = 0.5 * (a + b)
        beyond = (c0 + middle * (c1 + middle * (c2 + middle * c3)) > 0.0) == rises
        a, b = np.where(beyond, a, middle), np.where(beyond, middle, b)
    zeros: Vector = start + step * a  # which is exact where a step begins at zero
    return zeros


def _united(spans: Spans) -> Spans:
    """Unite spans that overlap or touch."""
    joined: Spans = []
    for begin, end in sorted(spans):
        if joined and begin <= joined[-1][1]:
            joined[-1] = joined[-1][0], max(end, joined[-1][1])
        else:
            joined.append((begin, end))
    return joined


def positive_part(time: Vector, values: Vector) -> float:
    """Integral over time (s) of the positive part of a quantity (n,), which is linear between the steps."""
    start, end, step = values[:-1], values[1:], np.diff(time)
    crossing = (start > 0.0) != (end > 0.0)
    height = np.abs(start) + np.abs(end)
    share = np.where(crossing, np.maximum(start, end) / np.where(crossing, height, 1.0), 1.0)
    positive = np.maximum(start, 0.0) + np.maximum(end, 0.0)
    return float(np.sum(0.5 * step * share * positive))
