"""Contacts and footprints of bodies, and their force against depth."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import DOUBLE, PALETTE, SINGLE
from granular_contact.report.histories import Panel
from granular_contact.report.units import time_unit, unit_for
from granular_contact.results import Results

MOST_ROWS = 16  # greatest number of bodies whose contacts are drawn


def in_contact(results: Results) -> dict[str, list[tuple[float, float]]]:
    """Intervals of contact (s) of each body that touched the medium."""
    labelled = results.summary.get("contacts") or {}
    return {body: [(on, off) for on, off in spans] for body, spans in labelled.items() if spans}


def contacts(results: Results, against: list[Panel]) -> Figure:
    """Figure of the intervals of contact of bodies, of their footprints along x, and of their force against depth."""
    spans = dict(list(in_contact(results).items())[:MOST_ROWS])
    figure = blank(DOUBLE, max(52.0, 20.0 + 5.0 * len(spans)), layout="constrained")
    panels = figure.subplots(1, 3 if against else 2, squeeze=False)[0]
    unit = time_unit(results)
    _bars(panels[0], spans, unit.factor)
    panels[0].set(xlabel=f"time ({unit.name})", title="in the medium")
    places = {body: _places(results, body, ones) for body, ones in spans.items()}
    length = unit_for([end for ones in places.values() for one in ones for end in one], "m")
    _bars(panels[1], places, length.factor)
    panels[1].set(xlabel=f"x ({length.name})", title="footprints")
    panels[1].set_yticklabels([])
    if against:
        _against_depth(panels[2], results, against)
    return figure


def against_depth(results: Results, against: list[Panel]) -> Figure:
    """Vertical force of the medium against depth."""
    figure = blank(SINGLE, 62.0, layout="constrained")
    axes = figure.subplots()
    _against_depth(axes, results, against)
    axes.set_title("")
    return figure


def _places(results: Results, body: str, spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Position x (m) of the centre of a body at the begin and the end of each contact."""
    if f"{body}_x_m" not in results.names:
        return []
    time, x = results["time_s"], results[f"{body}_x_m"]
    return [(float(np.interp(on, time, x)), float(np.interp(off, time, x))) for on, off in spans]


def _bars(axes: Axes, spans: dict[str, list[tuple[float, float]]], factor: float) -> None:
    """Draw a row of bars for each body, the first on top."""
    for i, ones in enumerate(spans.values()):
        bars = [(min(a, b) * factor, max(abs(b - a) * factor, 1e-12)) for a, b in ones]
        axes.broken_barh(bars, (-i - 0.36, 0.72), color=PALETTE[i % len(PALETTE)], alpha=0.75, linewidth=0)
    axes.set_yticks(range(0, -len(spans), -1), list(spans))
    axes.set_ylim(-len(spans) + 0.4, 0.6)
    axes.grid(axis="y", visible=False)


def _against_depth(axes: Axes, results: Results, panels: list[Panel]) -> None:
    """Draw the vertical force of the medium against depth, for each body or for the whole mechanism."""
    forces = [panel.curves[0].values(results.__getitem__) for panel in panels]
    depths = [results[panel.along] for panel in panels]
    newton, length = unit_for(np.concatenate(forces), "N"), unit_for(np.maximum(np.concatenate(depths), 0.0), "m")
    for i, (panel, force, depth) in enumerate(zip(panels, forces, depths, strict=True)):
        under = depth >= 0.0
        label = panel.along.removesuffix("_depth_m") if panel.along != "depth_m" else ""
        x, colour = np.where(under, depth, np.nan) * length.factor, PALETTE[i % len(PALETTE)]
        axes.plot(x, force * newton.factor, color=colour, label=label, linewidth=0.7)
    axes.set(xlabel=f"depth ({length.name})", ylabel=f"vertical force ({newton.name})", title="force against depth")
