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
    values, slopes = _stacked(list(tracks))
    if not values.size:
        return -np.inf, float(time[0])
    row, k = np.unravel_index(int(values.argmax()), values.shape)
    best, when = float(values[row, k]), float(time[k])
    if np.isnan(best):  # a run that failed by divergence
        return _greatest_number(time, values)
    cubics = _cubics(time, values, slopes, _bounds(time, values, slopes)[1] > best)
    x = _turns(cubics)
    extremes = np.where(x > 0.0, cubics.at(x), -np.inf)
    if extremes.max(initial=-np.inf) > best:
        i, k = np.unravel_index(int(extremes.argmax()), extremes.shape)
        best, when = float(extremes[i, k]), float(cubics.start[k] + x[i, k] * cubics.step[k])
    return best, when


def _greatest_number(time: Vector, values: Vector) -> tuple[float, float]:
    """Greatest value at the steps and its time (s); NaN values are skipped."""
    known = np.where(np.isnan(values), -np.inf, values)
    row, k = np.unravel_index(int(known.argmax()), known.shape)
    return float(known[row, k]), float(time[k])


class _Cubics(NamedTuple):
    """Cubics c_0 + c_1 x + c_2 x^2 + c_3 x^3 of quantities in steps, x from 0 to 1 in each step, (k,) each.

    row: of the quantity; start, step: first instant and length of the step (s); end: value at x = 1.
    """

    row: NDArray[np.int64]
    start: Vector
    step: Vector
    end: Vector
    c: tuple[Vector, Vector, Vector, Vector]

    def at(self, x: Vector) -> Vector:
        """Values (..., k) at x (..., k)."""
        c0, c1, c2, c3 = self.c
        return c0 + x * (c1 + x * (c2 + x * c3))

    def subset(self, which: NDArray[np.int64]) -> _Cubics:
        """Some of the cubics."""
        row, start, step, end = (part[which] for part in self[:4])
        return _Cubics(row, start, step, end, tuple(c[which] for c in self.c))  # type: ignore[arg-type]


def _stacked(tracks: Sequence[Track]) -> tuple[Vector, Vector]:
    """Values and rates (tracks, n) of several quantities."""
    both = np.array(tracks, float) if tracks else np.zeros((0, 2, 0))
    return both[:, 0], both[:, 1]


def _bounds(time: Vector, values: Vector, slopes: Vector) -> tuple[Vector, Vector]:
    """Lower and upper bounds (tracks, n - 1) of the Hermite cubics of every step.

    The shape functions of both values sum to 1; those of the rates are at most 4 / 27 of the step.
    """
    start, end = values[:, :-1], values[:, 1:]
    with np.errstate(over="ignore", invalid="ignore"):  # a run that failed by divergence
        size, slope = np.abs(values), np.abs(slopes)
        round_off = 1e-12 * (size[:, :-1] + size[:, 1:])
        beyond = 4.0 / 27.0 * np.diff(time) * (slope[:, :-1] + slope[:, 1:]) + round_off
        return np.minimum(start, end) - beyond, np.maximum(start, end) + beyond


def _cubics(time: Vector, values: Vector, slopes: Vector, where: NDArray[np.bool_]) -> _Cubics:
    """Hermite cubics of quantities (tracks, n) in the steps of a mask (tracks, n - 1), row by row."""
    row, k = np.nonzero(where)
    start, step, value, end = time[k], time[k + 1] - time[k], values[row, k], values[row, k + 1]
    rise, a, b = end - value, step * slopes[row, k], step * slopes[row, k + 1]
    return _Cubics(row, start, step, end, (value, a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise))


def _turns(cubics: _Cubics) -> Vector:
    """Places x (2, k) of the local extremes of cubics within their steps, in order; 0 where there is none."""
    _, c1, c2, c3 = cubics.c
    with np.errstate(all="ignore"):
        # Roots of c1 + 2 c2 x + 3 c3 x^2 = 0, each in the form without cancellation.
        q = -(c2 + np.where(c2 < 0.0, -1.0, 1.0) * np.sqrt(c2 * c2 - 3.0 * c1 * c3))
        x = np.stack([q / (3.0 * c3), c1 / q])
        return np.sort(np.where((x > 0.0) & (x < 1.0), x, 0.0), axis=0)


def above_zero(time: Vector, tracks: Iterable[Track]) -> Spans:
    """Spans [from, to] (s) in which at least one quantity is above zero, in order of time."""
    return each_above_zero(time, [list(tracks)])[0]


def each_above_zero(time: Vector, groups: Sequence[Sequence[Track]]) -> list[Spans]:
    """For each group of quantities the spans [from, to] (s) in which at least one is above zero, in order of time."""
    spans: list[Spans] = [[] for _ in groups]
    values, slopes = _stacked([track for group in groups for track in group])
    if not values.size:
        return spans
    cubics = _cubics(time, values, slopes, _crossed(time, values, slopes))
    turns = _turns(cubics)
    x = np.concatenate([np.zeros_like(turns[:1]), turns, np.ones_like(turns[:1])])
    positive = np.concatenate([cubics.c[0][None], cubics.at(turns), cubics.end[None]]) > 0.0
    k, i = np.nonzero((positive[1:] != positive[:-1]).T)
    zeros = _zeros(cubics.subset(k), x[i, k], x[i + 1, k], positive[i + 1, k])
    first, last = (np.flatnonzero(values[:, end] > 0.0) for end in (0, -1))
    rows = np.concatenate([first, cubics.row[k], last])
    edges = np.concatenate([np.full(len(first), time[0]), zeros, np.full(len(last), time[-1])])
    order = np.argsort(rows, kind="stable")
    owners = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    for row, (begin, end) in zip(rows[order][::2], edges[order].reshape(-1, 2).tolist(), strict=True):
        spans[owners[row]].append((begin, end))
    return [_united(each) for each in spans]


def first_above_zero(time: Vector, tracks: Iterable[Track]) -> float | None:
    """First time (s) at which at least one quantity is above zero; None if there is none."""
    values, slopes = _stacked(list(tracks))
    if not values.size:
        return None
    above = np.flatnonzero((values > 0.0).any(axis=0))
    if len(above) and above[0] == 0:
        return float(time[0])
    until = above[0] + 1 if len(above) else len(time)
    crossed = _crossed(time[:until], values[:, :until], slopes[:, :until])
    for k in np.flatnonzero(crossed.any(axis=0)):  # the first such step usually contains the crossing
        step, rows = slice(k, k + 2), crossed[:, k]
        if spans := above_zero(time[step], map(Track, values[rows, step], slopes[rows, step])):
            return spans[0][0]
    return None


def _crossed(time: Vector, values: Vector, slopes: Vector) -> NDArray[np.bool_]:
    """Mask (tracks, n - 1) of the steps in which the sign of a quantity may change."""
    lower, upper = _bounds(time, values, slopes)
    return ~((lower > 0.0) | (upper <= 0.0))


def _zeros(cubics: _Cubics, a: Vector, b: Vector, rises: NDArray[np.bool_]) -> Vector:
    """Times (k,) s of the zeros of cubics, one between a and b (k,) in each, by bisection; rises: above zero at b."""
    for _ in range(60):  # to round-off
        middle = 0.5 * (a + b)
        beyond = (cubics.at(middle) > 0.0) == rises
        a, b = np.where(beyond, a, middle), np.where(beyond, middle, b)
    return cubics.start + cubics.step * a  # which is exact where a step begins at zero


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
