"""Time series -> key numbers, as summary.json holds them. The same for every way of solving a scene."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.results import STOP_MEASURE, Cost, Status
from granular_contact.results.interpolation import Track, greatest
from granular_contact.results.stopping import Stop, Touch

Vector = NDArray[np.float64]

STORED = ("kinetic_J", "gravity_J", "elastic_J", "spring_J")
WORKS = ("granular_work_J", "damping_work_J", "joint_damping_work_J", "friction_work_J", "drive_work_J", "floor_work_J")


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
    name: str,
    status: Status,
    cost: Cost,
    series: dict[str, Vector],
    touch: Touch | None,
    stop: Stop | None,
    extremes: Extremes,
    measure: str | None = STOP_MEASURE,
    least_energy: float = 0.0,
) -> dict[str, Any]:
    """Key numbers of a run from all its accepted steps; series by column name, (n,) each. Warnings are left to `run`.

    None depends on which steps those are beyond the error of the steps: times, and what is greatest, are found between
    them (see `interpolation`), and works are integrals over time.
    measure: what stopping means for this mechanism; least_energy (J): that an imbalance is measured against at least.
    """
    depth, deflection = extremes.depth, extremes.deflection
    imbalance = _relative_imbalance(series, least_energy)
    return {
        "name": name,
        "status": status.code,
        "message": status.message,
        "touch_time_s": None if touch is None else touch.time,
        "stopping_time_s": None if stop is None or touch is None else stop.time - touch.time,
        "stopping_time_measure": measure,
        "hub_stopping_time_s": (
            None if stop is None or touch is None or stop.hub_time is None else stop.hub_time - touch.time
        ),
        "angle_at_stop_deg": None if stop is None or stop.angle is None else float(np.degrees(stop.angle)),
        "max_depth_m": None if depth is None else depth[0],
        "max_deflection_m": None if deflection is None else abs(deflection[0]),
        "max_deflection_time_s": None if deflection is None else deflection[1],
        "energy": _energy(series) | {"imbalance_relative": imbalance},
        "cost": asdict(cost),
        "versions": versions(),
        "warnings": [],
    }


def _energy(series: dict[str, Vector]) -> dict[str, float]:
    stored = np.sum([series[name] for name in STORED if name in series], axis=0)
    return {
        "initial_J": float(stored[0]),
        "final_J": float(stored[-1]),
    } | {name: float(series[name][-1]) for name in WORKS if name in series}


def _relative_imbalance(series: dict[str, Vector], least: float) -> float:
    """Largest imbalance over the largest single energy, or over the least (J) that counts."""
    scale = max(least, *(float(np.max(np.abs(series[name]))) for name in (*STORED, *WORKS) if name in series))
    return float(np.max(np.abs(series["energy_imbalance_J"]))) / scale if scale > 0.0 else 0.0


def versions() -> dict[str, str]:
    """Versions of what the numbers depend on."""
    packages = ("granular-contact", "exudyn", "numpy", "numba")
    return {"python": platform.python_version()} | {package: _version(package) for package in packages}


@cache  # 0.5 ms each, and the same for every run of a sweep
def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "(not installed)"
