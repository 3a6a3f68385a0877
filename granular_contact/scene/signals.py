"""Signals of drives over time: value, rate and acceleration, in SI units.

Each is a frozen record with three methods of the time (s). While a mechanism settles, at t < 0, engines ask for t = 0.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

ROUNDING = 1e-4  # of the greatest rate: smaller jumps of the rate come from rounding in a table


class Signal(Protocol):
    """Signal of a drive: a value (rad, m, N m, N, rad/s or m/s) with two derivatives with respect to time."""

    def value(self, t: float) -> float:
        """Value at t (s)."""

    def rate(self, t: float) -> float:
        """First derivative with respect to time."""

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time."""


@dataclass(frozen=True)
class Constant:
    """Constant value (level)."""

    level: float

    def value(self, t: float) -> float:  # noqa: ARG002
        """The level."""
        return self.level

    def rate(self, t: float) -> float:  # noqa: ARG002
        """Zero."""
        return 0.0

    def acceleration(self, t: float) -> float:  # noqa: ARG002
        """Zero."""
        return 0.0


@dataclass(frozen=True)
class Sine:
    """offset + amplitude sin(omega t + phase); omega rad/s, phase rad."""

    amplitude: float
    omega: float
    phase: float
    offset: float

    def value(self, t: float) -> float:
        """Value at t (s)."""
        return self.offset + self.amplitude * math.sin(self.omega * t + self.phase)

    def rate(self, t: float) -> float:
        """First derivative with respect to time."""
        return self.amplitude * self.omega * math.cos(self.omega * t + self.phase)

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time."""
        return -self.amplitude * self.omega**2 * math.sin(self.omega * t + self.phase)


@dataclass(frozen=True)
class Ramp:
    """Ramp between two levels by 10 x^3 - 15 x^4 + 6 x^5, x from 0 to 1 over the duration.

    This is the polynomial of least degree with zero rate and zero acceleration at both ends. start, duration: s.
    """

    first: float
    last: float
    start: float
    duration: float

    def _share(self, t: float) -> float:
        return min(max((t - self.start) / self.duration, 0.0), 1.0)

    def value(self, t: float) -> float:
        """Value at t (s)."""
        x = self._share(t)
        return self.first + (self.last - self.first) * x**3 * (10.0 - 15.0 * x + 6.0 * x**2)

    def rate(self, t: float) -> float:
        """First derivative with respect to time."""
        x = self._share(t)
        return (self.last - self.first) * 30.0 * x**2 * (1.0 - x) ** 2 / self.duration

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time."""
        x = self._share(t)
        return (self.last - self.first) * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / self.duration**2


@dataclass(frozen=True)
class Buehler:
    """Clock of a rotary leg (Saranli, Buehler, Koditschek 2001) with a smooth transition between its two rates.

    frequency: turns per s; sweep: angle of the stance (rad); offset: angle in the middle of the stance (rad), at phase
    0; duty: duration of the stance over the period; phase: in turns; blend: duration of a transition between the rates
    over the period. A transition is centred at the instant at which the clock without transitions has a kink.
    """

    frequency: float
    sweep: float
    offset: float
    duty: float
    phase: float
    blend: float

    def _place(self, t: float) -> tuple[float, float]:
        """Number of whole turns, and time from the middle of the stance over the period, between -1/2 and 1/2."""
        periods = self.frequency * t + self.phase
        turns = math.floor(periods + 0.5)
        return turns, periods - turns

    def _slopes(self) -> tuple[float, float]:
        """Angle per period (rad) at the rates of the stance and of the swing."""
        return self.sweep / self.duty, (2.0 * math.pi - self.sweep) / (1.0 - self.duty)

    def _blending(self, x: float) -> float:
        """Progress (0 to 1) of the transition from stance to swing at x, the time from mid-stance over the period."""
        return min(max((x - 0.5 * self.duty) / self.blend + 0.5, 0.0), 1.0)

    def value(self, t: float) -> float:
        """Angle (rad) at t (s), not wrapped at full turns."""
        turns, share = self._place(t)
        slow, fast = self._slopes()
        x = abs(share)
        # Integral of the rate slow + (fast - slow) b^2 (3 - 2 b), b from 0 to 1 over the blend and 1 after it.
        b = self._blending(x)
        after = max(x - 0.5 * (self.duty + self.blend), 0.0)
        angle = slow * x + (fast - slow) * (self.blend * b**3 * (1.0 - 0.5 * b) + after)
        return self.offset + 2.0 * math.pi * turns + math.copysign(angle, share)

    def rate(self, t: float) -> float:
        """First derivative with respect to time."""
        slow, fast = self._slopes()
        b = self._blending(abs(self._place(t)[1]))
        return self.frequency * (slow + (fast - slow) * b**2 * (3.0 - 2.0 * b))

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time."""
        share = self._place(t)[1]
        b = self._blending(abs(share))
        if b in (0.0, 1.0):  # outside a transition
            return 0.0
        slow, fast = self._slopes()
        return self.frequency**2 * (fast - slow) * math.copysign(6.0 * b * (1.0 - b) / self.blend, share)


@dataclass(frozen=True)
class Piecewise:
    """Piecewise cubic polynomial: from times[i] on, with coefficients[i] in powers of the time since times[i].

    times (n,) s, increasing; coefficients (n - 1, 4), lowest power first. The value is constant outside. Where a
    derivative jumps, it has its value after the jump.
    """

    times: tuple[float, ...]
    coefficients: tuple[tuple[float, float, float, float], ...]

    def _piece(self, t: float) -> tuple[tuple[float, float, float, float], float, bool]:
        inside = self.times[0] <= t < self.times[-1]
        t = min(max(t, self.times[0]), self.times[-1])
        i = min(bisect_right(self.times, t), len(self.times) - 1) - 1
        return self.coefficients[i], t - self.times[i], inside

    def value(self, t: float) -> float:
        """Value at t (s)."""
        (a, b, c, d), tau, _ = self._piece(t)
        return a + tau * (b + tau * (c + tau * d))

    def rate(self, t: float) -> float:
        """First derivative with respect to time; zero outside the table."""
        (_, b, c, d), tau, inside = self._piece(t)
        return b + tau * (2.0 * c + tau * 3.0 * d) if inside else 0.0

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time; zero outside the table."""
        (_, _, c, d), tau, inside = self._piece(t)
        return 2.0 * c + 6.0 * d * tau if inside else 0.0


