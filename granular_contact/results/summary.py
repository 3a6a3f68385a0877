"""Key numbers of a run for summary.json, from its time series, the same for every engine.

A model with drives also has key numbers of each drive over the run, and means over whole strides with their scatter.
"""

from __future__ import annotations

import math
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from granular_contact import __version__
from granular_contact.results import REST_MEASURE, STOP_MEASURE, Cost, Status
from granular_contact.results.interpolation import Track, greatest, positive_part, squared
from granular_contact.results.stopping import Stop, Touch
from granular_contact.scene.types import Scene, Vector


@dataclass(frozen=True)
class Extremes:
    """Greatest depth (m, negative above the surface) and deflection (m, with sign), each with its time (s)."""

    depth: tuple[float, float] | None
    deflection: tuple[float, float] | None


def extremes(time: Vector, depths: Sequence[Track], bend: Track | None) -> Extremes:
    """Find the greatest depth of points and the greatest deflection of a link (n,), between steps too."""
    depth, deflection = (greatest(time, depths) if depths else None), None
    if bend is not None:
        opposite = Track(-bend.values, -bend.rates)
        (high, high_time), (low, low_time) = greatest(time, [bend]), greatest(time, [opposite])
        deflection = (high, high_time) if high >= low else (-low, low_time)
    return Extremes(depth, deflection)


def summarise(
    scene: Scene,
    status: Status,
    cost: Cost,
    energies: dict[str, float],
    touch: Touch | None,
    stop: Stop | None,
    extremes: Extremes,
) -> dict[str, Any]:
    """Key numbers of a run, with an empty list of warnings; energies: from `energy.key_numbers`.

    The choice of steps changes these numbers by no more than the error of the steps: times and extremes are found
    between steps (see `interpolation`), and works are integrals over time.
    """
    depth, deflection = extremes.depth, extremes.deflection
    touched = 0.0 if touch is None else touch.time  # without a touch there is no stop
    hub = None if stop is None else stop.hub_time
    return {
        "name": scene.name,
        "status": status.code,
        "message": status.message,
        "touch_time_s": None if touch is None else touch.time,
        "stopping_time_s": None if stop is None else stop.time - touched,
        "stopping_time_measure": _measure(scene),
        "hub_stopping_time_s": None if hub is None else hub - touched,
        "angle_at_stop_deg": None if stop is None or stop.angle is None else math.degrees(stop.angle),
        "max_depth_m": None if depth is None else depth[0],
        "max_deflection_m": None if deflection is None else abs(deflection[0]),
        "max_deflection_time_s": None if deflection is None else deflection[1],
        "energy": energies,
        "cost": dict(vars(cost)),
        "versions": versions(),
        "warnings": [],
    }


def least_energy(scene: Scene) -> float:
    """Energy (J) below which an energy counts as zero."""
    return scene.force_scale * scene.least_path


def _measure(scene: Scene) -> str | None:
    """Definition of the stopping time of a mechanism; None if it has none (drives, or only welds)."""
    if scene.drives or all(joint.kind == "weld" for joint in scene.joints):
        return None
    return REST_MEASURE if scene.pendulum is None else STOP_MEASURE


def versions() -> dict[str, str]:
    """Versions of Python and of the packages on which the numbers depend."""
    return dict(_versions())


@cache  # 2 ms, and the same for every run of a sweep
def _versions() -> dict[str, str]:
    program = {"python": platform.python_version(), "granular-contact": __version__}
    return program | {package: metadata.version(package) for package in ("exudyn", "numpy", "numba")}


FEWEST = 2  # least number of strides: one stride has no scatter


