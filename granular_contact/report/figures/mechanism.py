"""Figure of the mechanism in the plane at touch, at its deepest and at the end, to scale, in the sand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon, Rectangle

from granular_contact.report.figures.outlines import (
    around,
    deepest_point,
    draw_bed,
    edge,
    fixed_points,
    hinges_of,
    submerged,
)
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import (
    DOUBLE,
    GRAINS,
    INK,
    LEGEND_ROW,
    PIN,
    SINGLE,
    VERMILION,
)
from granular_contact.report.units import Array, Unit, instant, minus, sized, unit_for
from granular_contact.results import Results, Snapshot
from granular_contact.results.frames import surface_height, take_in
from granular_contact.results.interpolation import at_times

_POSES: dict[str, dict[str, Any]] = {
    "touch": {"facecolor": "#D4D4D4", "edgecolor": "#7A7A7A", "zorder": 3},
    "end": {"facecolor": "#6FA8CC", "edgecolor": "#00486F", "zorder": 4},
    "deepest": {"facecolor": "none", "edgecolor": VERMILION, "zorder": 5},
}
_PIVOT: dict[str, Any] = {**PIN, "markersize": 4.5, "markeredgecolor": INK, "markeredgewidth": 0.9}


def mechanism(results: Results) -> Figure:
    """Figure of the mechanism at touch, at its deepest and at the end, with the immersed part enlarged beside it.

    The three poses are overlaid, because a link turns by a few degrees only: three pictures would look the same.
    """
    whole = whole_view(results)
    tip = tip_view(results)
    figure, panels = side_by_side(
        [whole] if tip is None else [whole, tip], legend_rows=1 if tip else len(results.snapshots) + 1
    )
    if tip is not None:
        tip = panels[1].view
        panels[0] = panels[0].showing(tip)
    unit = unit_for(whole.size, "m")
    for panel in panels:
        _scene(panel.axes, results, unit, panel.view)
    pivots = fixed_points(results)
    for x, y in pivots:
        panels[0].axes.plot(x * unit.factor, y * unit.factor, zorder=6, **_PIVOT)
    if tip is not None:
        _outline_view(panels[0].axes, tip, unit)
        _dimension_depth(panels[1].axes, results, unit)
    handles: list[Artist] = [Patch(**_pose(shot), label=_caption(results, shot)) for shot in results.snapshots]
    if len(pivots):
        handles.append(Line2D([], [], label="pivot", **_PIVOT))
    figure.legend(handles=handles, loc="lower center", ncols=4 if tip is not None else 1, borderaxespad=0.4)
    return figure


def _scene(axes: Axes, results: Results, unit: Unit, view: View) -> None:
    """Draw sand and all snapshots within `view`, to scale."""
    axes.set(xlabel=f"x ({unit.name})", ylabel=f"y ({unit.name})")
    axes.grid(False)
    axes.locator_params(nbins=6)
    for side in axes.spines.values():
        side.set_visible(True)
    _sand(axes, results, view, unit)
    for shot in results.snapshots:
        for outline in shot.outlines:
            look = {**_pose(shot), "linewidth": 0.7}
            axes.add_patch(Polygon(edge(outline) * unit.factor, **look))
    (left, bottom), (right, top) = view.low * unit.factor, view.high * unit.factor
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")


def _sand(axes: Axes, results: Results, view: View, unit: Unit) -> None:
    """Draw the medium below its surface, with decorative grains, layers and floor."""
    surface = results.surface
    if surface is None:
        return
    (left, bottom), (right, _) = view.low, view.high
    x = np.linspace(left, right, 401)
    top = surface_height(surface, x)
    if top.max() <= bottom:
        return
    draw_bed(axes, x, top, bottom, results.layers, results.floor, unit.factor)
    place = np.random.default_rng(7)
    width, height = view.size
    depth = min(float(top.max()) - bottom, height)
    count = int(2500 * depth / height)
    for colour in GRAINS:
        across, up = left + width * place.random(count // 2), bottom + depth * place.random(count // 2)
        size = place.uniform(0.05, 0.9, count // 2)
        under = up < surface_height(surface, across)
        across, up = across[under] * unit.factor, up[under] * unit.factor
        axes.scatter(across, up, s=size[under], color=colour, linewidths=0, zorder=1)


def _pose(shot: Snapshot) -> dict[str, Any]:
    """Patch style of the mechanism in a snapshot."""
    return _POSES.get(shot.label, _POSES["touch"])


def _caption(results: Results, shot: Snapshot) -> str:
    """Name and time of a snapshot, and the angle of the pivot."""
    caption = f"{shot.label}: {instant(results, shot.time)}"
    pivot = next((hinge for hinge in hinges_of(results) if hinge.on_ground), None)
    if pivot is None or not len(results.table):
        return caption
    history = results["time_s"], results[pivot.angle], np.degrees(results[pivot.rate])
    angle = float(at_times(*history, np.array([shot.time]))[0])
    return f"{caption}, {minus(f'{angle:.2f}')}°"


def _outline_view(axes: Axes, view: View, unit: Unit) -> None:
    """Draw a thin frame around the enlarged view."""
    corner, size = view.low * unit.factor, view.size * unit.factor
    axes.add_patch(Rectangle(tuple(corner), *size, fill=False, edgecolor=INK, linewidth=0.5, zorder=7))


def _dimension_depth(axes: Axes, results: Results, unit: Unit) -> None:
    """Dimension the largest depth as in a drawing: extension line, double arrow and number beside the body."""
    deepest = deepest_point(results)
    if deepest is None:
        return
    side, margin = deepest.side, 0.06 * float(np.ptp(axes.get_xlim()))
    x, at = deepest.x * unit.factor, deepest.clear * unit.factor + side * margin
    top, low = deepest.surface * unit.factor, (deepest.surface - deepest.depth) * unit.factor
    axes.plot([x, at + 0.3 * side * margin], [low, low], color=INK, linewidth=0.5, zorder=8)
    head = {"arrowstyle": "<|-|>,head_width=0.12,head_length=0.3", "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (at, top), (at, low), arrowprops={**head, "linewidth": 0.6, "color": INK}, zorder=8)
    text = f"depth\n{sized(deepest.depth, 'm', '.2f')}"
    align: dict[str, Any] = {"ha": "left" if side > 0 else "right", "va": "center"}
    middle = (at, (top + low) / 2)
    axes.annotate(text, middle, (4 * side, 0), textcoords="offset points", zorder=9, **align)


@dataclass(frozen=True)
class View:
    """A rectangular window on the plane: lower left and upper right corner (2,) m, world frame."""

    title: str
    low: Array
    high: Array

    @property
    def size(self) -> Array:
        """Width and height (m)."""
        return self.high - self.low

    def grown(self, share: float) -> View:
        """The view with a margin; share: of its larger side."""
        margin = share * self.size.max()
        return View(self.title, self.low - margin, self.high + margin)

    def filling(self, aspect: float) -> View:
        """The smallest view around this one whose width is `aspect` times its height."""
        margin = np.maximum(self.size, self.size[::-1] * [aspect, 1 / aspect]) - self.size
        return View(self.title, self.low - margin / 2, self.high + margin / 2)


@dataclass(frozen=True)
class Panel:
    """Axes and the view that fills them."""

    axes: Axes
    view: View

    def showing(self, other: View) -> Panel:
        """The same axes with a view that contains the other view as well."""
        view = self.view
        both = View(view.title, np.minimum(view.low, other.low), np.maximum(view.high, other.high))
        if np.array_equal(both.size, view.size):
            return self
        return Panel(self.axes, both.grown(0.03).filling(view.size[0] / view.size[1]))


def whole_view(results: Results) -> View:
    """View of the whole mechanism in all snapshots, with a strip of sand."""
    points = np.concatenate([edge(outline) for shot in results.snapshots for outline in shot.outlines])
    low, high = points.min(axis=0), points.max(axis=0)
    take_in(results.surface, low, high, 0.05)
    return View("mechanism", low, high).grown(0.06)


def tip_view(results: Results) -> View | None:
    """View of the immersed part in all snapshots, with space for the dimension; None if nothing is immersed."""
    deepest = deepest_point(results)
    if results.surface is None or deepest is None:
        return None
    under = np.concatenate([submerged(shot, results.surface) for shot in results.snapshots])
    under = around(under, deepest.x, deepest.depth)
    if not len(under):
        return None
    low, right = under.min(axis=0), float(under[:, 0].max())
    high = np.array([right, surface_height(results.surface, np.linspace(low[0], right, 65)).max()])
    size = float(np.max(high - low))
    left, right = low[0] - 0.15 * size, high[0] + 0.15 * size
    beside = deepest.clear + 0.7 * deepest.side * size
    left, right = min(left, beside), max(right, beside)
    corners = (left, low[1] - 0.2 * size), (right, high[1] + 0.35 * size)
    return View("immersed part", *np.array(corners))


def side_by_side(views: list[View], legend_rows: int) -> tuple[Figure, list[Panel]]:
    """Figure with one panel per view, side by side with equal height, as wide as the page; views fill their panels."""
    left, right, top, below, gap = 12.5, 2.5, 6.0, 12.0 + LEGEND_ROW * legend_rows, 15.0  # mm
    page = DOUBLE if len(views) > 1 else SINGLE
    aspects = np.array([np.clip(view.size[0] / view.size[1], 0.75, 2.2) for view in views])
    free = page - left - right - gap * (len(views) - 1)
    height = float(np.clip(free / aspects.sum(), 45, 82))
    widths = free * aspects / aspects.sum()
    figure = blank(page, top + height + below)
    panels, at = [], left
    for i, (view, width) in enumerate(zip(views, widths, strict=True)):
        box = (at / page, below / (top + height + below), width / page, height / (top + height + below))
        axes = figure.add_axes(box)
        axes.set_title(f"({'ab'[i]}) {view.title}" if len(views) > 1 else "", loc="left", pad=3)
        panels.append(Panel(axes, view.filling(width / height)))
        at += width + gap
    return figure, panels
