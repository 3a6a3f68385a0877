"""Make `Results` from the `Observation` of a solved scene: table, summary, warnings and pictures, for every engine.

Each engine computes an `Observation` from its own coordinates: Exudyn and minimal coordinates in `mechanics.observe`,
modal coordinates in `engines.modal.observe`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from granular_contact.results import Column, Cost, Outline, Results, Snapshot, Status, energy, series
from granular_contact.results.accuracy import AccuracyWarning, usable, warning_sentences
from granular_contact.results.frames import Later, frames, instants, resample
from granular_contact.results.interpolation import Track, at_times
from granular_contact.results.limits import Reach, warnings
from granular_contact.results.stopping import Stop, Touch, find_touch, touched
from granular_contact.results.summary import Extremes, extremes, least_energy, summarise
from granular_contact.scene.types import Scene, Vector

Outlines = Callable[[int], tuple[Outline, ...]]


class Known(NamedTuple):
    """Extremes and first touch that an engine has already computed between its steps.

    depth: (n,) m, of the deepest point that can meet the medium, None without a surface; greatest: of depth and
    deflection; touch: time (s) at which the first point enters the medium, None if none does; reach: None if no body
    can meet the medium.
    """

    depth: Vector | None
    greatest: Extremes
    touch: float | None
    reach: Reach | None


@dataclass(frozen=True)
class Observation:
    """Histories of a run at its n accepted steps, and functions for single instants.

    motion: columns of joints, drives and bodies; mean_rate: (n,) rad/s, None without a pivot; tip: (n, 2) m;
    deflection: (m) of the last flexible link, clockwise; depths: (m) of all points that can meet the medium, negative
    above it. terms: names of the terms of the medium's force; term_forces: (n, terms, 3), see
    `series.clockwise_moment`; moments_about: the pivot (2,) m, or without a pivot the centre of mass (n, 2) m;
    body_forces: (n, 3) each, see `frames.frames`. energies: from `energy.columns`. reach: None if no body can meet the
    medium. stop: function from the touch to the stop after it. outlines: function from an index to the outlines there;
    pictures: function from times (k,) s to a function that draws them. more: further entries of the summary.
    accuracy: warnings on the error of the time steps. steered: warnings about values set by a controller. notices:
    about features that the engine had to replace. known: None if extremes and touch are still to be found from depths
    and deflection.
    """

    _DEFLECTION: ClassVar[str] = "tip deflection across the axis of the link's root, clockwise positive"

    scene: Scene
    status: Status
    cost: Cost
    time: Vector
    motion: series.Series
    mean_rate: Vector | None
    tip: Vector
    deflection: Track | None
    depths: Sequence[Track]
    terms: tuple[str, ...]
    term_forces: Vector
    moments_about: Vector
    body_forces: dict[str, Vector]
    energies: series.Series
    reach: Reach | None
    stop: Callable[[Touch], Stop | None]
    outlines: Outlines
    pictures: Callable[[Vector], Callable[[], list[tuple[Outline, ...]]]]
    more: dict[str, Any]
    accuracy: Sequence[AccuracyWarning] = ()
    steered: Sequence[str] = ()
    notices: Sequence[str] = ()
    known: Known | None = None

    @cached_property
    def depth(self) -> Vector | None:
        """Depth (n,) m of the deepest of all points that can meet the medium."""
        if self.known is not None:
            return self.known.depth
        return np.max([track.values for track in self.depths], axis=0) if self.depths else None

    def film(self, most: int) -> dict[str, Any]:
        """Field `frames` of `Results`: at most `most` pictures, evenly spaced in time."""
        return {"frames": _frames(self, most)}

    def columns(self) -> tuple[tuple[Column, ...], Vector]:
        """All columns, and the table (instants, columns)."""
        columns: series.Series = {"time_s": ("time since the start", self.time)}
        columns |= self.motion | self._tip_columns()
        if self.deflection is not None:
            columns["deflection_m"] = (self._DEFLECTION, self.deflection.values)
        if self.depth is not None:
            columns["depth_m"] = ("depth of the deepest point below the surface", self.depth)
        if self.scene.media:
            columns |= self._force_columns()
        return series.tabulate(columns | self.energies)

    def _tip_columns(self) -> series.Series:
        return series.tip(self.tip, self.mean_rate)

    def _force_columns(self) -> series.Series:
        at_pivot = self.scene.pivot is not None
        return series.forces(self.terms, self.term_forces, self.moments_about, at_pivot=at_pivot)


def pictures(
    outlines: Callable[[Any], Outlines], trajectory: Any, at: Vector
) -> Callable[[], list[tuple[Outline, ...]]]:
    """Return a function that draws the outlines at times (k,) s, interpolated between the steps of a trajectory.

    outlines: function of the engine from a trajectory to its `Outlines`. The states at these times are computed at
    once, the outlines only when the returned function is called: unused pictures cost no time.
    """
    t = trajectory
    q, v = at_times(t.time, t.q, t.v, at), resample(t.time, t.v, at)
    outlines_at = outlines(replace(t, time=at, q=q, v=v))
    return lambda: [outlines_at(i) for i in range(len(at))]


def key_numbers(observation: Observation) -> tuple[dict[str, Any], Touch | None]:
    """Summary of a run, and its first touch of the medium."""
    scene, time = observation.scene, observation.time
    energies = energy.key_numbers(
        {name: values for name, (_, values) in observation.energies.items()}, least_energy(scene)
    )
    if observation.known is None:
        greatest = extremes(time, observation.depths, observation.deflection)
        touch = find_touch(time, observation.depths) if scene.media else None
    else:
        greatest = observation.known.greatest
        touch = None if observation.known.touch is None else touched(time, observation.known.touch)
    stop = None if touch is None else observation.stop(touch)
    summary = summarise(scene, observation.status, observation.cost, energies, touch, stop, greatest) | observation.more
    start = None if observation.depth is None else float(observation.depth[0])
    return warned(
        summary,
        scene,
        greatest,
        observation.reach,
        start,
        observation.accuracy,
        [*observation.notices, *observation.steered],
    ), touch


def warned(
    summary: dict[str, Any],
    scene: Scene,
    greatest: Extremes,
    reach: Reach | None,
    start: float | None,
    accuracy: Sequence[AccuracyWarning] = (),
    steered: Sequence[str] = (),
) -> dict[str, Any]:
    """Add all warnings to a summary, and whether the result is usable.

    start: depth (m) of the deepest point at the start; steered: notices and warnings about set values, see
    `Observation`; reach, accuracy: see there.
    """
    summary["warnings"] += [
        *map(str, scene.notes),
        *steered,
        *warning_sentences(summary["energy"]["imbalance_relative"], accuracy, scene),
        *warnings(scene, reach, start, None if greatest.depth is None else greatest.depth[0]),
    ]
    summary["usable"] = usable(summary["energy"]["imbalance_relative"], accuracy)
    if scene.stiff:
        summary["too_stiff_to_bend"] = list(scene.stiff)
    return summary


def results(observation: Observation, scenario: dict[str, Any], most_frames: int = 0) -> Results:
    """Results of a run; scenario: as plain YAML types; most_frames: greatest number of pictures (at least 2), or 0."""
    scene, time = observation.scene, observation.time
    columns, table = observation.columns()
    summary, touch = key_numbers(observation)
    moments = {
        "touch": 0 if touch is None else touch.index,
        "deepest": len(time) - 1 if observation.depth is None else int(np.argmax(observation.depth)),
        "end": len(time) - 1,
    }
    return Results(
        name=scene.name,
        status=observation.status,
        columns=columns,
        table=table[_rows(time, scene.output_interval)],
        summary=summary,
        scenario=scenario,
        snapshots=tuple(Snapshot(label, float(time[i]), observation.outlines(i)) for label, i in moments.items()),
        **bed_of(scene),
        warnings=tuple(summary["warnings"]),
        **(observation.film(most_frames) if most_frames else {}),
        terms=observation.terms,
        sizes=() if observation.reach is None else tuple(sorted({size for _, size in observation.reach.sizes})),
    )


def _frames(observation: Observation, most: int) -> Later:
    at = instants(float(observation.time[0]), float(observation.time[-1]), most)
    loads = {part: resample(observation.time, wrench, at) for part, wrench in observation.body_forces.items()}
    drawn, top = observation.pictures(at), surface(observation.scene)
    return Later(lambda: frames(at, drawn(), loads, top))


def bed_of(scene: Scene) -> dict[str, Any]:
    """Fields `surface`, `layers` and `floor` of `Results`."""
    return {
        "surface": surface(scene),
        "layers": tuple(sorted({layer.top for layer in scene.bed.layers if layer.top > 0.0})) if scene.bed else (),
        "floor": scene.bed.floor.height if scene.bed and scene.bed.floor else None,
    }


def surface(scene: Scene) -> float | Vector | None:
    """Field `surface` of `Results`; None in vacuum."""
    if scene.bed is None or not scene.media:
        return None
    return scene.surface if scene.bed.level else scene.bed.corners


def _rows(time: Vector, interval: float | None) -> Any:
    """Rows of the table: all instants, or the first at or after each multiple of the interval, and the last."""
    if interval is None or interval <= np.diff(time).min(initial=np.inf):
        return slice(None)
    # A sum of steps differs from a multiple by round-off, which is far below a step.
    tolerance = 1e-3 * np.diff(time).min()
    # Number of multiples passed so far. A list of all multiples could be too long for the memory.
    passed = np.floor((time + tolerance) / interval)
    return np.unique([0, *(np.flatnonzero(np.diff(passed)) + 1), len(time) - 1])
