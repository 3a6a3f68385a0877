"""Pictures of a film in the plane: the mechanism in the sand, with forces, the trace of its tip, time and scale.

The background is drawn once; each picture starts from a copy of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from numpy.typing import NDArray

from granular_contact.report.figures.outlines import edge, fixed_points
from granular_contact.report.figures.stage import (
    FLATTEST,
    FOOTER,
    SIDE,
    WIDTH,
    Stage,
    arrow_vector,
    backdrop,
    bounds,
    stage_of,
    strongest,
)
from granular_contact.report.figures.style import INK, PIN, SAND, VERMILION
from granular_contact.report.units import Array, minus, round_below, sized, unit_for
from granular_contact.results import Force, Results, Snapshot
from granular_contact.results.frames import pace, surface_height

Picture = NDArray[np.uint8]

DPI = 100
STEEL, STEEL_EDGE, TRACE = ("#8FB3CD", "#6C98B8"), "#1F4058", "#00486F"
HEAD, SHAFT, LEAST_ARROW = 12.0, 4.0, 2.0  # length of the head, width of the shaft, least length of an arrow (px)
LONGEST_TRACE = 1.0  # greatest length of the trace, relative to the width
_PIN: dict[str, Any] = {**PIN, "markersize": 5.5, "markeredgecolor": STEEL_EDGE, "markeredgewidth": 1.2}
FONT: dict[str, Any] = {"family": "DejaVu Sans", "color": INK, "fontsize": 8.5}


def pictures(results: Results) -> Iterator[Picture]:
    """Yield a picture (height, width, 3) of each frame."""
    return Film(results, stage_of(results)).pictures(results.frames)


def still(results: Results, wide: float, width: int = WIDTH) -> Picture:
    """Picture of the first frame, centred at the mechanism; wide: width in m; width: in px."""
    low, high = bounds(results.frames)
    height = round(FLATTEST * width) // 2 * 2
    scale = width / wide
    left, bottom = 0.5 * (low + high) - 0.5 * np.array([width, height]) / scale
    stage = Stage(float(left), float(bottom), scale, width, height)
    return next(Film(results, stage, texts=False).pictures(results.frames))


class Film:
    """Figure whose moving artists are drawn over a copy of the background."""

    def __init__(self, results: Results, stage: Stage, *, texts: bool = True) -> None:
        """texts: whether to write name, pace and scale of the arrows into the pictures."""
        self.results, self.stage = results, stage
        self.largest = strongest(results.frames)
        figure = Figure(figsize=(self.stage.width / DPI, self.stage.height / DPI), dpi=DPI)
        self.canvas = _canvas(figure)
        self.axes = figure.add_axes((0, 0, 1, 1))
        self.axes.set_axis_off()
        extent = (self.stage.left, self.stage.right, self.stage.bottom, self.stage.top)
        picture = backdrop(self.stage, results)
        self.axes.imshow(picture, extent=extent, interpolation="nearest", aspect="auto")
        self.axes.set_xlim(*extent[:2])
        self.axes.set_ylim(*extent[2:])
        self.trace = self._trace_points()
        steps = np.linalg.norm(np.diff(self.trace[1], axis=0), axis=1)
        self.path = np.concatenate([[0.0], np.cumsum(steps)])
        self.moving = [*self._moving(), *_scale_bar(self.axes, stage), *(self._texts() if texts else ())]
        for artist in self.moving:
            artist.set_animated(True)
        self.canvas.draw()
        self.background = self.canvas.copy_from_bbox(figure.bbox)

    def pictures(self, frames: Sequence[Snapshot]) -> Iterator[Picture]:
        """Yield pictures of the given frames."""
        for frame in frames:
            self.canvas.restore_region(self.background)
            self._show(frame)
            for artist in self.moving:
                self.axes.draw_artist(artist)
            yield np.asarray(self.canvas.buffer_rgba())[..., :3].copy()

    def _texts(self) -> list[Artist]:
        """Texts of name, pace and scale of forces; drawn in each picture, because the front sand would cover them."""
        stage, axes = self.stage, self.axes
        name = self.results.name.replace("_", " ")
        texts = [
            _pixels(axes, stage, SIDE, stage.height - 18, name, weight="bold"),
            _pixels(
                axes,
                stage,
                stage.width - SIDE,
                stage.height - 18,
                pace_text([frame.time for frame in self.results.frames]),
                ha="right",
            ),
        ]
        return [*texts, *(self._force_key() if self.largest > 0.0 else ())]

    def _force_key(self) -> list[Artist]:
        """Arrow of a round force, with its number."""
        newton = round_below(self.largest * 0.5)
        tail = _at(self.stage, SIDE, 0.45 * FOOTER)
        vector = arrow_vector(np.array([newton, 0.0]), self.largest, self.stage)
        shown = _arrows([arrow(tail, tail + vector, self.stage)])
        self.axes.add_collection(shown)
        text = f"{sized(newton, 'N', 'g')} from the medium"
        return [shown, _pixels(self.axes, self.stage, SIDE + vector[0] * self.stage.scale + 8, 0.45 * FOOTER, text)]

    def _moving(self) -> list[Artist]:
        axes, stage = self.axes, self.stage
        first = self.results.frames[0].outlines
        tones = [STEEL[i % 2] for i in range(len(first))]
        self.line = Line2D([], [], color=TRACE, linewidth=1.0, solid_joinstyle="round")
        self.bodies = PolyCollection(
            [], facecolors=tones, edgecolors=STEEL_EDGE, linewidths=0.8 if len(first) < 32 else 0.4
        )
        self.forces = _arrows([])
        self.clock = _pixels(axes, stage, stage.width / 2, stage.height - 18, "", ha="center", weight="bold")
        self.elapsed = Rectangle((stage.left, stage.bottom), 0.0, 3.0 / stage.scale, color=TRACE, linewidth=0)
        self.pins = Line2D(*fixed_points(self.results).T, **_PIN)
        moving: list[Artist] = [self.bodies, self.line, self.pins, self.forces, self.clock, self.elapsed]
        if self.results.surface is not None:
            # Transparent sand in front of immersed bodies.
            x = np.linspace(stage.left, stage.right, stage.width)
            line = np.column_stack([x, surface_height(self.results.surface, x)])
            corners = np.vstack([[stage.left, stage.bottom], line, [stage.right, stage.bottom]])
            moving.insert(2, Polygon(corners, color=SAND, alpha=0.22, linewidth=0))
        for artist in moving:
            if artist is not self.clock:
                axes.add_artist(artist)
        return moving

    def _trace_points(self) -> tuple[Array, Array]:
        has = {column.name for column in self.results.columns}
        up = "tip_z_m" if "tip_z_m" in has else "tip_y_m"
        if not {"tip_x_m", up} <= has:
            return np.zeros(0), np.zeros((0, 2))
        return self.results["time_s"], np.column_stack([self.results["tip_x_m"], self.results[up]])

    def _tail(self, until: int) -> int:
        """First row of the trace that ends at a row: the last part of the path, as long as the picture is wide."""
        if until == 0:
            return 0
        begin = self.path[until - 1] - LONGEST_TRACE * (self.stage.right - self.stage.left)
        return int(np.searchsorted(self.path, begin))

    def _show(self, frame: Snapshot) -> None:
        self.bodies.set_verts([edge(outline) for outline in frame.outlines])
        time, tip = self.trace
        until = int(np.searchsorted(time, frame.time, side="right"))
        self.line.set_data(*tip[self._tail(until) : until].T)
        self.forces.set_verts([corners for force in frame.forces if (corners := self._arrow(force)) is not None])
        frames = self.results.frames
        self.clock.set_text(time_text(frame.time, frames[-1].time))
        share = (frame.time - frames[0].time) / max(frames[-1].time - frames[0].time, 1e-300)
        self.elapsed.set_width(share * (self.stage.right - self.stage.left))

    def _arrow(self, force: Force) -> Array | None:
        """Arrow at the point of application, with a length proportional to the force; None if it is too short."""
        vector = arrow_vector(force.force, self.largest, self.stage)
        if float(np.linalg.norm(vector)) * self.stage.scale < LEAST_ARROW:
            return None
        return arrow(force.point, force.point + vector, self.stage)


def _canvas(figure: Figure) -> Any:
    """Return an Agg canvas, untyped because its methods have no type annotations."""
    return FigureCanvasAgg(figure)


def arrow(tail: Array, tip: Array, stage: Stage) -> Array:
    """Corners (7, 2) m of an arrow; the head of a short arrow is smaller."""
    vector = tip - tail
    length = float(np.linalg.norm(vector)) * stage.scale
    along = vector / max(float(np.linalg.norm(vector)), 1e-300)
    across = np.array([-along[1], along[0]])
    head = min(HEAD, 0.7 * length)
    size = head / HEAD
    upper = [(0, SHAFT / 2 * size), (length - head, SHAFT / 2 * size), (length - head, 0.48 * head)]
    px = np.array([*upper, (length, 0), *((x, -y) for x, y in reversed(upper))])
    return np.asarray(tail + (px[:, :1] * along + px[:, 1:] * across) / stage.scale)


def _arrows(corners: list[Array]) -> PolyCollection:
    return PolyCollection(corners, facecolors=VERMILION, edgecolors="white", linewidths=0.6)


def _at(stage: Stage, x: float, y: float) -> Array:
    """Point (2,) m at a distance in px from the lower left corner."""
    return np.array([stage.left + x / stage.scale, stage.bottom + y / stage.scale])


def _pixels(axes: Axes, stage: Stage, x: float, y: float, text: str, **look: Any) -> Any:
    left, bottom = _at(stage, x, y)
    return axes.text(left, bottom, text, va="center_baseline", **{**FONT, **look})


def _scale_bar(axes: Axes, stage: Stage) -> list[Artist]:
    length = round_below(0.22 * stage.width / stage.scale)
    y, right = 0.38 * FOOTER, float(stage.width - SIDE)
    left = right - length * stage.scale
    corners = np.array([_at(stage, *px) for px in ((left, y + 3), (left, y), (right, y), (right, y + 3))])
    bar = axes.plot(*corners.T, color=INK, linewidth=1.2, solid_joinstyle="miter")
    return [*bar, _pixels(axes, stage, (left + right) / 2, y + 10, sized(length, "m", "g"), ha="center")]


def time_text(seconds: float, end: float) -> str:
    """Format an instant of a film that ends at `end` (s), with the same width for all instants."""
    unit = unit_for(end, "s")
    digits = 2 if end * unit.factor < 10 else 1 if end * unit.factor < 100 else 0
    number = f"{seconds * unit.factor:.{digits}f}"
    width = len(f"{end * unit.factor:.{digits}f}")
    return minus(f"{number:>{width}} {unit.name}").replace(" ", "\N{FIGURE SPACE}", width - len(number))


def pace_text(time: Sequence[float] | Array) -> str:
    """Text on the speed of playback of a film with pictures at these times (s)."""
    factor = pace(time)
    if factor == 1.0:
        return "real time"
    return f"{factor:g} times slowed down" if factor > 1.0 else f"{1 / factor:g} times sped up"
