"""Signals of drives -> the tables that kernels look them up in, see `mechanics.kernels.signal_tables`.

Where the pieces of a table end follows from when a signal repeats itself, bends or jumps.
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

A_PERIOD, A_RUN = 50, 20  # pieces at least
ROUNDING = 1e-6  # of the greatest acceleration between two knots: by so much a piece may be off in its middle
BESIDE = 1e-10  # s, from a knot, where derivatives may jump
SHORTEST = 1e-6  # s, of a piece

# Value, rate and acceleration at both ends of a piece of length 1 -> coefficients.
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
    """Knots (k + 1,) s over a run to its end (s), and pieces (signals, k, 6)."""
    knots = sorted(_places(signals, end))
    rows: list[Vector] = []
    found = [0.0]
    for first, last in pairwise(knots):
        waiting = [(first, last)]
        while waiting:
            start, stop = waiting.pop()
            piece = np.array([_piece(signal, start, stop) for signal in signals]).reshape(len(signals), 6)
            off = any(_is_off(signal, of, start, stop) for signal, of in zip(signals, piece, strict=True))
            if off and stop - start > SHORTEST:
                middle = 0.5 * (start + stop)
                waiting += [(middle, stop), (start, middle)]
            else:
                rows.append(piece)
                found.append(stop)
    return np.array(found), np.stack(rows, axis=1) if signals else np.zeros((0, len(rows), 6))


def _places(signals: Sequence[Signal], end: float) -> set[float]:
    """Where pieces begin and end at least."""
    periods = [one for signal in signals if (one := period(signal)) is not None]
    longest = min([end / A_RUN, *(one / A_PERIOD for one in periods)])
    even = np.linspace(0.0, end, math.ceil(end / longest) + 1).tolist()
    return {*even, *(at for signal in signals for at in jerks(signal) if 0.0 < at < end)}


def _ends(signal: Signal, start: float, stop: float) -> Vector:
    """Value, rate and acceleration at both ends of a piece, from within, for a time in units of its length."""
    h, inside = stop - start, (start + BESIDE, stop - BESIDE)
    found = [
        (signal.value(t), h * signal.rate(u), h * h * signal.acceleration(u))
        for t, u in zip((start, stop), inside, strict=True)
    ]
    return np.array(found).ravel()


def _piece(signal: Signal, start: float, stop: float) -> Vector:
    """Coefficients (6,) over a piece."""
    coefficients: Vector = (HERMITE @ _ends(signal, start, stop)) / (stop - start) ** np.arange(6)
    return coefficients


def _is_off(signal: Signal, piece: Vector, start: float, stop: float) -> bool:
    """Whether the acceleration in the middle of a piece is off by more than round-off."""
    tau = 0.5 * (stop - start)
    there = 2.0 * piece[2] + tau * (6.0 * piece[3] + tau * (12.0 * piece[4] + tau * 20.0 * piece[5]))
    asked = signal.acceleration(start + tau)
    scale = max(abs(asked), abs(2.0 * piece[2]), abs(signal.rate(start + tau)) / tau)
    return bool(abs(there - asked) > ROUNDING * scale)


BEND = 0.1  # of the greatest mean rate of a table: less is how a smooth curve is cut into pieces


def jerks(signal: Signal) -> tuple[float, ...]:
    """Instants (s) at which a signal's second derivative may jump; only tables have any."""
    inner = signal.signal if isinstance(signal, Smoothed) else signal
    return inner.times if isinstance(inner, Piecewise) else ()


def bends(signals: Iterable[Signal]) -> list[float]:
    """Instants (s) at which the mean rates of a table before and after differ by much of its greatest."""
    found: set[float] = set()
    for signal in signals:
        if isinstance(signal, Piecewise):
            values = [signal.value(t) for t in signal.times]
            rates = np.concatenate([[0.0], np.diff(values) / np.diff(signal.times), [0.0]])
            much = np.abs(np.diff(rates)) > BEND * np.abs(rates).max()
            found.update(t for t, bent in zip(signal.times, much, strict=True) if bent)
    return sorted(found)


def period(signal: Signal) -> float | None:
    """Time (s) after which a signal repeats itself, a turn further or not; None of one that does not."""
    if isinstance(signal, Smoothed):
        return period(signal.signal)
    if isinstance(signal, Sine):
        return 2.0 * math.pi / abs(signal.omega) if signal.omega and signal.amplitude else None
    return 1.0 / abs(signal.frequency) if isinstance(signal, Buehler) and signal.frequency else None


def corners(signals: Iterable[Signal]) -> list[float]:
    """Instants (s) between which signals change smoothly: bends of tables, and where ramps begin and end."""
    given = list(signals)
    found = set(bends(given))
    for signal in given:
        if isinstance(signal, Ramp) and signal.first != signal.last:
            found |= {signal.start, signal.start + signal.duration}
    return sorted(found)


def shortest_period(signal: Signal, end: float) -> float:
    """Shortest period (s) of what a signal does before an end (s); infinite of one that does not go to and fro.

    In a table of swings it is the time between the middles of one rise and the next; a pulse alone counts four times
    its width at half of its height: at two steps a period a triangle can then fall between two of them. Of a clock of
    legs it is twice its stance or swing, whichever is shorter, or 16 times the time over which its rate changes.
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
    """Instants (s) at which values (n,) at times (n,) pass the middle between two turns, both far from noise."""
    much, turns, last = BEND * float(np.ptp(values)), [0], 0
    for i in range(1, len(values)):  # the last is the farthest since the last turn, the direction of which is open
        way = np.sign(values[last] - values[turns[-1]])
        if way * (values[i] - values[last]) >= 0.0:
            last = i if way or abs(values[i] - values[last]) > much else last
        elif abs(values[i] - values[last]) > much:
            turns.append(last)
            last = i
    found = []
    for a, b in pairwise([*turns, last]):
        if a == b or values[a] == values[b]:
            continue
        middle, way = 0.5 * (values[a] + values[b]), np.sign(values[b] - values[a])
        k = a + 1 + int(np.argmax(way * (values[a + 1 : b + 1] - middle) >= 0.0))
        share = (middle - values[k - 1]) / (values[k] - values[k - 1])
        found.append(float(times[k - 1] + share * (times[k] - times[k - 1])))
    return found
