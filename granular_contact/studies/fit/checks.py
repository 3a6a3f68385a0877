"""Checks of data and parameters against a first run: lengths, ends, parameters without effect."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from granular_contact.errors import Fault
from granular_contact.results import Results
from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.measurements import Measured, forces
from granular_contact.studies.fit.parameters import Choice
from granular_contact.studies.fit.problem import Problem
from granular_contact.studies.fit.responses import ModelFailed
from granular_contact.values.arrays import Vector

FARTHEST = 10.0  # times what the mechanism reaches: no length of this run
STILL_MOVING = 0.25  # of the greatest speed in the data
MOTION_LEFT = 0.01  # of the range of a column: less is no motion that a parameter could be found from
PROBE = 0.1  # share of the distance between the bounds by which a parameter is moved to see whether it moves anything
# Joints of mechanisms whose flight is the same backwards, and what may be said of such joints.
FREE_JOINTS = {"hinge", "weld"}
JOINT_KEYS = {"type", "parent", "child", "parent_point_m", "child_point_m", "home_deg"}
IMPACT_KEYS = {"impact_angle_deg", "impact_speed_rad_s"}


def against_run(measured: Measured, first: Results, offset: float, latest: float) -> Iterator[Fault]:
    """Faults of data, whose clock is `offset` (s) ahead, `latest` (s) at most, found by a first run."""
    yield from _too_far(measured, first)
    late = list(_too_late(measured, first, latest))
    if late:
        yield from late
        return
    yield from _too_early(measured, first, offset, latest)
    yield from _too_long(measured, first, offset)
    yield from _too_short(measured, first, offset)


def early_by(measured: Measured, latest: float) -> float:
    """How long before the start of the run data begin (s) whose clock may be ahead by `latest` (s)."""
    return max(0.0, latest - float(measured.time[0]))


def _too_late(measured: Measured, first: Results, latest: float) -> Iterator[Fault]:
    """A fault of data that begin when the motion is nearly over, with any offset of the clock."""
    begin = float(measured.time[0]) - latest
    after = first["time_s"] >= begin
    for name in measured.columns:
        motion = first[name]
        left = float(np.ptp(motion[after])) if np.any(after) else 0.0
        if left > MOTION_LEFT * float(np.ptp(motion)):
            return
    words = (
        f"begins {begin:.4g} s after the start of the run at the earliest, when the motion of the model is over: is "
        "the clock shifted (--time-offset, time_offset_s in a fit file) or in another unit?"
    )
    yield Fault(measured.file, measured.lines[0], "", words)


def _too_far(measured: Measured, first: Results) -> Iterator[Fault]:
    """A fault for each column of lengths that the mechanism can't reach."""
    lengths = [first[name] for name in first.names if name.endswith("_m")]  # of any part, along any axis
    reach = float(np.max(np.abs(np.nan_to_num(lengths))))
    for name, values in zip(measured.columns, measured.values.T, strict=True):
        over = np.flatnonzero(np.abs(values) > FARTHEST * reach)
        if len(over) and name.endswith("_m"):
            words = (
                f"got {values[over[0]]:.4g} m, but the mechanism reaches {reach:.3g} m: is it in another unit than its "
                "name says?"
            )
            yield Fault(measured.file, measured.lines[over[0]], name, words)


def _too_early(measured: Measured, first: Results, offset: float, latest: float) -> Iterator[Fault]:
    early, begin = early_by(measured, latest), float(measured.time[0])
    if early > 0.0 and not _reversible(measured, first):
        remedy = "leave these rows out, or let the run start earlier"
        if latest > offset:  # it is to be found
            span = f"{{from: {begin - (latest - offset):.4g}, to: {begin:.4g}}}"
            remedy += f"; or give the offset narrower bounds in a fit file, as time_offset_s: {span}"
        words = (
            f"begins {early:.4g} s before the start of the run (or may, by its offset), where this model can't be "
            f"followed back: {remedy}"
        )
        yield Fault(measured.file, measured.lines[0], "", words)


