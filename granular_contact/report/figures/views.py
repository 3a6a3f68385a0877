"""Views of the plane, and the panels that they fill."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.outlines import add_sand, around, deepest_point, edge, submerged
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import DOUBLE, LEGEND_ROW, SINGLE
from granular_contact.report.units import Array
from granular_contact.results import Results
from granular_contact.results.frames import surface_height


@dataclass(frozen=True)
class View:
    """A window on the plane: its lower left and upper right corner (2,) m, world frame."""

    title: str
    low: Array
    high: Array

    @property
    def size(self) -> Array:
        """Width and height (m)."""
        return self.high - self.low

    def grown(self, share: float) -> View:
        """The view with a margin, a fraction of its larger side."""
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
        """The same axes with a view that takes in the other view too."""
        view = self.view
        both = View(view.title, np.minimum(view.low, other.low), np.maximum(view.high, other.high))
        if np.array_equal(both.size, view.size):
            return self
        return Panel(self.axes, both.grown(0.03).filling(view.size[0] / view.size[1]))


def whole_view(results: Results) -> View:
    """Everything drawn, and a strip of sand under it."""
    points = np.concatenate([edge(outline) for shot in results.snapshots for outline in shot.outlines])
    low, high = points.min(axis=0), points.max(axis=0)
    add_sand(results.surface, low, high, 0.05)
    return View("mechanism", low, high).grown(0.06)


def tip_view(results: Results) -> View | None:
    """What is under the surface in any snapshot, with room for the dimension; None if nothing is."""
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
    """A figure with one panel a view, side by side, to the same height and as wide as the page; views fill panels."""
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
