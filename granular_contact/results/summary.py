"""Time series -> key numbers, as summary.json holds them. The same for every method of solution."""

from __future__ import annotations

import math
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from typing import Any

from granular_contact import __version__
from granular_contact.results import REST_MEASURE, STOP_MEASURE, Cost, Status
from granular_contact.results.interpolation import Track, greatest
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
