"""Signals over time: value, rate and acceleration of what a drive follows, in SI units.

Each is a frozen record with three methods of the time (s); before t = 0 they keep their value at t = 0, for a mechanism
that settles.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

ROUNDING = 1e-4  # of the greatest rate: a jump of less comes of the digits of a table


class Signal(Protocol):
    """What a drive follows: a value (rad, m, N m, N, rad/s or m/s) that has two derivatives by time."""

    def value(self, t: float) -> float:
        """Value at t (s)."""

    def rate(self, t: float) -> float:
        """First derivative by time."""

    def acceleration(self, t: float) -> float:
        """Second derivative by time."""


@dataclass(frozen=True)
class Constant:
    """The same at all times."""

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
        """First derivative by time."""
        return self.amplitude * self.omega * math.cos(self.omega * t + self.phase)

    def acceleration(self, t: float) -> float:
        """Second derivative by time."""
        return -self.amplitude * self.omega**2 * math.sin(self.omega * t + self.phase)


@dataclass(frozen=True)
class Ramp:
    """From one level to another by 10 x^3 - 15 x^4 + 6 x^5, the least polynomial that starts and ends at rest."""

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
        """First derivative by time."""
        x = self._share(t)
        return (self.last - self.first) * 30.0 * x**2 * (1.0 - x) ** 2 / self.duration

    def acceleration(self, t: float) -> float:
        """Second derivative by time."""
        x = self._share(t)
        return (self.last - self.first) * 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / self.duration**2


@dataclass(frozen=True)
class Buehler:
    """Clock of a rotary leg (Saranli, Buehler, Koditschek 2001) with a smooth change between its two rates.

    frequency: turns per s; sweep: angle of the stance (rad); offset: angle in the middle of it (rad), at phase 0; duty:
    share of the turn's time that the stance takes; phase: in turns; blend: share of the turn's time in which one rate
    goes over into the other, half of it on either side of the instant at which the unblended clock has its kink.
    """

    frequency: float
    sweep: float
    offset: float
    duty: float
    phase: float
    blend: float

    def _place(self, t: float) -> tuple[float, float]:
        """Whole turns so far, and the share of a turn's time since the middle of the stance, within -1/2 and 1/2."""
        share = self.frequency * t + self.phase
        turns = math.floor(share + 0.5)
        return turns, share - turns

    def _slopes(self) -> tuple[float, float]:
        """Angle per turn's time (rad) in the stance and in the swing."""
        return self.sweep / self.duty, (2.0 * math.pi - self.sweep) / (1.0 - self.duty)

    def _blending(self, x: float) -> float:
        """How far (0 to 1) the rate has gone over from stance to swing, at |share| x."""
        return min(max((x - 0.5 * self.duty) / self.blend + 0.5, 0.0), 1.0)

    def value(self, t: float) -> float:
        """Angle (rad) at t (s); it never jumps back."""
        turns, share = self._place(t)
        slow, fast = self._slopes()
        x = abs(share)
        # Integral of the rate slow + (fast - slow) b^2 (3 - 2 b), b from 0 to 1 over the blend and 1 after it.
        b = self._blending(x)
        after = max(x - 0.5 * (self.duty + self.blend), 0.0)
        turned = slow * x + (fast - slow) * (self.blend * b**3 * (1.0 - 0.5 * b) + after)
        return self.offset + 2.0 * math.pi * turns + math.copysign(turned, share)

    def rate(self, t: float) -> float:
        """First derivative by time."""
        slow, fast = self._slopes()
        b = self._blending(abs(self._place(t)[1]))
        return self.frequency * (slow + (fast - slow) * b**2 * (3.0 - 2.0 * b))

    def acceleration(self, t: float) -> float:
        """Second derivative by time."""
        share = self._place(t)[1]
        b = self._blending(abs(share))
        if b in (0.0, 1.0):  # as it mostly is
            return 0.0
        slow, fast = self._slopes()
        return self.frequency**2 * (fast - slow) * math.copysign(6.0 * b * (1.0 - b) / self.blend, share)


