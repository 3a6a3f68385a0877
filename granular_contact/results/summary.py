"""Time series -> key numbers, as summary.json holds them, the same for every method of solution.

Of what is driven: key numbers of each drive over the run, and of whole strides with their scatter.
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
    """Greatest depth (m, negative above the surface) and deflection (m, with its sign), and when (s) each came."""

    depth: tuple[float, float] | None
    deflection: tuple[float, float] | None


def extremes(time: Vector, depths: Sequence[Track], bend: Track | None) -> Extremes:
    """What is greatest between the steps of a run, from depths of points and the deflection of a link (n,)."""
    depth, deflection = (greatest(time, depths) if depths else None), None
    if bend is not None:
        other = Track(-bend.values, -bend.rates)
        (high, at), (low, then) = greatest(time, [bend]), greatest(time, [other])
        deflection = (high, at) if high >= low else (-low, then)
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
    """Key numbers of a run; energies: as of `energy.key_numbers`. Warnings are left out.

    None depends on which steps those are beyond the error of the steps: times, and what is greatest, are found between
    them (see `interpolation`), and works are integrals over time.
    """
    depth, deflection = extremes.depth, extremes.deflection
    begun = 0.0 if touch is None else touch.time  # there is no stop without a touch
    hub = None if stop is None else stop.hub_time
    return {
        "name": scene.name,
        "status": status.code,
        "message": status.message,
        "touch_time_s": None if touch is None else touch.time,
        "stopping_time_s": None if stop is None else stop.time - begun,
        "stopping_time_measure": _measure(scene),
        "hub_stopping_time_s": None if hub is None else hub - begun,
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
    """Energy (J) below which nothing counts."""
    return scene.force_scale * scene.least_path


def _measure(scene: Scene) -> str | None:
    """What stopping means for a mechanism; None where it means nothing."""
    if scene.drives or all(joint.kind == "weld" for joint in scene.joints):
        return None
    return REST_MEASURE if scene.pendulum is None else STOP_MEASURE


def versions() -> dict[str, str]:
    """Versions of what the numbers depend on."""
    return dict(_versions())


@cache  # 2 ms, and the same for every run of a sweep
def _versions() -> dict[str, str]:
    own = {"python": platform.python_version(), "granular-contact": __version__}
    return own | {package: metadata.version(package) for package in ("exudyn", "numpy", "numba")}


FEWEST = 2  # strides, of which there is a scatter


class Driving(NamedTuple):
    """What a drive did: torque (N m) or force (N), (n,), power (n,) W, and work (n,) J so far.

    jumps (k, 3): time (s), force and power on either side of instants at which they jump, which may lie between steps.
    """

    force: Vector
    power: Vector
    work: Vector
    jumps: Vector = np.zeros((0, 3))

    def squared(self, time: Vector) -> float:
        """Integral over time (n,) s of the square of the force, which may jump between steps."""
        instants = np.concatenate([time, self.jumps[:, 0]])
        order = np.argsort(instants, kind="stable")
        return squared(instants[order], np.concatenate([self.force, self.jumps[:, 1]])[order])

    @property
    def largest(self) -> float:
        """Greatest size of the torque or force."""
        return float(np.abs(np.concatenate([self.force, self.jumps[:, 1]])).max())


def drive_numbers(time: Vector, drive: Driving, rate: Vector, *, rotary: bool) -> dict[str, float]:
    """Numbers of one drive over a run; time: (n,) s; rate: (n,) rad/s of a drive that turns, else m/s.

    Means are over time.
    """
    word, unit, of_rate = ("torque", "Nm", "rad_s") if rotary else ("force", "N", "m_s")
    power, lasted = drive.power, float(time[-1] - time[0])
    work = float(drive.work[-1])
    square = drive.squared(time)
    return {
        f"largest_{word}_{unit}": drive.largest,
        f"rms_{word}_{unit}": float(np.sqrt(square / lasted)) if lasted > 0.0 else 0.0,
        f"largest_rate_{of_rate}": float(np.max(np.abs(rate))),
        "largest_power_W": float(np.max(np.concatenate([power, drive.jumps[:, 2]]))),
        "mean_power_W": work / lasted if lasted > 0.0 else 0.0,
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
    """Means over whole strides, with the standard deviation of single strides; None of fewer than two.

    Strides are counted back from the end. The first period of the run is left out, as a gait sets in, where two whole
    strides remain without it.

    time: (n,) s; place: (n,) m of the centre of mass, ahead; powers (n,) W and torques (n,) N m of the drives; weight:
    N; period: s of a stride.
    """
    count = int((time[-1] - time[0]) / period * (1.0 + 1e-9))
    count -= count > FEWEST
    if count < FEWEST:
        return None
    ends = time[-1] - period * np.arange(count, -1, -1)
    x = np.interp(ends, time, place)
    found: dict[str, list[float]] = {"distance_m": np.diff(x).tolist(), "speed_m_s": (np.diff(x) / period).tolist()}
    spans = list(pairwise(ends))
    put_in = [sum(positive_part(*_within(time, power, *span)) for power in powers) for span in spans]
    found["drive_work_put_in_J"] = put_in
    if torques:
        found["largest_drive_torque_Nm"] = [
            max(float(np.max(np.abs(_within(time, torque, *span)[1]))) for torque in torques) for span in spans
        ]
    if all(distance != 0.0 for distance in found["distance_m"]) and weight > 0.0:
        costs = [work / (weight * abs(length)) for work, length in zip(put_in, found["distance_m"], strict=True)]
        found["cost_of_transport"] = costs
    statistics: Mapping[str, Any] = {name: _scatter(values) for name, values in found.items()}
    return {"count": count, "period_s": period, **statistics}


def _within(time: Vector, values: Vector, begin: float, end: float) -> tuple[Vector, Vector]:
    """A history between two instants, its ends interpolated."""
    inside = (time > begin) & (time < end)
    at = np.concatenate([[begin], time[inside], [end]])
    ends = np.interp([begin, end], time, values)
    return at, np.concatenate([ends[:1], values[inside], ends[1:]])


def _scatter(values: Sequence[float]) -> dict[str, float]:
    return {"mean": float(np.mean(values)), "standard_deviation": float(np.std(values, ddof=1))}
