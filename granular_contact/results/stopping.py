"""First touch of the medium, stop, and status at the end of a run, the same for every engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from granular_contact.results import Status, StatusCode
from granular_contact.results.interpolation import Track, at_times, first_above_zero
from granular_contact.scene.types import Solver
from granular_contact.values.arrays import Vector

REST_TIME = 0.02  # s: how long a mechanism has to be at rest, if the solver settings give no rest time


@dataclass(frozen=True)
class Touch:
    """First contact with the surface: time (s), and index of the last accepted step at or before it."""

    time: float
    index: int


def find_touch(time: Vector, depths: Sequence[Track]) -> Touch | None:
    """Find the first touch from depths (m) of points, positive below the surface; None if no point gets below it."""
    first = first_above_zero(time, depths)
    return None if first is None else touched(time, first)


def touched(time: Vector, when: float) -> Touch:
    """Return the touch at the time `when` (s) in a run with accepted steps at `time` (n,) s."""
    return Touch(when, int(np.searchsorted(time, when, side="right")) - 1)


@dataclass(frozen=True)
class Stop:
    """Stop of a mechanism.

    time: since the start (s). angle: at the stop (rad), None without one. hub_time: of the first zero of the rate of
    this angle (s), None if it has no zero.
    """

    time: float
    angle: float | None
    hub_time: float | None


def find_stop(
    time: Vector, rate: Vector, acceleration: Vector, angle: Vector, angle_rate: Vector, *, hub: bool = True
) -> Stop | None:
    """Find the stop: the first zero of `rate`; None if it has no zero.

    All arrays are (n,) over the accepted steps. rate (rad/s), with its left-sided derivative acceleration (rad/s2), is
    the mean rate of the mechanism. angle (rad) and angle_rate are those of the hub, which vibrates about the mean
    motion. hub: whether to find the first zero of angle_rate as well.
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
    """Time (s) from which on the speed (n,) m/s of the fastest point stays below the rest speed; touch: index.

    None if this is before the touch, or if the speed did not stay below it for the rest time (s).
    """
    moving = np.flatnonzero(speeds > rest_speed)
    last = int(moving[-1]) if len(moving) else -1
    if last < max(touch, 1) or last == len(time) - 1:
        return None
    if time[-1] - time[last + 1] < (1.0 - 1e-6) * (rest_time or REST_TIME):
        return None
    # Extrapolated from the steps before, because the speed has a kink where a body stops.
    step, excess = time[last + 1] - time[last], speeds[last] - rest_speed
    slope = (speeds[last - 1] - speeds[last]) / (time[last] - time[last - 1])
    return float(time[last] + (min(step, excess / slope) if slope > 0.0 else step))


def find_turn(time: Vector, speed: Vector, angle: Vector, rate: Vector) -> float | None:
    """Time (s) of the first zero of the upward speed (n,) m/s of a sinking body; None if there is no zero.

    angle, rate: (n,), of the body. The derivative of the speed is taken from earlier steps alone, because the force of
    the medium jumps where the body turns round.
    """
    if len(time) < 3:
        return None
    slope = np.diff(speed) / np.diff(time)
    left_sided = np.concatenate([slope[:1], slope[:1], slope[1:] + 0.5 * np.diff(slope)])[: len(speed)]
    stop = find_stop(time, speed, left_sided, angle, rate, hub=False)
    return None if stop is None else stop.time


def first_reversal(rate: Vector) -> int | None:
    """Last index before the rate (n,) first becomes zero or changes its initial sign; None if it never does."""
    moving = np.flatnonzero(rate)
    if len(moving) == 0:
        return None
    start = int(moving[0])
    reversed_at = np.flatnonzero(rate[start:] * np.sign(rate[start]) <= 0.0)
    return None if len(reversed_at) == 0 else start + int(reversed_at[0]) - 1


def _parabola_root(value: float, slope: float, curvature: float, step: float) -> float:
    """Smallest positive zero of value + slope tau + curvature tau^2, at most `step`."""
    roots = np.roots([curvature, slope, value]) if curvature != 0.0 else np.array([-value / slope if slope else step])
    real = [float(root.real) for root in np.atleast_1d(roots) if abs(root.imag) <= 1e-12 * abs(root) and root.real > 0]
    return min([*real, step])


def _rate_zero(step: float, angle: Vector, rate: Vector) -> float:
    """Time within a step at which the Hermite cubic through angles (2,) and rates (2,) at its ends has rate zero."""
    rise = 3.0 * (angle[1] - angle[0]) / step - 2.0 * rate[0] - rate[1]
    bow = rate[0] + rate[1] - 2.0 * (angle[1] - angle[0]) / step
    return step * _parabola_root(float(rate[0]), 2.0 * float(rise), 3.0 * float(bow), 1.0)


def ended(code: StatusCode, reached: float, solver: Solver) -> Status:
    """Status of a run that ended at a simulated time (s): at rest, at its end, at its wall time or interrupted."""
    kept = "the results up to there were kept"
    if code == "rest":
        message = f"at rest: slower than {solver.rest_speed_m_s:g} m/s in every coordinate for {solver.rest_time_s:g} s"
    elif code == "time_limit":
        limit = f"the limit of wall time, solver.max_wall_s ({solver.max_wall_s:g}), was reached"
        message = f"stopped at {reached:.6g} s of {solver.end_time_s:g} s: {limit}; {kept}"
    elif code == "interrupted":
        message = f"interrupted at {reached:.6g} s; {kept}"
    else:
        message = f"end time {solver.end_time_s:g} s reached"
    return Status(code, message)


def paused(reached: float, solver: Solver) -> Status:
    """Status of a run in steps that is paused at a time (s) before its end."""
    return Status("interrupted", f"stopped at {reached:.6g} s of {solver.end_time_s:g} s, from where it can go on")
