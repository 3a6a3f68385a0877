"""When a run first touched its medium and when it stopped, and how it ended, in the same words for every method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from granular_contact.results import Status, StatusCode
from granular_contact.results.interpolation import Track, at_times, first_above_zero
from granular_contact.scene.types import Solver
from granular_contact.values.arrays import Vector

REST_TIME = 0.02  # s at rest, where the run does not say how long


@dataclass(frozen=True)
class Touch:
    """First contact with the surface: time (s), and the last accepted step at or before it (index)."""

    time: float
    index: int


def find_touch(time: Vector, depths: Sequence[Track]) -> Touch | None:
    """First crossing of the surface from depths (m) of points, positive below; None when nothing gets below it."""
    first = first_above_zero(time, depths)
    return None if first is None else touched(time, first)


def touched(time: Vector, when: float) -> Touch:
    """The touch at a time (s), of a run with the accepted steps (n,) s."""
    return Touch(when, int(np.searchsorted(time, when, side="right")) - 1)


@dataclass(frozen=True)
class Stop:
    """Time (s) since the start and angle (rad) there, of what has one; time of the first zero of its own rate."""

    time: float
    angle: float | None
    hub_time: float | None


def find_stop(
    time: Vector, rate: Vector, acceleration: Vector, angle: Vector, angle_rate: Vector, *, hub: bool = True
) -> Stop | None:
    """First zero of `rate`, None if it has none.

    All (n,) over the accepted steps: rate (rad/s) with its derivative acceleration (rad/s2) before each instant, and an
    angle (rad) with its rate, which need not be the same motion (a hub trembles about the mean). hub: whether to look
    for the first zero of that rate, too.
    """
    k = first_reversal(rate)
    if k is None:
        return None
    step = time[k + 1] - time[k]
    jerk = (acceleration[k] - acceleration[k - 1]) / (time[k] - time[k - 1]) if k > 0 else 0.0
    tau = _parabola_root(rate[k], acceleration[k], 0.5 * jerk, step)
    i = first_reversal(angle_rate) if hub else None
    hub_time = None
    if i is not None:
        hub_time = float(time[i]) + _rate_zero(float(time[i + 1] - time[i]), angle[i : i + 2], angle_rate[i : i + 2])
    return Stop(
        time=float(time[k] + tau),
        angle=float(at_times(np.array([0.0, step]), angle[k : k + 2], angle_rate[k : k + 2], np.array([tau]))[0]),
        hub_time=hub_time,
    )


def find_rest(time: Vector, speeds: Vector, touch: int, rest_speed: float, rest_time: float | None) -> float | None:
    """When (s) the speed (n,) m/s of the fastest point last got below the rest speed, after the touch (index).

    None where it did not stay there for the rest time (s).
    """
    moving = np.flatnonzero(speeds > rest_speed)
    last = int(moving[-1]) if len(moving) else -1
    if last < max(touch, 1) or last == len(time) - 1:
        return None
    if time[-1] - time[last + 1] < (1.0 - 1e-6) * (rest_time or REST_TIME):
        return None
    # From the side before: where something stops its speed has a kink.
    step, fast = time[last + 1] - time[last], speeds[last] - rest_speed
    slope = (speeds[last - 1] - speeds[last]) / (time[last] - time[last - 1])
    return float(time[last] + (min(step, fast / slope) if slope > 0.0 else step))


def find_turn(time: Vector, speed: Vector, angle: Vector, rate: Vector) -> float | None:
    """When (s) an upward speed (n,) m/s of what sinks is first zero; None before that. Angle (n,) and rate of the body.

    The derivative is that of the speed itself, looking back only: at the turn the force of the medium jumps.
    """
    if len(time) < 3:
        return None
    slope = np.diff(speed) / np.diff(time)
    before = np.concatenate([slope[:1], slope[:1], slope[1:] + 0.5 * np.diff(slope)])[: len(speed)]
    stop = find_stop(time, speed, before, angle, rate, hub=False)
    return None if stop is None else stop.time


def first_reversal(rate: Vector) -> int | None:
    """Last index before the rate (n,) first reaches zero from the sign it first has."""
    moving = np.flatnonzero(rate)
    if len(moving) == 0:
        return None
    start = int(moving[0])
    over = np.flatnonzero(rate[start:] * np.sign(rate[start]) <= 0.0)
    return None if len(over) == 0 else start + int(over[0]) - 1


def _parabola_root(value: float, slope: float, curvature: float, step: float) -> float:
    """Smallest positive zero of value + slope tau + curvature tau^2, kept within (0, step]."""
    roots = np.roots([curvature, slope, value]) if curvature != 0.0 else np.array([-value / slope if slope else step])
    real = [float(r.real) for r in np.atleast_1d(roots) if abs(r.imag) <= 1e-12 * abs(r) and r.real > 0.0]
    return min([*real, step])


def _rate_zero(step: float, angle: Vector, rate: Vector) -> float:
    """When in a step the rate is zero, of the cubic through the angles (2,) and rates (2,) at its ends."""
    rise = 3.0 * (angle[1] - angle[0]) / step - 2.0 * rate[0] - rate[1]
    bow = rate[0] + rate[1] - 2.0 * (angle[1] - angle[0]) / step
    return step * _parabola_root(float(rate[0]), 2.0 * float(rise), 3.0 * float(bow), 1.0)


def ended(code: StatusCode, reached: float, solver: Solver) -> Status:
    """Status of a run that came to a time (s): at rest, at its end, over its wall time or interrupted."""
    kept = "the results up to there were kept"
    if code == "rest":
        words = f"at rest: slower than {solver.rest_speed_m_s:g} m/s in every coordinate for {solver.rest_time_s:g} s"
    elif code == "time_limit":
        limit = f"solver.max_wall_s ({solver.max_wall_s:g}) is over"
        words = f"stopped at {reached:.6g} s of {solver.end_time_s:g} s: {limit}; {kept}"
    elif code == "interrupted":
        words = f"interrupted at {reached:.6g} s; {kept}"
    else:
        words = f"end time {solver.end_time_s:g} s reached"
    return Status(code, words)


def paused(reached: float, solver: Solver) -> Status:
    """Status of a run that is stepped and stands at a time (s) before its end."""
    return Status("interrupted", f"stopped at {reached:.6g} s of {solver.end_time_s:g} s, from where it can go on")
