"""Numbers of a history between its accepted steps, so that none of them depends on which instants were stored.

Between two steps of length h a quantity with known rate is the cubic through both values and rates (Hermite); it is
off by h^4 / 384 times the fourth derivative, and by h^2 / 60 times a jump of the second at most, as at a stop. A rate
that is not known is that of the parabola through three neighbours.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
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


def greatest(time: Vector, tracks: Iterable[Track]) -> tuple[float, float]:
    """Greatest value that any of these quantities gets, and when (s)."""
    best, when = -np.inf, float(time[0])
    for track in tracks:
        places, extremes = _extremes(time, track)
        for at, values in ((time, track.values), (places, extremes)):
            if len(values) and values.max() > best:
                k = int(values.argmax())
                best, when = float(values[k]), float(at[k])
    return best, when


def _extremes(time: Vector, track: Track) -> tuple[Vector, Vector]:
    """Instants between the steps at which the cubics of a quantity turn round, and its values there."""
    step, (c1, c2, c3) = np.diff(time), _powers(time, track)
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
    return time[k] + x * step[k], track.values[k] + x * (c1[k] + x * (c2[k] + x * c3[k]))


def _powers(time: Vector, track: Track) -> tuple[Vector, Vector, Vector]:
    """Coefficients (n - 1,) of x, x^2 and x^3 of the cubic of every step, x from 0 to 1 in it."""
    step, rise = np.diff(time), np.diff(track.values)
    a, b = step * track.rates[:-1], step * track.rates[1:]
    return a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise


def above_zero(time: Vector, tracks: Iterable[Track]) -> Spans:
    """Spans [from, to] (s) in which any of these quantities is above zero, one after another."""
    return _united([span for track in tracks for span in _above(time, track)])


def _above(time: Vector, track: Track) -> Spans:
    if not len(time):
        return []
    between, extremes = _extremes(time, track)
    places = np.concatenate([time, between])
    order = np.argsort(places, kind="stable")
    places, values = places[order], np.concatenate([track.values, extremes])[order]
    up = values > 0.0
    change = np.flatnonzero(up[1:] != up[:-1])
    edges = [_zero(time, track, places[k], places[k + 1]) for k in change]
    edges = [float(places[0])] * bool(up[0]) + edges + [float(places[-1])] * bool(up[-1])
    return list(zip(edges[::2], edges[1::2], strict=True))


def _zero(time: Vector, track: Track, low: float, high: float) -> float:
    """Where a quantity passes zero between two times at which its sign differs, and between which it turns nowhere."""
    i = int(np.clip(np.searchsorted(time, low, side="right") - 1, 0, len(time) - 2))
    two = Track(track.values[i : i + 2], track.rates[i : i + 2])
    start, step = float(time[i]), float(time[i + 1] - time[i])
    c0, (c1, c2, c3) = float(two.values[0]), (float(c[0]) for c in _powers(time[i : i + 2], two))
    a, b = (low - start) / step, (high - start) / step
    rises = c0 + b * (c1 + b * (c2 + b * c3)) > 0.0
    for _ in range(60):  # bisection, to round-off
        middle = 0.5 * (a + b)
        if (c0 + middle * (c1 + middle * (c2 + middle * c3)) > 0.0) == rises:
            b = middle
        else:
            a = middle
    return float(start + step * 0.5 * (a + b))


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