class Driving(NamedTuple):
    """Histories of a drive: torque (N m) or force (N), (n,), power (n,) W, and work since the start (n,) J.

    jumps: (k, 3) time (s), force and power on both sides of each jump, which may lie between steps.
    """

    force: Vector
    power: Vector
    work: Vector
    jumps: Vector = np.zeros((0, 3))

    def squared(self, time: Vector) -> float:
        """Integral of the square of the torque or force over time (n,) s, jumps between steps included."""
        instants = np.concatenate([time, self.jumps[:, 0]])
        order = np.argsort(instants, kind="stable")
        return squared(instants[order], np.concatenate([self.force, self.jumps[:, 1]])[order])

    @property
    def largest(self) -> float:
        """Greatest absolute value of the torque or force."""
        return float(np.abs(np.concatenate([self.force, self.jumps[:, 1]])).max())


def drive_numbers(time: Vector, drive: Driving, rate: Vector, *, rotary: bool) -> dict[str, float]:
    """Key numbers of one drive over a run; time: (n,) s; rate: (n,) rad/s of a rotary drive, else m/s.

    Means are over time.
    """
    load, unit, rate_unit = ("torque", "Nm", "rad_s") if rotary else ("force", "N", "m_s")
    power, duration = drive.power, float(time[-1] - time[0])
    work = float(drive.work[-1])
    square = drive.squared(time)
    return {
        f"largest_{load}_{unit}": drive.largest,
        f"rms_{load}_{unit}": float(np.sqrt(square / duration)) if duration > 0.0 else 0.0,
        f"largest_rate_{rate_unit}": float(np.max(np.abs(rate))),
        "largest_power_W": float(np.max(np.concatenate([power, drive.jumps[:, 2]]))),
        "mean_power_W": work / duration if duration > 0.0 else 0.0,
        "work_J": work,
        "work_put_in_J": positive_part(time, power),
    }


def stride_numbers(
    time: Vector,
    place: Vector,
    powers: Sequence[Vector],
    torques: Sequence[Vector],
    weight: float,
    period: float,
) -> dict[str, Any] | None:
    """Means and standard deviations of key numbers over whole strides; None for fewer than two strides.

    Strides are counted back from the end. The first stride is skipped, because the gait settles in it, if at least two
    whole strides remain.

    time: (n,) s; place: (n,) m, of the centre of mass along the direction of travel; powers: (n,) W and torques:
    (n,) N m of the drives; weight: N; period: of a stride (s).
    """
    count = int((time[-1] - time[0]) / period * (1.0 + 1e-9))
    count -= count > FEWEST
    if count < FEWEST:
        return None
    ends = time[-1] - period * np.arange(count, -1, -1)
    x = np.interp(ends, time, place)
    numbers: dict[str, list[float]] = {"distance_m": np.diff(x).tolist(), "speed_m_s": (np.diff(x) / period).tolist()}
    spans = list(pairwise(ends))
    put_in = [sum(positive_part(*_within(time, power, *span)) for power in powers) for span in spans]
    numbers["drive_work_put_in_J"] = put_in
    if torques:
        numbers["largest_drive_torque_Nm"] = [
            max(float(np.max(np.abs(_within(time, torque, *span)[1]))) for torque in torques) for span in spans
        ]
    if all(distance != 0.0 for distance in numbers["distance_m"]) and weight > 0.0:
        costs = [work / (weight * abs(length)) for work, length in zip(put_in, numbers["distance_m"], strict=True)]
        numbers["cost_of_transport"] = costs
    statistics: Mapping[str, Any] = {name: _scatter(values) for name, values in numbers.items()}
    return {"count": count, "period_s": period, **statistics}


def _within(time: Vector, values: Vector, begin: float, end: float) -> tuple[Vector, Vector]:
    """Restrict a history to the span between two instants; the values at its ends are interpolated."""
    inside = (time > begin) & (time < end)
    at = np.concatenate([[begin], time[inside], [end]])
    ends = np.interp([begin, end], time, values)
    return at, np.concatenate([ends[:1], values[inside], ends[1:]])


def _scatter(values: Sequence[float]) -> dict[str, float]:
    return {"mean": float(np.mean(values)), "standard_deviation": float(np.std(values, ddof=1))}
