"""Figures of many runs: searches, ensembles, Sobol indices, key numbers of a sweep, and wheels against their slip."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from granular_contact.report.figures.panels import column_of, saved_figure
from granular_contact.report.figures.style import BLUE, DOUBLE, FAINT, INK, ORANGE, PALETTE, SINGLE, VERMILION
from granular_contact.report.units import Array, scaled, unit_for

Number = float | None
PANEL = 26.0  # mm
MOST_WORDS = 44  # letters beside an axis


def draw_history(runs: Sequence[tuple[int, Number]], objective: str, greatest: bool, file: Path) -> None:
    """Draw the objective over the runs into a PNG: each run, the best so far, and the spread of each generation.

    runs: generation and value of each run, None for a run that failed or violates a constraint; greatest: whether the
    objective is maximised.
    """
    with saved_figure(file, 66.0) as figure:
        axes = figure.subplots()
        values, index = np.array([value for _, value in runs], dtype=float), np.arange(len(runs))
        label, values = (objective, values) if " " in objective else scaled(objective, values)
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
    """Draw the band between the quartiles of each generation."""
    for i, generation in enumerate(np.unique(generations)):
        members = np.flatnonzero(generations == generation)
        known = values[members][np.isfinite(values[members])]
        if len(known) > 1:
            low, high = np.quantile(known, [0.25, 0.75])
            ends, legend = (members[0] - 0.5, members[-1] + 0.5), "half of a generation" * (i == 1)
            axes.fill_between(ends, low, high, color=FAINT, alpha=0.5, linewidth=0, label=legend)


def draw_parameters(
    tried: Mapping[str, Sequence[Number]],
    ranges: Mapping[str, tuple[float, float, str]],
    allowed: Sequence[bool],
    best: int | None,
    file: Path,
) -> None:
    """Draw the parameters of each run into a PNG, a panel for each parameter, with the best run marked.

    ranges: bounds and scale of each parameter; allowed: whether each run ended and satisfies all constraints.
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


ROW = 38.0  # mm


def draw_bands(time: Array, bands: Mapping[str, Array], file: Path) -> None:
    """Draw quantiles (5, n) of columns, at 5, 25, 50, 75 and 95 %, over time (n,) s into a PNG."""
    unit = unit_for(time, "s")
    with saved_figure(file, 8.0 + ROW * len(bands)) as figure:
        panels = column_of(figure, len(bands))
        for axes, (name, values) in zip(panels, bands.items(), strict=True):
            axis_label, (low, lower, middle, upper, high) = scaled(name, values)
            at = unit.factor * time
            axes.fill_between(at, low, high, color=BLUE, alpha=0.2, linewidth=0, label="5 to 95 % of all runs")
            axes.fill_between(at, lower, upper, color=BLUE, alpha=0.35, linewidth=0, label="25 to 75 %")
            axes.plot(at, middle, color=INK, linewidth=0.8, label="median")
            axes.set_ylabel(axis_label)
        panels[-1].set_xlabel(f"time ({unit.name})")
        panels[-1].set_xlim(0.0, float(unit.factor * time[-1]))
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=3)


