"""Ensembles: bands of histories, and means that settle with the number of runs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from granular_contact.report.figures.panels import column_of, saved_figure
from granular_contact.report.figures.style import BLUE, INK
from granular_contact.report.units import Array, scaled, unit_for

ROW = 38.0  # mm


def draw_bands(time: Array, bands: Mapping[str, Array], file: Path) -> None:
    """Draw quantiles (5, n) of columns, at 5, 25, 50, 75 and 95 %, over time (n,) s into a PNG."""
    unit = unit_for(time, "s")
    with saved_figure(file, 8.0 + ROW * len(bands)) as figure:
        panels = column_of(figure, len(bands))
        for axes, (name, values) in zip(panels, bands.items(), strict=True):
            words, (low, lower, middle, upper, high) = scaled(name, values)
            at = unit.factor * time
            axes.fill_between(at, low, high, color=BLUE, alpha=0.2, linewidth=0, label="5 to 95 % of all runs")
            axes.fill_between(at, lower, upper, color=BLUE, alpha=0.35, linewidth=0, label="25 to 75 %")
            axes.plot(at, middle, color=INK, linewidth=0.8, label="median")
            axes.set_ylabel(words)
        panels[-1].set_xlabel(f"time ({unit.name})")
        panels[-1].set_xlim(0.0, float(unit.factor * time[-1]))
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)


def draw_settling(means: Mapping[str, tuple[Array, Array, Array]], file: Path) -> None:
    """Draw means with half the widths of their 95 % intervals over the number of runs, by key, into a PNG."""
    with saved_figure(file, 8.0 + ROW * len(means)) as figure:
        panels = column_of(figure, len(means))
        for axes, (key, (runs, mean, half)) in zip(panels, means.items(), strict=True):
            words, (middle, low, high) = scaled(key, np.array([mean, mean - half, mean + half]))
            axes.fill_between(runs, low, high, color=BLUE, alpha=0.25, linewidth=0, label="95 % interval")
            axes.plot(runs, middle, color=BLUE, label="mean")
            axes.set_ylabel(words)
            # Of few runs the first ones may agree by chance.
            width = float(np.max((high - low)[[len(high) // 4, -1]], initial=1e-300))
            axes.set_ylim(middle[-1] - 1.5 * width, middle[-1] + 1.5 * width)
        panels[-1].set_xlabel("runs")
        panels[-1].set_xscale("log")
        last = float(next(iter(means.values()))[0][-1])
        ticks = [2.0**k for k in range(1, 40) if 2.0**k <= last]
        panels[-1].set_xticks(ticks, [f"{tick:.0f}" for tick in ticks])
        panels[-1].set_xticks([], minor=True)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
