"""Pictures evenly spaced in time, each with the forces of the medium: the frames of an animation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from granular_contact.geometry.surface import height_at
from granular_contact.results import Force, Outline, Snapshot
from granular_contact.values.arrays import Vector

Pictures = Sequence[tuple[Outline, ...]]

CENTERED = 0.1  # weight of a point's distance from the mean point, relative to its distance from the line of action
RATE = 25  # frames per second of playback
MOST = 151  # default number of frames of a run: six seconds of playback
# Seconds of playback per simulated second; only round numbers, which a viewer understands.
_PACES = sorted(m * 10.0**e for e in range(-6, 10) for m in (1.0, 2.0, 5.0))


class Later(Sequence[Snapshot]):
    """Lazy sequence of pictures: computed at the first access, after which the function that makes them is released.

    Pickling computes the pictures and stores them as a tuple.
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
        """Return one picture, or a slice of the pictures."""
        return self._all[index]

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (list(self._all),)

    def __repr__(self) -> str:
        return "<pictures, not made yet>" if self._make is not None else f"<{len(self._made)} pictures>"


def instants(start: float, end: float, most: int) -> Vector:
    """At most `most` (at least 2) evenly spaced times (s) from start to end, with a spacing that fits one of `_PACES`.

    The last time may be beyond the end by less than one spacing.
    """
    duration = end - start
    if not duration > 0.0:
        return np.array([start])
    slowest = (most - 1) / (RATE * duration)
    pace = max(pace for pace in _PACES if pace <= slowest * (1 + 1e-9))
    count = int(np.ceil(duration * RATE * pace - 1e-6)) + 1
    return start + np.arange(count) / (RATE * pace)


def pace(time: Sequence[float] | Vector) -> float:
    """Seconds of playback per simulated second, for pictures at these times (s); above 1 it is slow motion."""
    if len(time) < 2:
        return 1.0
    exact = (len(time) - 1) / (RATE * (time[-1] - time[0]))
    return min(_PACES, key=lambda pace: abs(np.log(pace / exact)))


def resample(time: Vector, values: Vector, at: Vector) -> Vector:
    """Interpolate values (n, ...) at `time` (n,) linearly at times `at` (k,): (k, ...), constant beyond the ends."""
    flat = values.reshape(len(time), -1)
    return np.stack([np.interp(at, time, column) for column in flat.T], axis=1).reshape(len(at), *values.shape[1:])


def frames(
    at: Vector, pictures: Pictures, loads: Mapping[str, Vector], surface: ArrayLike | None
) -> tuple[Snapshot, ...]:
    """Return a snapshot for each time (k,), with the forces of the medium at their points of action.

    Parameters
    ----------
    at, pictures
        Times (k,) s and the outlines at each time.
    loads
        Forces of the medium, (k, 3) x, y (N) and moment about the origin (N m, counter-clockwise), by body. The name of
        a body is the names of its parts joined by +; the empty name is all parts together.
    surface
        The free surface, see `surface_height`; None in vacuum.
    """
    return tuple(
        Snapshot(
            "frame",
            float(time),
            outlines,
            tuple(_forces(outlines, {body: wrenches[i] for body, wrenches in loads.items()}, surface)),
        )
        for i, (time, outlines) in enumerate(zip(at, pictures, strict=True))
    )


def _forces(outlines: tuple[Outline, ...], wrenches: Mapping[str, Vector], surface: ArrayLike | None) -> list[Force]:
    forces = []
    for body, wrench in wrenches.items():
        parts = [outline for outline in outlines if outline.part in body.split("+")]
        points = immersed(parts or outlines, surface)
        if len(points) and np.any(wrench[:2]):
            forces.append(Force(body, point_of_action(wrench, points), wrench[:2].copy()))
    return forces


def surface_height(surface: ArrayLike, x: ArrayLike) -> Vector:
    """Height (n,) m of the free surface at x (n,) m; surface: one height (m) or corners (k, 2) m, see `Results`."""
    corners, x = np.asarray(surface, dtype=np.float64), np.asarray(x, dtype=np.float64)
    return height_at(np.array([[0.0, float(corners)]]) if corners.ndim == 0 else corners, x)


def take_in(surface: ArrayLike | None, low: Vector, high: Vector, below: float) -> None:
    """Enlarge a window from low to high (2,) m in place so that it shows the surface, if the surface is near.

    below: depth to show under the surface, relative to the size of the window.
    """
    size = max(float(np.max(high - low)), 1e-9)
    if surface is None:
        return
    heights = surface_height(surface, np.linspace(low[0], high[0], 65))
    if heights.max() > low[1] - 2 * size:
        low[1] = min(low[1], heights.min() - below * size)
        high[1] = max(high[1], heights.max())


def immersed(outlines: Sequence[Outline], surface: ArrayLike | None) -> Vector:
    """Points (k, 2) m below the surface, sampled along the lines of outlines and the rims of discs."""
    if surface is None or not outlines:
        return np.zeros((0, 2))
    share = np.linspace(0.0, 1.0, 33)[None, :, None]
    turn = np.linspace(0.0, 2.0 * np.pi, 33)
    samples = []
    for outline in outlines:
        line = outline.points
        if len(line) == 1:
            line = line + 0.5 * outline.diameter * np.column_stack([np.cos(turn), np.sin(turn)])
        samples.append((line[:-1, None] * (1.0 - share) + line[1:, None] * share).reshape(-1, 2))
    points = np.concatenate(samples)
    return np.asarray(points[points[:, 1] <= surface_height(surface, points[:, 0])])


def point_of_action(wrench: Vector, points: Vector) -> Vector:
    """Point at which a force is drawn: the immersed point, of points (k, 2) m, nearest to the line of action.

    wrench: force x, y (N) and moment about the origin (N m). The line of action need not meet the body: it can pass
    between two feet, or far away if the force is small relative to its moment. Of points at equal distance from the
    line, the one nearest to the mean of the points is taken.
    """
    fx, fy, moment = wrench
    size = float(np.hypot(fx, fy))
    from_line = (points[:, 0] * fy - points[:, 1] * fx - moment) / size
    from_mean = np.linalg.norm(points - points.mean(axis=0), axis=1)
    point: Vector = points[np.argmin(np.hypot(from_line, CENTERED * from_mean))]
    return point
