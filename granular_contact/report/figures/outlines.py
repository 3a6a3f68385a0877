"""Geometry of outlines of the mechanism: edges, fixed points, immersed points, the deepest point; hinges of a run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from granular_contact.report.figures.style import FLOOR, SAND, SAND_EDGE
from granular_contact.report.units import Array
from granular_contact.results import Outline, Results, Snapshot
from granular_contact.results.frames import surface_height

NEAR = 4.0  # distance from the deepest point, in depths, up to which points are shown in the enlarged view
SHARPEST = 3.0  # greatest length of a mitre at a corner, in half diameters


def edge(outline: Outline) -> Array:
    """Closed edge (m, 2) m of an outline; the edge of a bar is its axis offset to both sides by half the diameter."""
    points, radius = outline.points, outline.diameter / 2
    if len(points) == 1:
        turn = np.linspace(0, 2 * np.pi, 65)[:-1]
        return np.asarray(points + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
    if is_closed(outline):
        return points[:-1]
    aside = radius * _normals(points)
    return np.concatenate([points + aside, (points - aside)[::-1]])


def is_closed(outline: Outline) -> bool:
    """Return whether an outline bounds an area."""
    return len(outline.points) > 3 and bool(np.array_equal(outline.points[0], outline.points[-1]))


def draw_bed(
    axes: Axes, x: Array, top: Array, bottom: float, layers: Sequence[float], floor: float | None, factor: float
) -> None:
    """Draw the medium from its surface, heights top (n,) m at x (n,) m, down to a height, with its layers and floor.

    layers: depths (m); floor: height (m). factor: from m to the unit of the axes.
    """
    x, top, bottom = factor * x, factor * top, factor * bottom
    axes.fill_between(x, bottom, top, color=SAND, linewidth=0, zorder=0)
    axes.plot(x, top, color=SAND_EDGE, linewidth=0.9, zorder=2)
    for depth in layers:
        axes.plot(x, top - factor * depth, color=SAND_EDGE, linewidth=0.6, dashes=(5, 3), zorder=2)
    if floor is not None and factor * floor > bottom:
        axes.axhspan(bottom, factor * floor, facecolor=FLOOR, linewidth=0, zorder=2)


def _normals(points: Array) -> Array:
    """Left normals (n, 2) of a line, with mitres: longer at corners, so that the width of the bar stays constant."""
    along = np.diff(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    before, after = np.vstack([left[:1], left]), np.vstack([left, left[-1:]])
    mitre = (before + after) / np.maximum(1 + np.sum(before * after, axis=1, keepdims=True), 2 / SHARPEST**2)
    return np.asarray(mitre)


def _dense(ring: Array) -> Array:
    """Points along a closed edge, fifty per side."""
    share = np.linspace(0, 1, 50)[None, :, None]
    return np.asarray((ring[:, None] * (1 - share) + np.roll(ring, -1, axis=0)[:, None] * share).reshape(-1, 2))


def submerged(shot: Snapshot, surface: ArrayLike) -> Array:
    """Points (k, 2) m on edges below the surface."""
    points = np.concatenate([_dense(edge(outline)) for outline in shot.outlines])
    return np.asarray(points[points[:, 1] < surface_height(surface, points[:, 0])])


def around(points: Array, x: float, depth: float) -> Array:
    """Restrict points (k, 2) to those near x (m), if they spread widely compared with the depth (m), as feet do."""
    if not len(points) or np.ptp(points[:, 0]) <= 2 * NEAR * depth:
        return points
    return np.asarray(points[np.abs(points[:, 0] - x) <= NEAR * depth])


def fixed_points(results: Results) -> Array:
    """Points (k, 2) m that stay fixed, as hinges on the ground; if nothing moves, the first point of a hinged model."""
    # In space the outlines of frames have other points than those of snapshots.
    pictures = [*results.frames] or [*results.snapshots]
    if not pictures:
        return np.zeros((0, 2))
    shots = [np.concatenate([outline.points for outline in picture.outlines]) for picture in pictures]
    first = shots[0]
    moved = np.max([np.linalg.norm(shot - first, axis=1) for shot in shots], axis=0)
    if not moved.max() > 0:
        return first[:1] if hinges_of(results) else first[:0]
    still = first[moved < 0.01 * moved.max()]
    size = float(np.max(np.ptp(first, axis=0)))
    kept: list[Array] = []
    for point in still:
        if all(np.linalg.norm(point - other) > 0.02 * size for other in kept):
            kept.append(point)
    return np.array(kept).reshape(-1, 2)


@dataclass(frozen=True)
class Deepest:
    """The deepest point: x (m), height of the surface there (m) and depth (m).

    side: +1 or -1, direction along x with free space for a dimension; clear: x of the end of the body on this side (m).
    """

    x: float
    surface: float
    depth: float
    side: float
    clear: float


def deepest_point(results: Results) -> Deepest | None:
    """Find the point of the largest depth in all snapshots (on the axis of a bar, or the rim of a disc)."""
    depth, surface = results.summary.get("max_depth_m"), results.surface
    if surface is None or depth is None or not depth > 0 or not results.snapshots:
        return None
    candidates = []
    for shot in results.snapshots:
        low = [o.points if len(o.points) > 1 else o.points - (0, o.diameter / 2) for o in shot.outlines]
        points = np.concatenate(low)
        miss = np.abs(surface_height(surface, points[:, 0]) - points[:, 1] - depth)
        candidates.append((float(miss.min()), float(points[miss.argmin(), 0]), shot))
    _, x, shot = min(candidates, key=lambda entry: entry[0])
    side = 1.0 if x >= np.median(np.concatenate([o.points for o in shot.outlines])[:, 0]) else -1.0
    under = around(submerged(shot, surface), x, float(depth))
    clear = side * float(np.max(side * under[:, 0], initial=side * x))
    return Deepest(x, float(surface_height(surface, x)), float(depth), side, clear)


@dataclass(frozen=True)
class Hinge:
    """A hinge: columns of its angle and rate; whether they are relative to the ground."""

    angle: str
    rate: str
    on_ground: bool


def hinges_of(results: Results) -> list[Hinge]:
    """Hinges of a run, in the order of the columns."""
    names = {column.name for column in results.columns}
    rates = ((column, column.name.replace("_angle_deg", "_rate_rad_s")) for column in results.columns)
    return [
        Hinge(column.name, rate, "relative to" not in column.description)
        for column, rate in rates
        if rate != column.name and rate in names
    ]
