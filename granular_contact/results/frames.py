"""Pictures evenly spaced in time, with the force of the medium in each: what an animation is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from granular_contact.geometry.surface import height_at
from granular_contact.results import Force, Outline, Snapshot
from granular_contact.values.arrays import Vector

Pictures = Sequence[tuple[Outline, ...]]

CENTERED = 0.1  # how much a point's distance from the middle counts beside that from the line of action
RATE = 25  # pictures a second when played
MOST = 151  # pictures of a run unless another number is asked for: six seconds
# Seconds played for one second simulated: what a viewer can make sense of.
_PACES = sorted(m * 10.0**e for e in range(-6, 10) for m in (1.0, 2.0, 5.0))


class Later(Sequence[Snapshot]):
    """Pictures that are made when one of them is first asked for; what makes them is let go then.

    They go to another process as they are, made.
    """

    def __init__(self, make: Callable[[], Sequence[Snapshot]]) -> None:
        self._make: Callable[[], Sequence[Snapshot]] | None = make
        self._made: tuple[Snapshot, ...] = ()

    @property
    def _all(self) -> tuple[Snapshot, ...]:
        if self._make is not None:
            self._made, self._make = tuple(self._make()), None
        return self._made

    def __len__(self) -> int:
        return len(self._all)

    @overload
    def __getitem__(self, index: int) -> Snapshot: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Snapshot, ...]: ...

    def __getitem__(self, index: int | slice) -> Snapshot | tuple[Snapshot, ...]:
        """A picture, or some of them."""
        return self._all[index]

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (list(self._all),)

    def __repr__(self) -> str:
        return "<pictures, not made yet>" if self._make is not None else f"<{len(self._made)} pictures>"


def instants(start: float, end: float, most: int) -> Vector:
    """At most `most` (from 2) evenly spaced times (s) from start to end, so that one of the paces plays them.

    The last one may be past the end by less than a picture.
    """
    duration = end - start
    if not duration > 0.0:
        return np.array([start])
    slowest = (most - 1) / (RATE * duration)
    pace = max(p for p in _PACES if p <= slowest * (1 + 1e-9))
    count = int(np.ceil(duration * RATE * pace - 1e-6)) + 1
    return start + np.arange(count) / (RATE * pace)


def pace(time: Sequence[float] | Vector) -> float:
    """Seconds played for one second simulated, of pictures at these times (s): above 1 it is slow motion."""
    if len(time) < 2:
        return 1.0
    exact = (len(time) - 1) / (RATE * (time[-1] - time[0]))
    return min(_PACES, key=lambda p: abs(np.log(p / exact)))


def resample(time: Vector, values: Vector, at: Vector) -> Vector:
    """Values (n, ...) at `time` (n,), interpolated linearly at the times (k,), and held beyond the ends: (k, ...)."""
    flat = values.reshape(len(time), -1)
    return np.stack([np.interp(at, time, one) for one in flat.T], axis=1).reshape(len(at), *values.shape[1:])


def frames(
    at: Vector, pictures: Pictures, loads: Mapping[str, Vector], surface: ArrayLike | None
) -> tuple[Snapshot, ...]:
    """A snapshot for each time (k,).

    Parameters
    ----------
    at, pictures
        Times (k,) s and the outlines at each.
    loads
        Forces of the medium on bodies, (k, 3) x, y (N) and moment about the origin (N m, counter-clockwise), by their
        names: those of their parts with a + between; an empty one is all parts together.
    surface
        The free surface, see `surface_height`; None in vacuum.
    """
    return tuple(
        Snapshot("frame", float(t), outlines, tuple(_forces(outlines, {p: w[i] for p, w in loads.items()}, surface)))
        for i, (t, outlines) in enumerate(zip(at, pictures, strict=True))
    )


def _forces(outlines: tuple[Outline, ...], wrenches: Mapping[str, Vector], surface: ArrayLike | None) -> list[Force]:
    found = []
    for body, wrench in wrenches.items():
        own = [outline for outline in outlines if outline.part in body.split("+")]
        under = immersed(own or outlines, surface)
        if len(under) and np.any(wrench[:2]):
            found.append(Force(body, point_of_action(wrench, under), wrench[:2].copy()))
    return found


def surface_height(surface: ArrayLike, x: ArrayLike) -> Vector:
    """Height (n,) m of the free surface at x (n,) m: level at a number, or with corners (k, 2) m, see `Results`."""
    corners, x = np.asarray(surface, dtype=np.float64), np.asarray(x, dtype=np.float64)
    return height_at(np.array([[0.0, float(corners)]]) if corners.ndim == 0 else corners, x)


def take_in(surface: ArrayLike | None, low: Vector, high: Vector, below: float) -> None:
    """Let a window from low to high (2,) m take in the surface, if it is near, and `below` of its size under that."""
    size = max(float(np.max(high - low)), 1e-9)
    if surface is None:
        return
    sand = surface_height(surface, np.linspace(low[0], high[0], 65))
    if sand.max() > low[1] - 2 * size:
        low[1] = min(low[1], sand.min() - below * size)
        high[1] = max(high[1], sand.max())


def immersed(outlines: Sequence[Outline], surface: ArrayLike | None) -> Vector:
    """Points (k, 2) m along the lines of outlines, and on the rims of discs, that are below the surface."""
    if surface is None or not outlines:
        return np.zeros((0, 2))
    share = np.linspace(0.0, 1.0, 33)[None, :, None]
    turn = np.linspace(0.0, 2.0 * np.pi, 33)
    found = []
    for outline in outlines:
        line = outline.points
        if len(line) == 1:
            line = line + 0.5 * outline.diameter * np.column_stack([np.cos(turn), np.sin(turn)])
        found.append((line[:-1, None] * (1.0 - share) + line[1:, None] * share).reshape(-1, 2))
    points = np.concatenate(found)
    return np.asarray(points[points[:, 1] <= surface_height(surface, points[:, 0])])


def point_of_action(wrench: Vector, under: Vector) -> Vector:
    """Where a force is drawn: of the immersed points (k, 2) m, the one nearest to its line of action.

    wrench: force x, y (N) and moment about the origin (N m). The line itself may pass beside the body: between two
    feet, or, of a force that nearly vanishes beside its moment, far away. Of points as near, the middle one is taken.
    """
    fx, fy, moment = wrench
    size = float(np.hypot(fx, fy))
    beside = (under[:, 0] * fy - under[:, 1] * fx - moment) / size
    off = np.linalg.norm(under - under.mean(axis=0), axis=1)
    point: Vector = under[np.argmin(np.hypot(beside, CENTERED * off))]
    return point
