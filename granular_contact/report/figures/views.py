"""Views of the plane, and the panels that they fill."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.outlines import add_sand, around, deepest_point, edge, submerged
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import DOUBLE, LEGEND_ROW, SINGLE
from granular_contact.results import Results
from granular_contact.results.frames import surface_height


@dataclass(frozen=True)
class View:
    """A window on the plane: lower left corner, width and height (m, world frame)."""

    title: str
    left: float
    bottom: float
    width: float
    height: float

    def grown(self, share: float) -> View:
        """The view with a margin, a fraction of its larger side."""
        margin = share * max(self.width, self.height)
        wide, high = self.width + 2 * margin, self.height + 2 * margin
        return replace(self, left=self.left - margin, bottom=self.bottom - margin, width=wide, height=high)

    def filling(self, aspect: float) -> View:
        """The smallest view around this one whose width is `aspect` times its height."""
        width, height = max(self.width, self.height * aspect), max(self.height, self.width / aspect)
        left, bottom = self.left - (width - self.width) / 2, self.bottom - (height - self.height) / 2
        return replace(self, left=left, bottom=bottom, width=width, height=height)


@dataclass(frozen=True)
class Panel:
    """Axes and the view that fills them."""

    axes: Axes
    view: View

    def showing(self, other: View) -> Panel:
        """The same axes with a view that takes in the other view too."""
        view = self.view
        left, bottom = min(view.left, other.left), min(view.bottom, other.bottom)
        right = max(view.left + view.width, other.left + other.width)
        top = max(view.bottom + view.height, other.bottom + other.height)
        both = replace(view, left=left, bottom=bottom, width=right - left, height=top - bottom)
        return Panel(self.axes, view if both == view else both.grown(0.03).filling(view.width / view.height))


def whole_view(results: Results) -> View:
    """Everything drawn, and a strip of sand under it."""
    points = np.concatenate([edge(outline) for shot in results.snapshots for outline in shot.outlines])
    low, high = points.min(axis=0), points.max(axis=0)
    add_sand(results.surface, low, high, 0.05)
    return View("mechanism", low[0], low[1], high[0] - low[0], high[1] - low[1]).grown(0.06)


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
    return View("immersed part", left, low[1] - 0.2 * size, right - left, high[1] - low[1] + 0.55 * size)


def side_by_side(views: list[View], legend_rows: int) -> tuple[Figure, list[Panel]]:
    """A figure with one panel a view, side by side, to the same height and as wide as the page; views fill panels."""
    left, right, top, below, gap = 12.5, 2.5, 6.0, 12.0 + LEGEND_ROW * legend_rows, 15.0  # mm
    page = DOUBLE if len(views) > 1 else SINGLE
    aspects = np.array([np.clip(view.width / view.height, 0.75, 2.2) for view in views])
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