class Jump(NamedTuple):
    """Instant (s) at which the rate of a signal jumps, and the rates before and after it."""

    time: float
    before: float
    after: float


def jumps(signal: Signal) -> tuple[Jump, ...]:
    """All jumps of a signal's rate that are larger than rounding in a table; only tables have jumps."""
    if not isinstance(signal, Piecewise):
        return ()
    steps = np.diff(signal.times)
    a, b, c, d = np.array(signal.coefficients).T
    before = np.concatenate([[0.0], b + steps * (2.0 * c + steps * 3.0 * d)])
    after = np.concatenate([b, [0.0]])
    changes = np.diff([*a, signal.value(signal.times[-1])])  # of values, as cubics may have zero rates at all knots
    least = ROUNDING * max(np.abs(before).max(), np.abs(after).max(), np.abs(changes / steps).max())
    at_knots = [Jump(*knot) for knot in zip(signal.times, before.tolist(), after.tolist(), strict=True)]
    return tuple(jump for jump in at_knots if abs(jump.after - jump.before) > least)


@dataclass(frozen=True)
class Smoothed:
    """Signal with smoothed jumps of its rate: by b^2 (3 - 2 b), with b from 0 to 1 over `duration` (s) around a jump.

    Rate and acceleration are continuous. The signal is unchanged at instants that are farther than half the duration
    from all jumps. jumps: in the order of time.
    """

    signal: Signal
    jumps: tuple[Jump, ...]
    duration: float

    def _near(self, t: float) -> list[tuple[float, float, float]]:
        """Height, b, and time since the jump (s), for all jumps within half the duration of t."""
        first = bisect_right(self.jumps, t - 0.5 * self.duration, key=lambda jump: jump.time)
        last = bisect_right(self.jumps, t + 0.5 * self.duration, key=lambda jump: jump.time)
        return [
            (jump.after - jump.before, (t - jump.time) / self.duration + 0.5, t - jump.time)
            for jump in self.jumps[first:last]
        ]

    def value(self, t: float) -> float:
        """Value at t (s)."""
        change = sum(h * (self.duration * b**3 * (1.0 - 0.5 * b) - max(since, 0.0)) for h, b, since in self._near(t))
        return self.signal.value(t) + change

    def rate(self, t: float) -> float:
        """First derivative with respect to time."""
        change = sum(h * (b**2 * (3.0 - 2.0 * b) - (since >= 0.0)) for h, b, since in self._near(t))
        return self.signal.rate(t) + change

    def acceleration(self, t: float) -> float:
        """Second derivative with respect to time."""
        return self.signal.acceleration(t) + sum(h * 6.0 * b * (1.0 - b) / self.duration for h, b, _ in self._near(t))


def piecewise(times: NDArray[np.float64], values: NDArray[np.float64], cubic: bool) -> Piecewise:
    """Interpolate values (n,) at times (n,) s, linearly or by monotone cubics.

    The cubics have the slopes of Fritsch and Butland (`scipy`'s PCHIP) inside, and zero slope at both ends, as the
    signal is constant outside.
    """
    step = np.diff(times)
    secant = np.diff(values) / step
    if not cubic:
        table = np.column_stack([values[:-1], secant, 0.0 * secant, 0.0 * secant])
        return Piecewise(tuple(times.tolist()), tuple(map(tuple, table.tolist())))
    slope = np.zeros_like(values)
    monotone = secant[1:] * secant[:-1] > 0.0
    w1, w2 = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        slope[1:-1] = np.where(monotone, (w1 + w2) / (w1 / secant[:-1] + w2 / secant[1:]), 0.0)
    c = (3.0 * secant - 2.0 * slope[:-1] - slope[1:]) / step
    d = (slope[:-1] + slope[1:] - 2.0 * secant) / step**2
    table = np.column_stack([values[:-1], slope[:-1], c, d])
    return Piecewise(tuple(times.tolist()), tuple(map(tuple, table.tolist())))
