"""What a run reached, against what its media, its floor and its container allow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.laws.floor import Floor
from granular_contact.laws.kinds import Kind
from granular_contact.scene.bed import ROUND_OFF, Bed
from granular_contact.scene.types import Scene

LEAST_START_DEPTH = 1e-6  # m: a depth at the start that is reported


@dataclass(frozen=True)
class Reach:
    """Extremes of all that was immersed: speed (m/s), depth, height of the lowest point, least and greatest places (m).

    Places are x, in space x and y; there they are found for a bed with a container alone, and else nothing. sizes:
    kinds, with diameters and widths (m), of what was immersed.
    """

    speed: float
    depth: float
    lowest: float
    least: tuple[float, ...]
    greatest: tuple[float, ...]
    sizes: tuple[tuple[Kind, float], ...]


def warnings(scene: Scene, reach: Reach | None, start: float | None, deepest: float | None) -> Iterator[str]:
    """Sentences on all that a run left, by how much, and on what is taken for granted.

    reach: None where nothing could meet the medium; start, deepest: depth (m) of the deepest point, then and of all.
    """
    if scene.bed is not None and reach is not None and reach.depth > 0.0:
        yield from _left(scene.bed, reach, scene.in_space)
    if not scene.media:
        return
    if not scene.settle and not _rolls_in(scene) and start is not None and start > LEAST_START_DEPTH:
        yield f"it starts {start:.4g} m below the surface, as if it had been laid there without moving a grain"
    if deepest is not None and deepest < -ROUND_OFF:  # which is hardly what was meant
        yield f"it never touched the medium: its deepest point came within {-deepest:.4g} m of the surface"


def _rolls_in(scene: Scene) -> bool:
    """Whether the medium at the start is as a motion before it left it."""
    return not scene.in_space and scene.wheel_test is not None and scene.wheel_test.begins


def _left(bed: Bed, reach: Reach, in_space: bool) -> Iterator[str]:
    for medium in dict.fromkeys(layer.medium for layer in bed.layers if reach.depth > layer.top):
        met = tuple(size for kind, size in reach.sizes if kind in medium.takes)
        outside = list(medium.validity.departures(reach.speed, reach.depth, met)) if met else []
        if outside:
            yield f"outside the range that {medium.name} was measured in: {'; '.join(outside)}"
    if bed.floor is not None:
        yield from _floor(bed.floor, reach)
        if not in_space:
            yield from _bare_floor(bed, bed.floor, reach)
    for wall, axis, place, sign in bed.walls:
        beyond = place - reach.least[axis] if sign < 0.0 else reach.greatest[axis] - place
        if beyond > ROUND_OFF:
            yield f"the {wall} wall of the container was passed by {beyond:.4g} m; it carries nothing"


def _floor(floor: Floor, reach: Reach) -> Iterator[str]:
    below = floor.height - reach.lowest
    if below > ROUND_OFF:
        what = "it carries nothing" if floor.stiffness is None else "its contact carried"
        yield f"the floor was reached, the lowest point came {below:.4g} m below it; {what}"


def _bare_floor(bed: Bed, floor: Floor, reach: Reach) -> Iterator[str]:
    """Of a slope, which runs into a level floor sooner or later."""
    for x in (reach.least[0], reach.greatest[0]):
        below = floor.height - float(bed.height(np.array([x]))[0])
        if below > ROUND_OFF:
            yield f"the surface is {below:.4g} m below the floor at x = {x:.4g} m, where the run got"
