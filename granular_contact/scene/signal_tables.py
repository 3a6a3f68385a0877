"""Signals of drives -> the tables that kernels look them up in, see `mechanics.kernels.signal_tables`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from granular_contact.scene.signals import Signal, jerks, period
from granular_contact.scene.types import Vector

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
