"""One scene through the engine: Scene -> Results."""

from __future__ import annotations

import importlib.metadata
import platform
from typing import Any

import numpy as np

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.multibody.build import build
from granular_contact.multibody.observe import Observer
from granular_contact.multibody.solve import Progress, Trajectory, solve
from granular_contact.results import Column, Results, Snapshot
from granular_contact.scene.types import Scene, Vector
from granular_contact.stopping import Stop, find_stop

RATE_MEASURE = "mean rate: angular momentum about the pivot over the moment of inertia about it"
IMBALANCE_LIMIT = 1e-2


def run(scene: Scene, scenario: Scenario, progress: Progress | None = None) -> Results:
    """Simulate a scene. However the run ends, what it reached is in the results; look at their status.

    Parameters
    ----------
    scene : Scene
        What `granular_contact.scene.build` made of the scenario.
    scenario : Scenario
        Kept with the results, with its defaults resolved.
    progress : callable, optional
        Called now and then with the simulated time and the end time (s).
    """
    system = build(scene)
    trajectory = solve(system, progress)
    observer = Observer(system, trajectory)
    columns, table = observer.columns()
    stop = _stop(observer, trajectory)
    summary = _summary(scene, trajectory, columns, table, stop)
    depth = _column(columns, table, "depth_m")
    deepest = len(table) - 1 if depth is None else int(np.argmax(depth))
    snapshots = (("touch", _touch(depth)), ("deepest", deepest), ("end", len(table) - 1))
    return Results(
        name=scene.name,
        status=trajectory.status,
        columns=columns,
        table=table[_rows(trajectory.time, scene.output_interval)],
        summary=summary,
        scenario=scenario_to_dict(scenario),
        snapshots=tuple(Snapshot(label, trajectory.time[i], observer.outlines(i)) for label, i in snapshots),
        surface=scene.surface if scene.medium is not None else None,
        warnings=tuple(summary["warnings"]),
    )


def _column(columns: tuple[Column, ...], table: Vector, name: str) -> Vector | None:
    """Column of the table by name, None when the scene has none of it."""
    names = [column.name for column in columns]
    return table[:, names.index(name)] if name in names else None


def _touch(depth: Vector | None) -> int:
    """First instant at which something is immersed; the start when nothing ever is."""
    return 0 if depth is None or not np.any(depth > 0.0) else max(0, int(np.argmax(depth > 0.0)) - 1)


def _rows(time: Vector, interval: float | None) -> Any:
    """Which instants go into the table: all, or the first at or after each multiple of the interval, and the last."""
    if interval is None:
        return slice(None)
    due = np.arange(0.0, time[-1], interval)
    return np.unique([*np.searchsorted(time, due - 1e-12), len(time) - 1])


def _stop(observer: Observer, trajectory: Trajectory) -> Stop | None:
    """First zero of the mean rate, with the pivot's angle there."""
    pivot = observer.scene.pivot
    if pivot is None:
        return None
    rate, inertia = observer.mean_rate()
    moment = np.zeros_like(rate) if trajectory.load is None else trajectory.load.terms[:, :, 2].sum(axis=1)
    angle, angle_rate = observer.angle(pivot.child, pivot.child_point)
    return find_stop(trajectory.time, rate, -(moment + observer.weight_moment()) / inertia, -angle, -angle_rate)


def _summary(
    scene: Scene, trajectory: Trajectory, columns: tuple[Column, ...], table: Vector, stop: Stop | None
) -> dict[str, Any]:
    def extreme(name: str) -> float | None:
        values = _column(columns, table, name)
        return None if values is None else float(np.max(np.abs(values) if name == "deflection_m" else values))

    imbalance = _column(columns, table, "energy_imbalance_J")
    energies = {c.name: table[:, i] for i, c in enumerate(columns) if c.name.endswith("_J")}
    stored = sum(energies[name] for name in ("kinetic_J", "gravity_J", "elastic_J") if name in energies)
    scale = max(float(np.max(np.abs(values))) for name, values in energies.items() if name != "energy_imbalance_J")
    relative = float(np.max(np.abs(imbalance))) / scale if scale > 0.0 else 0.0
    cost = trajectory.cost
    return {
        "name": scene.name,
        "status": trajectory.status.code,
        "message": trajectory.status.message,
        "stopping_time_s": None if stop is None else stop.time,
        "stopping_time_measure": RATE_MEASURE,
        "angle_at_stop_deg": None if stop is None else float(np.degrees(stop.angle)),
        "hub_stopping_time_s": None if stop is None else stop.hub_time,
        "max_depth_m": extreme("depth_m"),
        "max_deflection_m": extreme("deflection_m"),
        "energy": {
            "initial_J": float(stored[0]),
            "final_J": float(stored[-1]),
            "granular_work_J": float(energies["granular_work_J"][-1]),
            "damping_work_J": float(energies["damping_work_J"][-1]),
            "imbalance_relative": relative,
        },
        "cost": {
            "solve_s": cost.solve_s,
            "steps": cost.steps,
            "newton_iterations": cost.newton_iterations,
            "jacobians": cost.jacobians,
            "load_calls": cost.load_calls,
        },
        "versions": _versions(),
        "warnings": _warnings(relative),
    }


def _warnings(imbalance: float) -> list[str]:
    if imbalance <= IMBALANCE_LIMIT:
        return []
    return [f"the energy balance is off by {imbalance:.1%}: take a smaller solver.step_s"]


def _versions() -> dict[str, str]:
    packages = ("granular-contact", "exudyn", "numpy", "numba")
    return {"python": platform.python_version()} | {name: importlib.metadata.version(name) for name in packages}
