"""Figures over time: panels of `report.histories`, of one run or of several on a common time axis."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure

from granular_contact.report.drawn import drawn
from granular_contact.report.figures.panels import curve, finish, fitting_columns, mark_events, save, stacked
from granular_contact.report.figures.style import BLUE, FAINT, LINES, PALETTE, VERMILION, style
from granular_contact.report.histories import Curve, Group, Panel, Values, panel
from granular_contact.report.overlay import history, panels, table
from granular_contact.report.units import label, split
from granular_contact.results import Results

PANEL = 31.0  # mm
WIDEST = 20  # greatest number of letters in a line beside a panel
MOST_NAMED = 6  # greatest number of curves in a panel that all have a label
BENT = ("deflection", "twist", "greatest strain")  # beginning of the titles of panels of flexible links
NOT_DRAWN = ("speed of sliders",)  # panels of the page that the figures leave out


def of_groups(results: Results, groups: Sequence[Group]) -> dict[str, Callable[[], Figure]]:
    """Functions that make the figures over time of a run, by name: one for each group, and one of flexible links."""
    return {name: partial(stack, shown, results.__getitem__, results) for name, shown in _figures(groups)}


def _figures(groups: Sequence[Group]) -> Iterator[tuple[str, list[Panel]]]:
    """Names of figures and their panels, for all groups but the depth."""
    for group in groups:
        deflections = [panel for panel in group.panels if panel.title.startswith(BENT)]
        others = [panel for panel in group.panels if panel not in deflections and panel.title not in NOT_DRAWN]
        if others and group.name != "depth":
            yield group.name, others
        if deflections:
            yield "deflection", deflections


def draw_runs(runs: Sequence[tuple[str, Results]], folder: Path, reference: str = "") -> None:
    """Draw several runs (name and results) into PNG files in a folder, with a curve for each run.

    reference: name of the reference run, for differences.
    """
    columns = table([history(*run) for run in runs])
    groups = panels([name for name, _ in runs], columns, reference)
    with style():
        for name, shown in _figures(groups):
            with drawn(folder / f"{name}.png") as file:
                save(stack(shown, columns.__getitem__), file)


def chosen(results: Results, names: Sequence[str]) -> Figure:
    """Figure of the named columns over time, with one panel for each unit.

    Raises
    ------
    ValueError
        No column is named.
    KeyError
        A column does not exist.
    """
    if not names:
        raise ValueError(f"plot() needs the name of a column; there are: {', '.join(results.names)}")
    units: dict[str, list[Curve]] = {}
    for name in names:
        units.setdefault(split(name)[1], []).append(Curve(label(name), ((name, 1.0),)))
    shown = [
        panel(alike[0].label if len(alike) == 1 else "", alike[0].terms[0][0], alike, results.__getitem__)
        for alike in units.values()
    ]
    return stack(shown, results.__getitem__, results)


def stack(panels: Sequence[Panel], column: Values, of_run: Results | None = None) -> Figure:
    """Figure of panels below each other; curves of one label have one style. Touch and stop of `of_run` are marked."""
    figure, axes, time = stacked(column("time_s"), 9.0 + PANEL * len(panels), len(panels))
    looks = _looks(panels)
    named: set[str] = set()
    for ax, shown in zip(axes, panels, strict=True):
        labels = [drawn_curve.label for drawn_curve in shown.curves]
        many = len(labels) > MOST_NAMED
        in_legend = [] if len(labels) == 1 or set(labels) <= named else [labels[0], labels[-1]] if many else labels
        named |= set(labels)
        for drawn_curve in shown.curves:
            colour, line = looks[drawn_curve.label] if len(labels) > 1 else (BLUE, "-")
            text = drawn_curve.label if drawn_curve.label in in_legend else ""
            values = drawn_curve.values(column) * shown.unit.factor
            curve(ax, time, values, colour, text, linestyle=line, linewidth=0.9)
        if _crosses_zero(ax):
            ax.axhline(0, color=FAINT, linewidth=0.5, zorder=1.5)
        text = shown.heading.replace(" of joints", "").replace(" of drives", "")
        finish(ax, fill(text, WIDEST, break_long_words=False), fitting_columns(in_legend, 3))
    if of_run is not None:
        mark_events(of_run, axes)
    return figure


def _looks(panels: Sequence[Panel]) -> dict[str, tuple[str, str]]:
    """Colour and line style of each label: distinct for few labels, a scale from blue to vermilion for many."""
    several = [shown.label for panel in panels if len(panel.curves) > 1 for shown in panel.curves]
    names_of_labels = {text: text.split(", ")[0] for text in several}  # of curves that are drawn as one
    names = list(dict.fromkeys(names_of_labels.values()))
    if len(names) <= len(PALETTE):
        looks = {name: (PALETTE[i], LINES[i % len(LINES)]) for i, name in enumerate(names)}
    else:
        ends = np.array([to_rgb(BLUE), to_rgb(VERMILION)])
        shares = np.linspace(0.0, 1.0, len(names))
        looks = {name: (to_hex([1.0 - x, x] @ ends), "-") for name, x in zip(names, shares, strict=True)}
    return {text: looks[name] for text, name in names_of_labels.items()}


def _crosses_zero(axes: Axes) -> bool:
    """Return whether zero is within or near the range of the curves."""
    values = np.concatenate([np.asarray(line.get_ydata(), float) for line in axes.lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return low - 0.1 * (high - low) <= 0.0 <= high + 0.1 * (high - low)
