"""Columns of the table over time, as chosen by name: those of one unit in one panel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from granular_contact.report.figures.panels import curve, finish, fitting_columns, mark_events, stacked
from granular_contact.report.figures.style import PALETTE
from granular_contact.report.units import label, scaled, split
from granular_contact.results import Results

PANEL = 45.0  # mm


def chosen(results: Results, names: Sequence[str]) -> Figure:
    """A figure of columns over time.

    Raises
    ------
    ValueError
        No column is named.
    KeyError
        There is no such column.
    """
    if not names:
        raise ValueError(f"plot() needs the name of a column; there are: {', '.join(results.names)}")
    units: dict[str, list[str]] = {}
    for name in names:
        units.setdefault(split(name)[1], []).append(name)
    figure, panels, time = stacked(results, 12.0 + PANEL * len(units), (1.0,) * len(units))
    for axes, alike in zip(panels, units.values(), strict=True):
        words, values = scaled(alike[0], np.array([results[name] for name in alike]))
        labels = [label(name) for name in alike]
        several = len(alike) > 1
        for i, part in enumerate(values):
            curve(axes, time, part, PALETTE[i % len(PALETTE)], labels[i] if several else "")
        unit = words.rpartition("(")[2].rstrip(")") if several else ""
        finish(axes, unit or words, columns=fitting_columns(labels, 3) if several else 0)
    mark_events(results, panels)
    return figure