@dataclass(frozen=True)
class Piecewise:
    """Cubic pieces: over the interval that begins at times[i], the polynomial coefficients[i] of the time since then.

    times (n,) s, increasing; coefficients (n - 1, 4), lowest power first; constant outside. Where derivatives jump they
    are those after it.
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
        """First derivative by time; zero outside the table."""
        (_, b, c, d), tau, inside = self._piece(t)
        return b + tau * (2.0 * c + tau * 3.0 * d) if inside else 0.0

    def acceleration(self, t: float) -> float:
        """Second derivative by time; zero outside the table."""
        (_, _, c, d), tau, inside = self._piece(t)
        return 2.0 * c + 6.0 * d * tau if inside else 0.0


class Jump(NamedTuple):
    """Instant (s) at which the rate of a signal jumps, and the rates before and after it."""

    time: float
    before: float
    after: float


def jumps(signal: Signal) -> tuple[Jump, ...]:
    """All jumps of a signal's rate beyond those from the rounding of a table; only tables have any."""
    if not isinstance(signal, Piecewise):
        return ()
    steps = np.diff(signal.times)
    a, b, c, d = np.array(signal.coefficients).T
    before = np.concatenate([[0.0], b + steps * (2.0 * c + steps * 3.0 * d)])
    after = np.concatenate([b, [0.0]])
    changes = np.diff([*a, signal.value(signal.times[-1])])  # cubics may be at rest at every instant of the table
    least = ROUNDING * max(np.abs(before).max(), np.abs(after).max(), np.abs(changes / steps).max())
    found = zip(signal.times, before.tolist(), after.tolist(), strict=True)
    return tuple(Jump(*one) for one in found if abs(one[2] - one[1]) > least)


@dataclass(frozen=True)
class Smoothed:
    """A signal whose rate changes by b^2 (3 - 2 b) over every jump, b from 0 to 1 in `duration` (s) around it.

    Acceleration and rate are continuous; away from the jumps by half the duration the signal is as it was. jumps: in
    the order of time.
    """

    signal: Signal
    jumps: tuple[Jump, ...]
    duration: float

    def _near(self, t: float) -> list[tuple[float, float, float]]:
        """Of the jumps that t is near: their height, b, and the time since them (s)."""
        first = bisect_right(self.jumps, t - 0.5 * self.duration, key=lambda jump: jump.time)
        last = bisect_right(self.jumps, t + 0.5 * self.duration, key=lambda jump: jump.time)
        near = self.jumps[first:last]
        return [(j.after - j.before, (t - j.time) / self.duration + 0.5, t - j.time) for j in near]

    def value(self, t: float) -> float:
        """Value at t (s)."""
        rounded = sum(h * (self.duration * b**3 * (1.0 - 0.5 * b) - max(since, 0.0)) for h, b, since in self._near(t))
        return self.signal.value(t) + rounded

    def rate(self, t: float) -> float:
        """First derivative by time."""
        rounded = sum(h * (b**2 * (3.0 - 2.0 * b) - (since >= 0.0)) for h, b, since in self._near(t))
        return self.signal.rate(t) + rounded

    def acceleration(self, t: float) -> float:
        """Second derivative by time."""
        return self.signal.acceleration(t) + sum(h * 6.0 * b * (1.0 - b) / self.duration for h, b, _ in self._near(t))


def piecewise(times: NDArray[np.float64], values: NDArray[np.float64], cubic: bool) -> Piecewise:
    """Signal through values (n,) at times (n,) s, by straight lines or by cubics that do not overshoot.

    The cubics have the slopes of Fritsch and Butland (`scipy`'s PCHIP) inside, and are at rest at both ends, where the
    signal stays.
    """
    step = np.diff(times)
    secant = np.diff(values) / step
    if not cubic:
        table = np.column_stack([values[:-1], secant, 0.0 * secant, 0.0 * secant])
        return Piecewise(tuple(times.tolist()), tuple(map(tuple, table.tolist())))
    slope = np.zeros_like(values)
    same = secant[1:] * secant[:-1] > 0.0
    w1, w2 = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        slope[1:-1] = np.where(same, (w1 + w2) / (w1 / secant[:-1] + w2 / secant[1:]), 0.0)
    c = (3.0 * secant - 2.0 * slope[:-1] - slope[1:]) / step
    d = (slope[:-1] + slope[1:] - 2.0 * secant) / step**2
    table = np.column_stack([values[:-1], slope[:-1], c, d])
    return Piecewise(tuple(times.tolist()), tuple(map(tuple, table.tolist())))
