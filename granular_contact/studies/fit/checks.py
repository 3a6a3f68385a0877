"""Checks of data and parameters against a first run: sizes, begin and end of the data, parameters without effect."""

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

FARTHEST = 10.0  # greatest plausible length in the data, relative to the reach of the mechanism
STILL_MOVING = 0.25  # of the greatest speed in the data; above it the data end during the motion
MOTION_LEFT = 0.01  # of the range of a column; a smaller motion after the begin of the data determines no parameter
PROBE = 0.1  # change of a parameter, relative to its range, that shows whether it has any effect
# Joints whose free flight is reversible in time, and the keys that such joints may have.
FREE_JOINTS = {"hinge", "weld"}
JOINT_KEYS = {"type", "parent", "child", "parent_point_m", "child_point_m", "home_deg"}
IMPACT_KEYS = {"impact_angle_deg", "impact_speed_rad_s"}


def faults_against_run(measured: Measured, first: Results, offset: float, latest: float) -> Iterator[Fault]:
    """Faults of data compared with a first run; their clock is ahead by `offset` (s), and at most by `latest` (s)."""
    yield from _too_far(measured, first)
    late = list(_too_late(measured, first, latest))
    if late:
        yield from late
        return
    yield from _too_early(measured, first, offset, latest)
    yield from _too_long(measured, first, offset)
    yield from _too_short(measured, first, offset)


def time_before_start(measured: Measured, latest: float) -> float:
    """Time (s) by which data can begin before the start of the run, if their clock is ahead by up to `latest` (s)."""
    return max(0.0, latest - float(measured.time[0]))


def _too_late(measured: Measured, first: Results, latest: float) -> Iterator[Fault]:
    """Fault of data that begin when the motion is nearly over, whatever the offset of the clock."""
    begin = float(measured.time[0]) - latest
    after = first["time_s"] >= begin
    for name in measured.columns:
        motion = first[name]
        left = float(np.ptp(motion[after])) if np.any(after) else 0.0
        if left > MOTION_LEFT * float(np.ptp(motion)):
            return
    fault = (
        f"begins {begin:.4g} s after the start of the run at the earliest, when the motion of the model is over: is "
        "the clock shifted (--time-offset, time_offset_s in a fit file) or in another unit?"
    )
    yield Fault(measured.file, measured.lines[0], "", fault)


def _too_far(measured: Measured, first: Results) -> Iterator[Fault]:
    """Fault for each column of lengths with values that the mechanism cannot reach."""
    lengths = [first[name] for name in first.names if name.endswith("_m")]  # of all parts, along all axes
    reach = float(np.max(np.abs(np.nan_to_num(lengths))))
    for name, values in zip(measured.columns, measured.values.T, strict=True):
        too_far = np.flatnonzero(np.abs(values) > FARTHEST * reach)
        if len(too_far) and name.endswith("_m"):
            fault = (
                f"got {values[too_far[0]]:.4g} m, but the mechanism reaches {reach:.3g} m: is it in another unit than "
                "its name says?"
            )
            yield Fault(measured.file, measured.lines[too_far[0]], name, fault)


def _too_early(measured: Measured, first: Results, offset: float, latest: float) -> Iterator[Fault]:
    """Fault of data that begin before the start of a run whose motion cannot be computed backwards."""
    early, begin = time_before_start(measured, latest), float(measured.time[0])
    if early > 0.0 and not _reversible(measured, first):
        remedy = "leave these rows out, or let the run start earlier"
        if latest > offset:  # the offset is fitted
            bounds = f"{{from: {begin - (latest - offset):.4g}, to: {begin:.4g}}}"
            remedy += f"; or give the offset narrower bounds in a fit file, as time_offset_s: {bounds}"
        fault = (
            f"begins {early:.4g} s before the start of the run (or can, by its offset), and the motion of this model "
            f"can't be computed backwards: {remedy}"
        )
        yield Fault(measured.file, measured.lines[0], "", fault)