def _reversible(measured: Measured, first: Results) -> bool:
    """Whether the motion before the start is a conservative free flight above a level surface."""
    scenario = first.scenario
    joints = scenario["model"]["joints"].values()
    free = all(j["type"] in FREE_JOINTS and {k for k, v in j.items() if v} <= JOINT_KEYS for j in joints)
    lossy = any(_damped(body) for body in scenario["model"]["bodies"].values())
    sloped = bool(scenario.get("bed")) and "depth_m" in measured.columns
    turning = {k for k, v in scenario["initial"].items() if v} <= IMPACT_KEYS and not scenario.get("drives")
    touches = not scenario["medium"] or first["depth_m"][0] <= 1e-9
    return free and turning and touches and not lossy and not sloped


def _damped(body: dict[str, Any]) -> bool:
    flexible = body.get("flexible") or {}
    return any(value for key, value in flexible.items() if "damping" in key)


def _too_long(measured: Measured, first: Results, offset: float) -> Iterator[Fault]:
    end, last = float(first["time_s"][-1]), float(measured.time[-1]) - offset
    if first.status.code != "rest" and last > end + 1e-9:
        words = (
            f"ends {last:.4g} s after the start, but the run at {end:.4g} s: raise solver.end_time_s, or cut the data"
        )
        yield Fault(measured.file, measured.lines[-1], "", words)


def _too_short(measured: Measured, first: Results, offset: float) -> Iterator[Fault]:
    """Data that end while the link still moves, before the model says that it stops."""
    stop, touch = first.summary["stopping_time_s"], first.summary["touch_time_s"]
    last = float(measured.time[-1]) - offset
    if stop is None or touch is None or last >= touch + stop:
        return
    for name, values in zip(measured.columns, measured.values.T, strict=True):
        moving = _moving_at_the_end(measured.time, values)
        if moving is not None and name != "deflection_m" and not forces([name]):
            words = (
                f"ends {last:.4g} s after the start, when {name} still moves at {100 * moving:.0f} % of its greatest "
                f"speed: shorter than the impact, which takes about {touch + stop:.3g} s; record until it stands still"
            )
            yield Fault(measured.file, measured.lines[-1], "", words)
            return


def _moving_at_the_end(time: Vector, values: Vector) -> float | None:
    """Speed over the last rows as a share of the greatest, where it is neither small nor noise; else None."""
    count = max(4, len(time) // 10)
    spans = [slice(i, i + count) for i in range(0, len(time) - count + 1)]
    slopes = np.array([np.polyfit(time[s] - time[s][0], values[s], 1)[0] for s in spans])
    error = (diagnostics.roughness(values) or 0.0) / (float(np.std(time[spans[-1]])) * np.sqrt(count))
    share = abs(slopes[-1]) / max(float(np.max(np.abs(slopes))), 1e-300)
    return float(share) if share > STILL_MOVING and abs(slopes[-1]) > 4.0 * error else None


def unused(problem: Problem, choices: Sequence[Choice]) -> Iterator[Fault]:
    """Parameters that no column of any run depends on."""
    floors = diagnostics.floors(problem)[problem.column_of()]
    times = problem.times()
    at = problem.model(problem.start, times)
    for j, choice in enumerate(choices):
        if not any(_moves(problem, j, side, at, times, floors) for side in (1.0, -1.0)):
            columns = ", ".join(problem.columns)
            words = f"has no effect on any of {columns} in any run, so these data can't determine it; leave it out"
            yield choice.request.position.fault((choice.parameter.label,), words)


def _moves(problem: Problem, j: int, side: float, at: Vector, times: list[Vector], floors: Vector) -> bool:
    low, high = (bound[j] for bound in problem.bounds)
    point = problem.start
    point[j] = np.clip(point[j] + side * PROBE * (high - low), low, high)
    try:
        return bool(np.any(np.abs(problem.model(point, times) - at) > floors))
    except ModelFailed:
        return True  # it matters, if only by stopping the run
