"""Warnings where a run leaves the range of its media, passes its floor or leaves its container."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from granular_contact.laws.floor import Floor
from granular_contact.laws.kinds import Kind
from granular_contact.scene.bed import ROUND_OFF, Bed
from granular_contact.scene.types import Scene

LEAST_START_DEPTH = 1e-6  # m: least depth at the start that is reported


@dataclass(frozen=True)
class Reach:
    """Extremes over all immersed points of a run.

    speed: greatest (m/s); depth: greatest (m); lowest: least height (m); least, greatest: of the coordinate x, in space
    of x and y (m). In space the last two are computed only for a bed with a container, otherwise they are empty.
    sizes: kind of shape with its diameter or width (m), for each immersed shape.
    """

    speed: float
    depth: float
    lowest: float
    least: tuple[float, ...]
    greatest: tuple[float, ...]
    sizes: tuple[tuple[Kind, float], ...]


def warnings(scene: Scene, reach: Reach | None, start: float | None, deepest: float | None) -> Iterator[str]:
    """Yield a sentence for each limit that the run exceeded, and for what the model assumes at the start.

    reach: None if no body can meet the medium; start, deepest: depth (m) of the deepest point at the start and over the
    whole run, negative above the surface.
    """
    if scene.bed is not None and reach is not None and reach.depth > 0.0:
        yield from _exceeded(scene.bed, reach, scene.in_space)
    if not scene.media:
        return
    if not scene.settle and not _rolls_in(scene) and start is not None and start > LEAST_START_DEPTH:
        yield (
            f"the mechanism starts {start:.4g} m below the surface, as if it had been laid there without moving a grain"
        )
    if deepest is not None and deepest < -ROUND_OFF:
        yield f"the mechanism never touched the medium: its deepest point came within {-deepest:.4g} m of the surface"


def _rolls_in(scene: Scene) -> bool:
    """Return whether the run starts in the steady motion of a wheel, with the sand as that motion left it."""
    return not scene.in_space and scene.wheel_test is not None and scene.wheel_test.begins


def _exceeded(bed: Bed, reach: Reach, in_space: bool) -> Iterator[str]:
    for medium in dict.fromkeys(layer.medium for layer in bed.layers if reach.depth > layer.top):
        sizes = tuple(size for kind, size in reach.sizes if kind in medium.takes)
        outside = list(medium.validity.departures(reach.speed, reach.depth, sizes)) if sizes else []
        if outside:
            yield f"outside the range that {medium.name} was measured in: {'; '.join(outside)}"
    if bed.floor is not None:
        yield from _floor(bed.floor, reach)
        if not in_space:
            yield from _bare_floor(bed, bed.floor, reach)
    for wall, axis, place, sign in bed.walls:
        beyond = place - reach.least[axis] if sign < 0.0 else reach.greatest[axis] - place
        if beyond > ROUND_OFF:
            yield f"the {wall} wall of the container was passed by {beyond:.4g} m; walls exert no force"


def _floor(floor: Floor, reach: Reach) -> Iterator[str]:
    below = floor.height - reach.lowest
    if below > ROUND_OFF:
        force = "it has no stiffness and exerts no force" if floor.stiffness is None else "its contact carried the load"
        yield f"the floor was reached, the lowest point came {below:.4g} m below it; {force}"


def _bare_floor(bed: Bed, floor: Floor, reach: Reach) -> Iterator[str]:
    """Yield a sentence for each end of the path at which a sloping surface lies below the level floor."""
    for x in (reach.least[0], reach.greatest[0]):
        below = floor.height - float(bed.height(np.array([x]))[0])
        if below > ROUND_OFF:
            yield f"the mechanism reached x = {x:.4g} m, where the surface is {below:.4g} m below the floor"
