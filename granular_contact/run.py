"""One scene, by the engine or by the reduced model: Scene -> Results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.limits import Reach, warnings
from granular_contact.media.kinds import term_names
from granular_contact.results import Column, Cost, Outline, Progress, Results, Snapshot, Status
from granular_contact.scene.types import Connection, Reduced, Scene, Vector
from granular_contact.stopping import Stop, find_stop
from granular_contact.summary import FALL_MEASURE, STOP_MEASURE, Touch, find_touch, summarise

if TYPE_CHECKING:
    from granular_contact.multibody.observe import Observer
    from granular_contact.multibody.solve import Trajectory
    from granular_contact.multibody.system import System


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
    solved = _reduced(scene, scene.method, progress) if isinstance(scene.method, Reduced) else _solved(scene, progress)
    columns, table, time = solved.columns, solved.table, solved.table[:, 0]
    series = {column.name: table[:, i] for i, column in enumerate(columns)}
    touch = find_touch(time, series["depth_m"]) if scene.media else None
    stop = None if touch is None else solved.stop(touch)
    instants = {
        "touch": 0 if touch is None else touch.index,
        "deepest": int(np.argmax(series["depth_m"])) if "depth_m" in series else len(time) - 1,
        "end": len(time) - 1,
    }
    summary = summarise(scene.name, solved.status, solved.cost, series, touch, stop, _measure(scene)) | solved.more
    summary["warnings"] += _limits(scene, solved.reach)
    return Results(
        name=scene.name,
        status=solved.status,
        columns=columns,
        table=table[_rows(time, scene.output_interval)],
        summary=summary,
        scenario=scenario_to_dict(scenario),
        snapshots=tuple(Snapshot(label, float(time[i]), solved.outlines(i)) for label, i in instants.items()),
        surface=scene.surface if scene.media else None,
        warnings=tuple(summary["warnings"]),
        terms=solved.terms,
    )


@dataclass(frozen=True)
class _Solved:
    """What either way of solving gives: all accepted instants, and what is asked about single ones (by index).

    terms: names of the terms of the granular force; reach: None where nothing could meet the medium; more: what the
    summary has besides.
    """

    status: Status
    cost: Cost
    columns: tuple[Column, ...]
    table: Vector
    stop: Callable[[Touch], Stop | None]
    outlines: Callable[[int], tuple[Outline, ...]]
    terms: tuple[str, ...]
    reach: Reach | None
    more: dict[str, Any]


def _trajectory(scene: Scene, progress: Progress | None) -> tuple[System, Trajectory]:
    """By the engine, or in minimal coordinates: either way in the coordinates of the engine."""
    if scene.method is None:
        from granular_contact.multibody.build import build
        from granular_contact.multibody.solve import solve

        system = build(scene)
        return system, solve(system, progress)
    from granular_contact.minimal.solve import solve as solve_tree
    from granular_contact.minimal.tree import tree

    made = tree(scene)
    return made.system, solve_tree(made, progress)


def _solved(scene: Scene, progress: Progress | None) -> _Solved:
    from granular_contact.multibody.observe import Observer
    from granular_contact.multibody.observe_mechanism import key_numbers

    system, trajectory = _trajectory(scene, progress)
    observer = Observer(system, trajectory)
    return _Solved(
        trajectory.status,
        trajectory.cost,
        *observer.columns(),
        stop=lambda touch: engine_stop(observer, touch),
        outlines=observer.outlines,
        terms=observer.terms,
        reach=observer.reach(),
        more=key_numbers(observer),
    )


def _reduced(scene: Scene, method: Reduced, progress: Progress | None) -> _Solved:
    from granular_contact.reduced.model import model
    from granular_contact.reduced.observe import Observer
    from granular_contact.reduced.solve import solve

    reduced = model(scene, method)
    trajectory = solve(reduced, progress)
    observer = Observer(reduced, trajectory)
    return _Solved(
        trajectory.status,
        trajectory.cost,
        *observer.columns(),
        stop=lambda _: observer.stop(),
        outlines=observer.outlines,
        terms=term_names(scene.media),
        reach=observer.reach(),
        more={"static_turns": trajectory.turns},
    )


def _limits(scene: Scene, reach: Reach | None) -> list[str]:
    return [] if scene.bed is None or reach is None or not reach.depth > 0.0 else list(warnings(scene.bed, reach))


def _rows(time: Vector, interval: float | None) -> Any:
    """Which instants go into the table: all, or the first at or after each multiple of the interval, and the last."""
    if interval is None:
        return slice(None)
    due = np.arange(0.0, time[-1], interval)
    return np.unique([*np.searchsorted(time, due - 1e-12), len(time) - 1])


def engine_stop(observer: Observer, touch: Touch) -> Stop | None:
    """When the mechanism stopped after the touch, with the measure that fits it; None where there is none."""
    scene = observer.scene
    if scene.drives:
        return None
    if scene.pivot is not None:
        return _stop_about_pivot(observer, scene.pivot, touch)
    return _stop_of_fall(observer, touch) if scene.floating is not None else None


def _measure(scene: Scene) -> str | None:
    """What stopping means for a mechanism; None where it means nothing."""
    if scene.drives:
        return None
    if scene.floating is not None:
        return FALL_MEASURE
    turns = all(c.kind in ("hinge", "weld") for c in scene.connections if c.parent is None)
    return STOP_MEASURE if turns and not any(c.closes for c in scene.connections) else None


def _stop_about_pivot(observer: Observer, pivot: Connection, touch: Touch) -> Stop | None:
    """First zero of the mean rate after the touch, with the pivot's angle there."""
    trajectory = observer.trajectory
    rate, inertia = observer.mean_rate()
    moment = observer.weight_moment()
    if trajectory.load is not None:
        moment = moment + trajectory.load.terms[:, :, 2].sum(axis=1)
    angle, angle_rate = observer.angle(pivot.child, pivot.child_point)
    after = slice(touch.index, None)
    return find_stop(trajectory.time[after], rate[after], (-moment / inertia)[after], -angle[after], -angle_rate[after])


def _stop_of_fall(observer: Observer, touch: Touch) -> Stop | None:
    """First zero of the vertical velocity of the lower end after the touch, with the angle of its body there."""
    time, after = observer.trajectory.time, slice(touch.index, None)
    if len(time[after]) < 3:
        return None
    body, point = observer.scene.tip
    speed = observer.position(body, point)[1][after, 1]
    angle, rate = observer.angle(body, point)
    # Of the velocity itself, looking back only: at the stop the force of the medium jumps.
    slope = np.diff(speed) / np.diff(time[after])
    before = np.concatenate([slope[:1], slope[:1], slope[1:] + 0.5 * np.diff(slope)])[: len(speed)]
    return find_stop(time[after], speed, before, -angle[after], -rate[after], hub=False)