def draw_settling(means: Mapping[str, tuple[Array, Array, Array]], file: Path) -> None:
    """Draw means with the half widths of their 95 % intervals over the number of runs, by key, into a PNG."""
    with saved_figure(file, 8.0 + ROW * len(means)) as figure:
        panels = column_of(figure, len(means))
        for axes, (key, (runs, mean, half)) in zip(panels, means.items(), strict=True):
            axis_label, (middle, low, high) = scaled(key, np.array([mean, mean - half, mean + half]))
            axes.fill_between(runs, low, high, color=BLUE, alpha=0.25, linewidth=0, label="95 % interval")
            axes.plot(runs, middle, color=BLUE, label="mean")
            axes.set_ylabel(axis_label)
            # The scale ignores the first quarter, because few runs may agree by chance.
            width = float(np.max((high - low)[[len(high) // 4, -1]], initial=1e-300))
            axes.set_ylim(middle[-1] - 1.5 * width, middle[-1] + 1.5 * width)
        panels[-1].set_xlabel("runs")
        panels[-1].set_xscale("log")
        last = float(next(iter(means.values()))[0][-1])
        ticks = [2.0**k for k in range(1, 40) if 2.0**k <= last]
        panels[-1].set_xticks(ticks, [f"{tick:.0f}" for tick in ticks])
        panels[-1].set_xticks([], minor=True)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)


Bars = tuple[Array, Array]  # indices (inputs,), and the ends of their intervals (2, inputs)


def draw_sensitivity(output: str, inputs: Sequence[str], first: Bars, total: Bars, file: Path) -> None:
    """Draw first-order and total indices into a PNG, the inputs in the order of their total index."""
    order = np.argsort(total[0])  # the greatest on top
    with saved_figure(file, 24.0 + ROW * len(inputs)) as figure:
        axes = figure.subplots()
        places = np.arange(len(inputs))
        kinds = (("first order", first, 0.19, BLUE), ("total", total, -0.19, ORANGE))
        for label, (values, ends), offset, colour in kinds:
            axes.barh(places + offset, values[order], 0.36, color=colour, label=label)
            axes.hlines(places + offset, *ends[:, order], color=INK, linewidth=0.8)
        axes.set_yticks(places, [inputs[i] for i in order])
        axes.set_xlabel(f"part of the variance of {output}")
        axes.set_xlim(min(0.0, float(first[1].min())), None)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0)
        figure.legend(loc="outside upper left", ncols=2)


MOST = 3  # panels, and figures of a sweep


def draw(varied: Mapping[str, Array], key_number: tuple[str, Array], file: Path, *, joined: bool = False) -> None:
    """Draw a key number (key and values (n,)) over each of the varied quantities (n,) into a PNG.

    joined: whether points are joined by a line in the order of the varied quantity.
    """
    axis_label, values = scaled(*key_number)
    shown = [scaled(*quantity) for quantity in list(varied.items())[:MOST]]
    with saved_figure(file, 58.0, SINGLE * (1 if len(shown) < 3 else 1.5)) as figure:
        panels = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
        size = float(np.clip(60.0 / np.sqrt(len(values)), 0.5, 14.0))
        for axes, (name, along) in zip(panels, shown, strict=True):
            axes.scatter(along, values, s=size, color=BLUE, alpha=0.75, linewidths=0)
            if joined:
                order = np.argsort(along)
                axes.plot(along[order], values[order], color=BLUE, linewidth=0.8)
            axes.set_xlabel(name)
            axes.locator_params(axis="x", nbins=5)
        panels[0].set_ylabel(axis_label)


def draw_slip(curves: Mapping[str, Array], file: Path) -> None:
    """Draw curves of wheels, by label (a single one may be empty), into a PNG.

    Each curve (4, n) has slip in rising order, drawbar pull (N), torque (N m) and sinkage (m).
    """
    unit = unit_for(np.concatenate([sinkage for *_, sinkage in curves.values()]), "m")
    with saved_figure(file, 62.0, DOUBLE) as figure:
        panels = figure.subplots(1, 3)
        for i, (label, (slip, pull, torque, sinkage)) in enumerate(curves.items()):
            for axes, values in zip(panels, (pull, torque, unit.factor * sinkage), strict=True):
                axes.plot(slip, values, "o-", color=PALETTE[i % len(PALETTE)], label=label)
        heads = ("drawbar pull (N)", "torque (N\N{MIDDLE DOT}m)", f"sinkage ({unit.name})")
        for axes, head in zip(panels, heads, strict=True):
            axes.set_xlabel("slip")
            axes.set_ylabel(head)
            axes.axvline(0.0, color=INK, linewidth=0.4)
        for axes in panels[:2]:
            axes.axhline(0.0, color=INK, linewidth=0.4)
        if len(curves) > 1:
            figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=min(4, len(curves)))
