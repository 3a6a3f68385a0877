"""What was observed of a solved scene -> Results: the one place where table, summary, warnings and pictures are made.

Every method of solution reads its own coordinates and gives an `Observation`: the engine and minimal coordinates in
`mechanics.observe`, modes in `engines.modal.observe`.
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
    """What a method of solution has found between its steps by itself.

    depth (n,) m of the deepest of all points that can meet the medium, None without a surface; greatest; touch: when
    (s) the first point gets into the medium, None for never; reach: None where nothing could meet the medium.
    """

    depth: Vector | None
    greatest: Extremes
    touch: float | None
    reach: Reach | None


@dataclass(frozen=True)
class Observation:
    """All accepted instants of a run (n,), and what is asked about single ones (by index).

    motion: columns of joints, drives and bodies; mean_rate (n,) rad/s, None without a pivot; tip (n, 2) m; deflection
    (m) of the last flexible link, clockwise; depths (m) of all points that can meet the medium, negative above it.
    terms: names of the terms of the medium's force; term_forces (n, terms, 3): these, as of `series.clockwise_moment`;
    moments_about: the pivot (2,) m, or of a mechanism without one its centre of mass (n, 2) m; body_forces (n, 3): see
    `frames.frames`. energies: as of `energy.columns`. reach: None where nothing could meet the medium. stop: when it
    stopped after the touch. outlines: as drawn at an instant; pictures: what gives them at given times (k,) s. more:
    what the summary has besides. accuracy: what the steps say of their own error. steered: warnings of what a
    program set. notices: of what the engine could not do as usual. known: None where
    depths and deflection are to be looked through.
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
        """Pictures evenly spaced in time, at most so many, as `Results` has them."""
        return {"frames": _frames(self, most)}

    def columns(self) -> tuple[tuple[Column, ...], Vector]:
        """All columns, with the table (instants, columns)."""
        found: series.Series = {"time_s": ("time since the start", self.time)}
        found |= self.motion | self._of_tip()
        if self.deflection is not None:
            found["deflection_m"] = (self._DEFLECTION, self.deflection.values)
        if self.depth is not None:
            found["depth_m"] = ("depth of the deepest point below the surface", self.depth)
        if self.scene.media:
            found |= self._of_terms()
        return series.tabulate(found | self.energies)

    def _of_tip(self) -> series.Series:
        return series.tip(self.tip, self.mean_rate)

    def _of_terms(self) -> series.Series:
        at_pivot = self.scene.pivot is not None
        return series.forces(self.terms, self.term_forces, self.moments_about, at_pivot=at_pivot)


def pictures(
    outlines: Callable[[Any], Outlines], trajectory: Any, at: Vector
) -> Callable[[], list[tuple[Outline, ...]]]:
    """What gives the outlines at times (k,) s between the steps of a trajectory, as its method of solution draws them.

    Only states at these times are computed here, and kept: a run is not slower for pictures that nobody asks for.
    """
    t = trajectory
    q, v = at_times(t.time, t.q, t.v, at), resample(t.time, t.v, at)
    drawn = outlines(replace(t, time=at, q=q, v=v))
    return lambda: [drawn(i) for i in range(len(at))]


def key_numbers(seen: Observation) -> tuple[dict[str, Any], Touch | None]:
    """The summary of a run, and when it touched the medium."""
    scene, time = seen.scene, seen.time
    energies = energy.key_numbers({name: values for name, (_, values) in seen.energies.items()}, least_energy(scene))
    if seen.known is None:
        found = extremes(time, seen.depths, seen.deflection)
        touch = find_touch(time, seen.depths) if scene.media else None
    else:
        found = seen.known.greatest
        touch = None if seen.known.touch is None else touched(time, seen.known.touch)
    stop = None if touch is None else seen.stop(touch)
    summary = summarise(scene, seen.status, seen.cost, energies, touch, stop, found) | seen.more
    start = None if seen.depth is None else float(seen.depth[0])
    return warned(summary, scene, found, seen.reach, start, seen.accuracy, [*seen.notices, *seen.steered]), touch


def warned(
    summary: dict[str, Any],
    scene: Scene,
    greatest: Extremes,
    reach: Reach | None,
    start: float | None,
    accuracy: Sequence[AccuracyWarning] = (),
    steered: Sequence[str] = (),
) -> dict[str, Any]:
    """A summary with its warnings in it; start: depth (m) of the deepest point then; others as of Observation.

    steered: notices, too.
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


def results(seen: Observation, scenario: dict[str, Any], most_frames: int = 0) -> Results:
    """Results of a run; scenario: as plain YAML types; most_frames: from 2, at most so many frames of an animation."""
    scene, time = seen.scene, seen.time
    columns, table = seen.columns()
    summary, touch = key_numbers(seen)
    moments = {
        "touch": 0 if touch is None else touch.index,
        "deepest": len(time) - 1 if seen.depth is None else int(np.argmax(seen.depth)),
        "end": len(time) - 1,
    }
    return Results(
        name=scene.name,
        status=seen.status,
        columns=columns,
        table=table[_rows(time, scene.output_interval)],
        summary=summary,
        scenario=scenario,
        snapshots=tuple(Snapshot(label, float(time[i]), seen.outlines(i)) for label, i in moments.items()),
        **bed_of(scene),
        warnings=tuple(summary["warnings"]),
        **(seen.film(most_frames) if most_frames else {}),
        terms=seen.terms,
        sizes=() if seen.reach is None else tuple(sorted({size for _, size in seen.reach.sizes})),
    )


def _frames(seen: Observation, most: int) -> Later:
    at = instants(float(seen.time[0]), float(seen.time[-1]), most)
    loads = {part: resample(seen.time, wrench, at) for part, wrench in seen.body_forces.items()}
    drawn, top = seen.pictures(at), surface(seen.scene)
    return Later(lambda: frames(at, drawn(), loads, top))


def bed_of(scene: Scene) -> dict[str, Any]:
    """Surface, layers and floor, as `Results` has them."""
    return {
        "surface": surface(scene),
        "layers": tuple(sorted({layer.top for layer in scene.bed.layers if layer.top > 0.0})) if scene.bed else (),
        "floor": scene.bed.floor.height if scene.bed and scene.bed.floor else None,
    }


def surface(scene: Scene) -> float | Vector | None:
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
