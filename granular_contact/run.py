"""One scene through the engine: Scene -> Results."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.multibody.build import build
from granular_contact.multibody.observe import Observer
from granular_contact.multibody.solve import Progress, solve
from granular_contact.results import Results, Snapshot
from granular_contact.scene.types import Scene, Vector
from granular_contact.stopping import Stop, find_stop
from granular_contact.summary import Touch, find_touch, summarise


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
    series = {column.name: table[:, i] for i, column in enumerate(columns)}
    time = trajectory.time
    touch = find_touch(time, series["depth_m"]) if scene.medium is not None else None
    stop = None if touch is None else _stop(observer, touch)
    instants = {
        "touch": 0 if touch is None else touch.index,
        "deepest": int(np.argmax(series["depth_m"])) if "depth_m" in series else len(time) - 1,
        "end": len(time) - 1,
    }
    summary = summarise(scene.name, trajectory.status, trajectory.cost, series, touch, stop)
    return Results(
        name=scene.name,
        status=trajectory.status,
        columns=columns,
        table=table[_rows(time, scene.output_interval)],
        summary=summary,
        scenario=scenario_to_dict(scenario),
        snapshots=tuple(Snapshot(label, float(time[i]), observer.outlines(i)) for label, i in instants.items()),
        surface=scene.surface if scene.medium is not None else None,
        warnings=tuple(summary["warnings"]),
    )


def _rows(time: Vector, interval: float | None) -> Any:
    """Which instants go into the table: all, or the first at or after each multiple of the interval, and the last."""
    if interval is None:
        return slice(None)
    due = np.arange(0.0, time[-1], interval)
    return np.unique([*np.searchsorted(time, due - 1e-12), len(time) - 1])


def _stop(observer: Observer, touch: Touch) -> Stop | None:
    """First zero of the mean rate after the touch, with the pivot's angle there."""
    pivot = observer.scene.pivot
    if pivot is None:
        return None
    trajectory = observer.trajectory
    rate, inertia = observer.mean_rate()
    moment = observer.weight_moment()
    if trajectory.load is not None:
        moment = moment + trajectory.load.terms[:, :, 2].sum(axis=1)
    angle, angle_rate = observer.angle(pivot.child, pivot.child_point)
    after = slice(touch.index, None)
    return find_stop(trajectory.time[after], rate[after], (-moment / inertia)[after], -angle[after], -angle_rate[after])
