"""Stills of a run in space: the mechanism from the right and a little above, on the surface of the sand."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from granular_contact.report.figures.style import DPI, GRID, INK, SAND, SAND_EDGE, SKY, VERMILION, style
from granular_contact.results import Results
from granular_contact.results.motion import Motion

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
AZIMUTH, ELEVATION = np.radians(25.0), np.radians(20.0)  # of the view
MARGIN = 0.12  # of the size of what is shown, around it
COVER = 0.8  # how much of what is in the sand it hides
ARROW = 0.3  # of the height of a picture: the largest force
SHADE = 0.55  # of the colour where a face looks away from the light
LIGHT = np.array([0.3, -0.5, 0.81])


def view() -> Array:
    """Rotation (3, 3): its rows point to the right and upward on the picture, and into it."""
    c, s, ce, se = np.cos(AZIMUTH), np.sin(AZIMUTH), np.cos(ELEVATION), np.sin(ELEVATION)
    return np.array([[c, s, 0.0], [-s * se, c * se, ce], [-s * ce, c * ce, -se]])


def strip(results: Results, count: int, width: int) -> Picture:
    """Pictures (h, w, 3) of `count` (even) instants, evenly spaced, as one that is about so many px wide."""
    motion = results.motion
    assert motion is not None  # which is what makes it a run in space
    surface = float(results.surface) if isinstance(results.surface, int | float) else None
    low, high = _window(motion, surface)
    wide, tall = high - low
    in_row = 2 if wide > tall else count
    rows = count // in_row
    size = width / DPI, width / in_row * tall / wide * rows / DPI
    with style():
        figure = Figure(figsize=size, dpi=DPI, facecolor="white")
        canvas: Any = FigureCanvasAgg(figure)  # whose methods have no types
        for i, k in enumerate(np.linspace(0, len(motion.time) - 1, count).round().astype(int)):
            place = (i % in_row / in_row, 1.0 - (i // in_row + 1) / rows, 1.0 / in_row, 1.0 / rows)
            axes = figure.add_axes(place, xlim=(low[0], high[0]), ylim=(low[1], high[1]))
            axes.set_axis_off()
            axes.set_aspect("equal")
            _draw(axes, motion, int(k), surface, low, high)
        canvas.draw()
        shown: Picture = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    return shown


def _window(motion: Motion, surface: float | None) -> tuple[Array, Array]:
    """Lower left and upper right corner (2,) m of all pictures, on the plane of the picture."""
    points = np.concatenate([motion.points(i).reshape(-1, 3) for i in range(len(motion.parts))])
    if surface is not None:
        points = np.vstack([points, np.column_stack([points[:, :2], np.full(len(points), surface)])])
    shown = points @ view()[:2].T
    low, high = shown.min(axis=0), shown.max(axis=0)
    margin = MARGIN * float((high - low).max())
    return low - margin, high + margin


def _draw(axes: Any, motion: Motion, k: int, surface: float | None, low: Array, high: Array) -> None:
    """One instant: what is in the sand, the sand over it, then what is above."""
    corners, names = _triangles(motion, k)
    middle = corners.mean(axis=1)
    buried = np.zeros(len(corners), bool) if surface is None else middle[:, 2] < surface
    order = np.argsort(-(middle @ view()[2]))
    colours = _colours(corners, names)
    for chosen, height in ((buried, 1), (~buried, 4)):
        kept = order[chosen[order]]
        flat = corners[kept] @ view()[:2].T
        axes.add_collection(
            PolyCollection(
                list(flat), facecolors=colours[kept], edgecolors=colours[kept], linewidths=0.2, zorder=height
            )
        )
    if surface is not None:
        _draw_sand(axes, surface, low, high)
    for point, force in _arrows(motion, k, float(high[1] - low[1])):
        head = dict(
            arrowstyle="-|>,head_width=0.15,head_length=0.3", color=VERMILION, linewidth=1.0, shrinkA=0, shrinkB=0
        )
        axes.annotate("", point + force, point, arrowprops=head, zorder=6)
    words = f"{motion.time[k]:.2f} s"
    axes.text(0.03, 0.95, words, transform=axes.transAxes, va="top", color=INK)


def _draw_sand(axes: Any, surface: float, low: Array, high: Array) -> None:
    """The level surface as a grid of lines seen aslant, which goes on beyond the picture."""
    size = float((high - low).max())
    step = 10.0 ** np.floor(np.log10(0.4 * size))
    center = np.linalg.solve(view()[:2, :2], 0.5 * (low + high) - view()[:2, 2] * surface)
    reach = 4.0 * size
    corners = center + reach * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    ground = np.column_stack([corners, np.full(4, surface)]) @ view()[:2].T
    axes.fill(*ground.T, color=SAND, alpha=COVER, linewidth=0, zorder=2)
    for axis in (0, 1):
        first, last = np.ceil((center[axis] - reach) / step), np.floor((center[axis] + reach) / step)
        for at in step * np.arange(first, last + 1):
            ends = np.full((2, 3), surface)
            ends[:, axis], ends[:, 1 - axis] = at, center[1 - axis] + reach * np.array([-1, 1])
            line = ends @ view()[:2].T
            axes.plot(*line.T, color=SAND_EDGE, linewidth=0.3, alpha=0.5, zorder=3)


def _triangles(motion: Motion, k: int) -> tuple[Array, list[int]]:
    """Triangles (n, 3, 3) m of all parts at an instant, and the part of each."""
    found, parts = [np.zeros((0, 3, 3))], list[int]()
    for i, part in enumerate(motion.parts):
        if part.faces is not None and len(part.faces):
            found.append(motion.points(i)[k][part.faces])
            parts += [i] * len(part.faces)
    return np.concatenate(found), parts


def _colours(corners: Array, parts: list[int]) -> Array:
    """Colours (n, 3): lighter where a face looks to the light; the first part is grey, the others blue."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    bright = SHADE + (1.0 - SHADE) * 0.5 * (1.0 + normal @ (LIGHT / np.linalg.norm(LIGHT)))
    own = np.array([to_rgb(GRID) if i == 0 else to_rgb(SKY) for i in parts]).reshape(-1, 3)
    return np.asarray(np.clip(own * bright[:, None], 0.0, 1.0))


def _arrows(motion: Motion, k: int, height: float) -> list[tuple[Array, Array]]:
    """Where forces of the medium act and how far their arrows reach, on the plane of the picture (2,) m."""
    largest = max(
        (float(np.linalg.norm(np.nan_to_num(f), axis=1).max()) for _, f in motion.forces.values()), default=0.0
    )
    found = []
    for at, force in motion.forces.values():
        if largest > 0.0 and np.linalg.norm(np.nan_to_num(force[k])) > 0.02 * largest:
            found.append((view()[:2] @ at[k], view()[:2] @ force[k] * ARROW * height / largest))
    return found
