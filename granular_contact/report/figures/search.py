"""A search: what its runs are worth, one after another, and which numbers they tried."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from granular_contact.report.figures.panels import column_of, saved_figure
from granular_contact.report.figures.style import BLUE, FAINT, INK, VERMILION
from granular_contact.report.units import Array, scaled

Number = float | None
PANEL = 26.0  # mm
MOST_WORDS = 44  # letters beside an axis


def draw_history(runs: Sequence[tuple[int, Number]], words: str, greatest: bool, file: Path) -> None:
    """Draw the objective over the runs into a PNG: each run, the best so far, and the spread of each generation.

    runs: generation and value of each run, None of one that failed or broke a constraint; greatest: whether greater
    is better.
    """
    with saved_figure(file, 66.0) as figure:
        axes = figure.subplots()
        values, index = np.array([value for _, value in runs], dtype=float), np.arange(len(runs))
        label, values = (words, values) if " " in words else scaled(words, values)
        _spread(axes, np.array([generation for generation, _ in runs]), values)
        axes.plot(index, values, ".", color=BLUE, markersize=3, alpha=0.7, label="run")
        lost = np.isnan(values)
        best = (np.fmax if greatest else np.fmin).accumulate(values)
        axes.step(index, best, where="post", color=VERMILION, label="best so far")
        if lost.any():
            at_foot, low = axes.get_xaxis_transform(), np.full(lost.sum(), 0.02)
            axes.plot(index[lost], low, "x", color=INK, markersize=3, transform=at_foot, label="failed or outside")
        axes.set_xlabel("run")
        axes.set_ylabel(label if len(label) <= MOST_WORDS else "objective")
        axes.set_xlim(0, max(len(runs) - 1, 1))
        figure.legend(loc="outside upper left", ncols=2)


def _spread(axes: Axes, generations: Array, values: Array) -> None:
    """The band between the quartiles of each generation."""
    for i, generation in enumerate(np.unique(generations)):
        there = np.flatnonzero(generations == generation)
        known = values[there][np.isfinite(values[there])]
        if len(known) > 1:
            low, high = np.quantile(known, [0.25, 0.75])
            ends, words = (there[0] - 0.5, there[-1] + 0.5), "half of a generation" * (i == 1)
            axes.fill_between(ends, low, high, color=FAINT, alpha=0.5, linewidth=0, label=words)


def draw_parameters(
    tried: Mapping[str, Sequence[Number]],
    ranges: Mapping[str, tuple[float, float, str]],
    allowed: Sequence[bool],
    best: int | None,
    file: Path,
) -> None:
    """Draw the numbers that each run tried into a PNG, a panel for each parameter, with the best run marked.

    ranges: ends and scale of each; allowed: whether a run came to an end within all constraints.
    """
    with saved_figure(file, 14.0 + PANEL * len(tried)) as figure:
        panels = column_of(figure, len(tried))
        fine = np.array(allowed)
        for axes, (name, numbers) in zip(panels, tried.items(), strict=True):
            start, stop, scale = ranges[name]
            label, shown = scaled(name, np.array([*numbers, start, stop], dtype=float))
            values, (low, high), index = shown[:-2], shown[-2:], np.arange(len(numbers))
            axes.plot(index[fine], values[fine], ".", color=BLUE, markersize=3)
            axes.plot(index[~fine], values[~fine], "x", color=FAINT, markersize=3)
            if best is not None:
                axes.axhline(values[best], color=VERMILION, linewidth=0.8)
            axes.set_yscale(scale)
            edge = 0.03 * abs(high - low) if scale == "linear" else 0.0
            axes.set_ylim(min(low, high) - edge, max(low, high) + edge)
            axes.set_ylabel(label)
        panels[-1].set_xlabel("run")
        panels[-1].set_xlim(0, max(len(fine) - 1, 1))
