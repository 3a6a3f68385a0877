"""Signals of drives -> tables of quintic pieces for kernels, see `mechanics.kernels.signal_tables`.

The knots between the pieces follow from the periods of signals and from the instants at which they bend or jump.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from granular_contact.scene.parts import Vector
from granular_contact.scene.signals import (
    Buehler,
    Piecewise,
    Ramp,
    Signal,
    Sine,
    Smoothed,
)

PIECES_PER_PERIOD, PIECES_PER_RUN = 50, 20  # at least
TOLERANCE = 1e-6  # of the acceleration in the middle of a piece, relative to accelerations of the piece
BESIDE = 1e-10  # s: derivatives at a knot are taken this far inside the piece, as they may jump at the knot
SHORTEST = 1e-6  # s, of a piece that is halved

# Hermite interpolation: value, rate and acceleration at both ends of a piece of length 1 -> six coefficients.
HERMITE = np.array(
    [
        [1, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, 0, 0.5, 0, 0, 0],
        [-10, -6, -1.5, 10, -4, 0.5],
        [15, 8, 1.5, -15, 7, -1],
        [-6, -3, -0.5, 6, -3, 0.5],
    ]
)


def tabulate(signals: Sequence[Signal], end: float) -> tuple[Vector, Vector]:
    """Tabulate signals by quintic pieces: knots (k + 1,) s from 0 to the end of a run (s), pieces (signals, k, 6).

    A piece has its coefficients with the lowest power of the time (s) since its first knot first. Pieces are halved
    until the accelerations in their middles are right.
    """
    spans = np.array(list(pairwise(sorted(_first_knots(signals, end)))))
    knots, finished = list[Vector](), list[Vector]()
    while len(spans):
        pieces, inexact = _pieces(signals, spans)
        halved = inexact & (np.ptp(spans, axis=1) > SHORTEST)
        knots.append(spans[~halved, 0])
        finished.append(pieces[:, ~halved])
        first, last = spans[halved].T
        middle = 0.5 * (first + last)
        spans = np.concatenate([np.column_stack([first, middle]), np.column_stack([middle, last])])
    starts = np.concatenate(knots)
    order = np.argsort(starts)
    return np.append(starts[order], end), np.take(np.concatenate(finished, axis=1), order, axis=1)


def _first_knots(signals: Sequence[Signal], end: float) -> set[float]:
    """Knots before pieces are halved: equidistant ones, and instants at which second derivatives may jump."""
    periods = [time for signal in signals if (time := period(signal)) is not None]
    longest = min([end / PIECES_PER_RUN, *(time / PIECES_PER_PERIOD for time in periods)])
    even = np.linspace(0.0, end, math.ceil(end / longest) + 1).tolist()
    return {*even, *(t for signal in signals for t in jerks(signal) if 0.0 < t < end)}


def _pieces(signals: Sequence[Signal], spans: Vector) -> tuple[Vector, NDArray[np.bool_]]:
    """Pieces (signals, k, 6) over spans (k, 2) s; marks (k,) of the spans with a wrong acceleration in the middle.

    A wrong acceleration differs from that of the signal by more than allowed.
    """
    h, (start, stop) = np.ptp(spans, axis=1), spans.T
    ends = [
        (
            _sampled(signals, "value", knot),
            h * _sampled(signals, "rate", at),
            h * h * _sampled(signals, "acceleration", at),
        )
        for knot, at in ((start, start + BESIDE), (stop, stop - BESIDE))
    ]
    pieces = (HERMITE @ np.stack([*ends[0], *ends[1]], axis=2)[..., None])[..., 0] / h[:, None] ** np.arange(6)
    c, tau = np.moveaxis(pieces, 2, 0), 0.5 * h
    interpolated = 2.0 * c[2] + tau * (6.0 * c[3] + tau * (12.0 * c[4] + tau * 20.0 * c[5]))
    exact, rate = (_sampled(signals, name, start + tau) for name in ("acceleration", "rate"))
    scale = np.max([np.abs(exact), np.abs(2.0 * c[2]), np.abs(rate) / tau], axis=0)
    return pieces, (np.abs(interpolated - exact) > TOLERANCE * scale).any(axis=0)


def _sampled(signals: Sequence[Signal], name: str, times: Vector) -> Vector:
    """Values (signals, k) of signals at times (k,) s, or of a derivative of this name."""
    rows = [[method(t) for t in times.tolist()] for method in (getattr(signal, name) for signal in signals)]
    return np.array(rows, float).reshape(len(signals), len(times))


BEND = 0.1  # of the greatest mean rate of a table: smaller changes are those between the pieces of a smooth curve


def jerks(signal: Signal) -> tuple[float, ...]:
    """Instants (s) at which a signal's second derivative may jump; only tables have any."""
    inner = signal.signal if isinstance(signal, Smoothed) else signal
    return inner.times if isinstance(inner, Piecewise) else ()