def _reversible(measured: Measured, first: Results) -> bool:
    """Return whether the motion before the start is a conservative free flight above a level surface."""
    scenario = first.scenario
    joints = scenario["model"]["joints"].values()
    is_free = all(
        joint["type"] in FREE_JOINTS and {key for key, value in joint.items() if value} <= JOINT_KEYS
        for joint in joints
    )
    is_damped = any(_damped(body) for body in scenario["model"]["bodies"].values())
    is_sloped = bool(scenario.get("bed")) and "depth_m" in measured.columns
    initial = {key for key, value in scenario["initial"].items() if value}
    is_swing = initial <= IMPACT_KEYS and not scenario.get("drives")
    starts_above = not scenario["medium"] or first["depth_m"][0] <= 1e-9
    return is_free and is_swing and starts_above and not is_damped and not is_sloped


def _damped(body: dict[str, Any]) -> bool:
    flexible = body.get("flexible") or {}
    return any(value for key, value in flexible.items() if "damping" in key)


def _too_long(measured: Measured, first: Results, offset: float) -> Iterator[Fault]:
    end, last = float(first["time_s"][-1]), float(measured.time[-1]) - offset
    if first.status.code != "rest" and last > end + 1e-9:
        fault = (
            f"ends {last:.4g} s after the start, but the run ends at {end:.4g} s: raise solver.end_time_s, or cut the "
            "data"
        )
        yield Fault(measured.file, measured.lines[-1], "", fault)


def _too_short(measured: Measured, first: Results, offset: float) -> Iterator[Fault]:
    """Fault of data that end while the mechanism still moves, before the stop of the model."""
    stop, touch = first.summary["stopping_time_s"], first.summary["touch_time_s"]
    last = float(measured.time[-1]) - offset
    if stop is None or touch is None or last >= touch + stop:
        return
    for name, values in zip(measured.columns, measured.values.T, strict=True):
        speed = _speed_at_the_end(measured.time, values)
        if speed is not None and name != "deflection_m" and not forces([name]):
            fault = (
                f"ends {last:.4g} s after the start, when {name} still moves at {100 * speed:.0f} % of its greatest "
                f"speed: the data are shorter than the impact, which takes about {touch + stop:.3g} s; record until "
                "the motion stops"
            )
            yield Fault(measured.file, measured.lines[-1], "", fault)
            return


def _speed_at_the_end(time: Vector, values: Vector) -> float | None:
    """Speed over the last rows, relative to the greatest speed; None if it is small or could be noise."""
    count = max(4, len(time) // 10)
    spans = [slice(i, i + count) for i in range(0, len(time) - count + 1)]
    slopes = np.array([np.polyfit(time[span] - time[span][0], values[span], 1)[0] for span in spans])
    error = (diagnostics.roughness(values) or 0.0) / (float(np.std(time[spans[-1]])) * np.sqrt(count))
    share = abs(slopes[-1]) / max(float(np.max(np.abs(slopes))), 1e-300)
    return float(share) if share > STILL_MOVING and abs(slopes[-1]) > 4.0 * error else None


def without_effect(problem: Problem, choices: Sequence[Choice]) -> Iterator[Fault]:
    """Faults of parameters on which no column of any run depends."""
    floors = diagnostics.floors(problem)[problem.column_indices()]
    times = problem.times()
    at_start = problem.model(problem.start, times)
    for j, choice in enumerate(choices):
        if not any(_has_effect(problem, j, side, at_start, times, floors) for side in (1.0, -1.0)):
            columns = ", ".join(problem.columns)
            fault = f"has no effect on any of {columns} in any run, so these data can't determine it; leave it out"
            yield choice.request.position.fault((choice.parameter.label,), fault)


def _has_effect(problem: Problem, j: int, side: float, at_start: Vector, times: list[Vector], floors: Vector) -> bool:
    """Return whether a change of parameter j changes any model value by more than the error of the computation."""
    low, high = (bound[j] for bound in problem.bounds)
    point = problem.start
    point[j] = np.clip(point[j] + side * PROBE * (high - low), low, high)
    try:
        return bool(np.any(np.abs(problem.model(point, times) - at_start) > floors))
    except ModelFailed:
        return True  # the parameter decides whether the run succeeds
