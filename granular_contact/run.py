"""One scene, by the engine, in minimal coordinates or by the reduced model: Scene -> Results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.config.changed import checked, differences
from granular_contact.errors import scene_error
from granular_contact.kernels.compiling import announced
from granular_contact.laws.kinds import WORDS
from granular_contact.laws.law import term_names
from granular_contact.results import (
    REST_MEASURE,
    STOP_MEASURE,
    Column,
    Compiling,
    Cost,
    Outline,
    Progress,
    Results,
    Snapshot,
    Status,
)
from granular_contact.results.accuracy import Doubt, told
from granular_contact.results.frames import Pictures, frames, instants, resample
from granular_contact.results.interpolation import Track, at_times
from granular_contact.results.limits import Reach, warnings
from granular_contact.results.stopping import Stop, Touch, find_touch
from granular_contact.results.summary import Extremes, extremes, summarise
from granular_contact.scene.bed import NOTHING
from granular_contact.scene.types import Reduced, Scene, Vector

if TYPE_CHECKING:
    from granular_contact.bed.history import LoadHistory
    from granular_contact.multibody.observe import Observer
    from granular_contact.multibody.system import System, Trajectory


def run(
    scene: Scene,
    scenario: Scenario | None = None,
    progress: Progress | None = None,
    *,
    most_frames: int = 0,
    inspect: Callable[[System, Trajectory], None] | None = None,
    compiling: Compiling | None = None,
) -> Results:
    """Simulate a scene. However the run ends, what it reached is in the results; look at their status.

    Parameters
    ----------
    scene : Scene
        What `granular_contact.scene.build` made of the scenario.
    scenario : Scenario, optional
        What the scene was built from; the scene knows it, and any other is refused.
    progress : callable, optional
        Called now and then with the simulated time and the end time (s).
    most_frames : int
        From 2: the results get at most so many frames, for an animation.
    inspect : callable, optional
        Called with the engine's own system and trajectory after the solve; never for other methods, which have none.
    compiling : callable, optional
        Called with a sentence when kernels have to be compiled, which is the case once for each law and installation.

    Raises
    ------
    SceneError
        The scenario is another one than the scene was built from, or the scene was not built from any.
    """
    known = _scenario_of(scene, scenario)
    if isinstance(scene.method, Reduced):
        solved = _reduced(scene, scene.method, progress, compiling)
    else:
        solved = _solved(scene, progress, inspect, compiling)
    columns, table, time = solved.columns, solved.table, solved.table[:, 0]
    series = {column.name: table[:, i] for i, column in enumerate(columns)}
    greatest = extremes(time, solved.depths, solved.deflection)
    touch = find_touch(time, solved.depths) if scene.media else None
    stop = None if touch is None else solved.stop(touch)
    moments = {
        "touch": 0 if touch is None else touch.index,
        "deepest": int(np.argmax(series["depth_m"])) if "depth_m" in series else len(time) - 1,
        "end": len(time) - 1,
    }
    least = scene.force_scale * scene.least_way
    summary = summarise(scene.name, solved.status, solved.cost, series, touch, stop, greatest, _measure(scene), least)
    summary |= solved.more
    summary["warnings"] += [
        *told(summary["energy"]["imbalance_relative"], solved.doubts, scene),
        *_limits(scene, solved.reach),
        *_buried(scene, series),
        *_missed(scene, greatest),
    ]
    if scene.stiff:
        summary["too_stiff_to_bend"] = list(scene.stiff)
    return Results(
        name=scene.name,
        status=solved.status,
        columns=columns,
        table=table[_rows(time, scene.output_interval)],
        summary=summary,
        scenario=scenario_to_dict(known),
        snapshots=tuple(Snapshot(label, float(time[i]), solved.outlines(i)) for label, i in moments.items()),
        surface=_surface(scene),
        warnings=tuple(summary["warnings"]),
        frames=_frames(scene, solved, time, most_frames) if most_frames else (),
        terms=solved.terms,
        layers=tuple(sorted({layer.top for layer in scene.bed.layers if layer.top > 0.0})) if scene.bed else (),
        floor=scene.bed.floor.height if scene.bed and scene.bed.floor else None,
        sizes=() if solved.reach is None else tuple(sorted({size for _, size in solved.reach.sizes})),
    )


def _scenario_of(scene: Scene, given: Scenario | None) -> Scenario:
    """The scenario that a scene was built from, which results may name; a given one has to be the same."""
    built = scene.scenario
    if built is None:
        why = "the scene was changed after it was built, so no scenario tells what it is"
        raise scene_error("scene", f"{why}; change the scenario with its replace() and build that")
    if given is None or given is built or given == built or checked(given) == built:
        return built
    keys = ", ".join(differences(scenario_to_dict(given), scenario_to_dict(built)))
    raise scene_error("scenario", f"is not the one that the scene was built from: they differ in {keys}; leave it out")


def uninterrupted(results: Results) -> Results:
    """The same results, for those who make several and want all; raises KeyboardInterrupt where that ended a run."""
    if results.status.code == "interrupted":
        raise KeyboardInterrupt
    return results


@dataclass(frozen=True)
class _Solved:
    """What every way of solving gives: all accepted instants, and what is asked about single ones (by index).

    pictures: outlines at given times (k,) s; loads: forces of the medium, see `results.frames`; terms: names of its
    terms; depths (m) of all points that can meet the medium, and the deflection (m) of the last flexible link; reach:
    None where nothing could meet the medium; more: what the summary has besides; doubts: on its accuracy.
    """

    status: Status
    cost: Cost
    columns: tuple[Column, ...]
    table: Vector
    stop: Callable[[Touch], Stop | None]
    outlines: Callable[[int], tuple[Outline, ...]]
    pictures: Callable[[Vector], Pictures]
    loads: dict[str, Vector]
    terms: tuple[str, ...]
    depths: list[Track]
    deflection: Track | None
    reach: Reach | None
    more: dict[str, Any]
    doubts: tuple[Doubt, ...] = ()


def _compiled(scene: Scene) -> str:
    """What there is to compile for a scene, in words."""
    laws = ", ".join(dict.fromkeys(medium.law for medium in scene.media))
    kinds = {shape.kind for body in scene.rigid for shape in body.shapes if shape.in_sand}
    kinds |= {link.kind for link in scene.links}
    shapes = " and ".join(words.partition(" (")[0] for kind, words in WORDS.items() if kind in kinds)
    return f"the law {laws} for {shapes}" if laws else "the equations of motion"


def _trajectory(scene: Scene, progress: Progress | None, compiling: Compiling | None) -> tuple[System, Trajectory]:
    """By the engine, or in minimal coordinates: either way in the coordinates of the engine."""
    if scene.method is None:
        from granular_contact.multibody.build import build
        from granular_contact.multibody.solve import solve

        system = build(scene)
        with announced(compiling, _compiled(scene)):
            return system, solve(system, progress)
    from granular_contact.minimal.solve import solve as solve_tree
    from granular_contact.minimal.tree import tree

    made = tree(scene)
    with announced(compiling, _compiled(scene)):
        return made.system, solve_tree(made, progress)


def _solved(
    scene: Scene,
    progress: Progress | None,
    inspect: Callable[[System, Trajectory], None] | None,
    compiling: Compiling | None,
) -> _Solved:
    from granular_contact.multibody.mechanism import key_numbers
    from granular_contact.multibody.observe import Observer
    from granular_contact.multibody.stop import stop_after

    system, trajectory = _trajectory(scene, progress, compiling)
    observer = Observer(system, trajectory)
    if scene.method is None and trajectory.load is not None:
        from granular_contact.multibody.strip_error import finer

        if (shorter := finer(observer)) is not None:
            again = _solved(shorter, progress, inspect, compiling)
            spent = trajectory.cost.solve_s + again.cost.solve_s
            return replace(again, cost=replace(again.cost, solve_s=spent))
    if inspect is not None and scene.method is None:
        inspect(system, trajectory)
    return _Solved(
        trajectory.status,
        trajectory.cost,
        *observer.columns(),
        stop=lambda touch: stop_after(observer, touch),
        outlines=observer.outlines,
        pictures=lambda at: _pictures(lambda sampled: Observer(system, sampled), trajectory, at),
        loads={} if trajectory.load is None else _by_body(trajectory.load),
        terms=observer.terms,
        depths=observer.all_depths(),
        deflection=observer.deflection(),
        reach=observer.reach(),
        more=key_numbers(observer) | _chosen_strips(scene, trajectory),
        doubts=_doubts(observer) if scene.method is None else (),
    )


def _chosen_strips(scene: Scene, trajectory: Trajectory) -> dict[str, Any]:
    """Strips of a run that chose them by their error."""
    if scene.solver.accuracy is None or trajectory.load is None:
        return {}
    return {
        "strips": {"per_rigid_part": scene.load.strips_per_rigid_part, "per_element": scene.load.strips_per_element}
    }


def _doubts(observer: Observer) -> tuple[Doubt, ...]:
    from granular_contact.multibody.accuracy import doubts

    with np.errstate(all="ignore"):  # of a run that failed by running away
        return tuple(doubts(observer))


def _reduced(scene: Scene, method: Reduced, progress: Progress | None, compiling: Compiling | None) -> _Solved:
    from granular_contact.reduced.model import model
    from granular_contact.reduced.observe import Observer
    from granular_contact.reduced.solve import solve

    reduced = model(scene, method)
    with announced(compiling, _compiled(scene)):
        trajectory = solve(reduced, progress)
    observer = Observer(reduced, trajectory)
    return _Solved(
        trajectory.status,
        trajectory.cost,
        *observer.columns(),
        stop=lambda _: observer.stop(),
        outlines=observer.outlines,
        pictures=lambda at: _pictures(lambda sampled: Observer(reduced, sampled), trajectory, at),
        loads={"": trajectory.terms.sum(axis=1)},
        terms=term_names(scene.media),
        depths=observer.all_depths(),
        deflection=observer.deflection(),
        reach=observer.reach(),
        more={"static_turns": trajectory.turns},
    )


def _limits(scene: Scene, reach: Reach | None) -> list[str]:
    return [] if scene.bed is None or reach is None or not reach.depth > 0.0 else list(warnings(scene.bed, reach))


def _buried(scene: Scene, series: dict[str, Vector]) -> list[str]:
    """Of a start in the medium: what is taken for granted."""
    depth = float(series["depth_m"][0]) if scene.media and not scene.settle else 0.0
    if not depth > NOTHING:
        return []
    return [f"it starts {depth:.4g} m below the surface, as if it had been laid there without moving a grain"]


def _missed(scene: Scene, greatest: Extremes) -> list[str]:
    """Of a run that never touched its medium, which is hardly what was meant."""
    nearest = greatest.depth[0] if scene.media and greatest.depth is not None else 0.0
    if not nearest < -NOTHING:
        return []
    return [f"it never touched the medium: its deepest point came within {-nearest:.4g} m of the surface"]


def _by_body(load: LoadHistory) -> dict[str, Vector]:
    return {name: load.bodies[:, i] for i, name in enumerate(load.body_names)}


def _pictures(observer: Callable[[Any], Any], trajectory: Any, at: Vector) -> Pictures:
    """Outlines at times between the steps of a trajectory of any way of solving, as its observer draws them."""
    q, v = at_times(trajectory.time, trajectory.q, trajectory.v, at), resample(trajectory.time, trajectory.v, at)
    seen = observer(replace(trajectory, time=at, q=q, v=v))
    return [seen.outlines(i) for i in range(len(at))]


def _frames(scene: Scene, solved: _Solved, time: Vector, most: int) -> tuple[Snapshot, ...]:
    at = instants(float(time[0]), float(time[-1]), most)
    loads = {part: resample(time, wrench, at) for part, wrench in solved.loads.items()}
    return frames(at, solved.pictures(at), loads, _surface(scene))


def _surface(scene: Scene) -> float | Vector | None:
    """The free surface, see `Results`; None in vacuum."""
    if scene.bed is None or not scene.media:
        return None
    return scene.surface if scene.bed.level else scene.bed.corners


def _rows(time: Vector, interval: float | None) -> Any:
    """Which instants go into the table: all, or the first at or after each multiple of the interval, and the last."""
    if interval is None or interval <= np.diff(time).min(initial=np.inf):
        return slice(None)
    # Sums of steps miss the multiples by round-off, which is far below a step.
    near = 1e-3 * np.diff(time).min()
    passed = np.floor((time + near) / interval)  # multiples so far; counted, as there may be no room to list them
    return np.unique([0, *(np.flatnonzero(np.diff(passed)) + 1), len(time) - 1])


def _measure(scene: Scene) -> str | None:
    """What stopping means for a mechanism; None where it means nothing."""
    if scene.drives or all(joint.kind == "weld" for joint in scene.connections):
        return None
    return REST_MEASURE if scene.pendulum is None else STOP_MEASURE