def bends(signals: Iterable[Signal]) -> list[float]:
    """Instants (s) at which the mean rates of a table before and after differ by more than `BEND` of the greatest."""
    instants: set[float] = set()
    for signal in signals:
        if isinstance(signal, Piecewise):
            values = [signal.value(t) for t in signal.times]
            rates = np.concatenate([[0.0], np.diff(values) / np.diff(signal.times), [0.0]])
            bent = np.abs(np.diff(rates)) > BEND * np.abs(rates).max()
            instants.update(t for t, is_bent in zip(signal.times, bent, strict=True) if is_bent)
    return sorted(instants)


def period(signal: Signal) -> float | None:
    """Time (s) after which a signal repeats itself, for a `Buehler` clock one turn further; None without a period."""
    if isinstance(signal, Smoothed):
        return period(signal.signal)
    if isinstance(signal, Sine):
        return 2.0 * math.pi / abs(signal.omega) if signal.omega and signal.amplitude else None
    return 1.0 / abs(signal.frequency) if isinstance(signal, Buehler) and signal.frequency else None


def corners(signals: Iterable[Signal]) -> list[float]:
    """Instants (s) between which signals change smoothly: bends of tables, first and last instants of ramps."""
    every = list(signals)
    instants = set(bends(every))
    for signal in every:
        if isinstance(signal, Ramp) and signal.first != signal.last:
            instants |= {signal.start, signal.start + signal.duration}
    return sorted(instants)


def shortest_period(signal: Signal, end: float) -> float:
    """Shortest period (s) of a signal before an end (s); infinite for a signal that does not oscillate.

    In a table of oscillations it is the time between the middle of a rise and the middle of the next rise. A single
    pulse counts four times its width at half of its height: with two steps a period, a triangle can then fall between
    two steps. The clock of a leg counts twice its stance or swing, whichever is shorter, or 16 times the duration of a
    transition between its rates, if that is shorter still.
    """
    if isinstance(signal, Smoothed):
        return shortest_period(signal.signal, end)
    if isinstance(signal, Buehler):
        share = min(2.0 * signal.duty, 2.0 * (1.0 - signal.duty), 16.0 * signal.blend)
        return share / abs(signal.frequency) if signal.frequency else math.inf
    if isinstance(signal, Piecewise):
        middles = _middles(np.array(signal.times), np.array([signal.value(t) for t in signal.times]))
        gaps = [math.inf, *(b - a for a, b in pairwise(middles) if 0.0 < b < end), math.inf]
        around = zip(gaps, gaps[1:], gaps[2:], strict=False)
        return min((gap + min(before, after, 3.0 * gap) for before, gap, after in around), default=math.inf)
    return period(signal) or math.inf


def _middles(times: NDArray[np.float64], values: NDArray[np.float64]) -> list[float]:
    """Instants (s) at which values (n,) at times (n,) pass the middle between two successive extrema.

    Extrema that differ from their neighbours by less than `BEND` of the range of values do not count.
    """
    least, extrema, last = BEND * float(np.ptp(values)), [0], 0
    for i in range(1, len(values)):  # last: index of the farthest value from the latest extremum so far
        direction = np.sign(values[last] - values[extrema[-1]])
        if direction * (values[i] - values[last]) >= 0.0:
            last = i if direction or abs(values[i] - values[last]) > least else last
        elif abs(values[i] - values[last]) > least:
            extrema.append(last)
            last = i
    instants = []
    for a, b in pairwise([*extrema, last]):
        if a == b or values[a] == values[b]:
            continue
        middle, direction = 0.5 * (values[a] + values[b]), np.sign(values[b] - values[a])
        k = a + 1 + int(np.argmax(direction * (values[a + 1 : b + 1] - middle) >= 0.0))
        share = (middle - values[k - 1]) / (values[k] - values[k - 1])
        instants.append(float(times[k - 1] + share * (times[k] - times[k - 1])))
    return instants
