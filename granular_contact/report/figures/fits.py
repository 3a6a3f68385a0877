"""Figures of a fit: data and model with its bands, residuals, and correlations of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granular_contact.report.drawn import drawn
from granular_contact.report.figures.panels import blank, column_of, save
from granular_contact.report.figures.style import BLUE, DOUBLE, FAINT, INK, SINGLE, SKY, VERMILION, style
from granular_contact.report.units import Array, Unit, unit_for

Estimate = tuple[str, float, float]  # of a shared parameter: label, value and standard error
MOST_RUNS = 24  # greatest number of runs with their own figure


@dataclass(frozen=True)
class RunPicture:
    """One run with its measured columns, each in its own unit.

    noise: (columns,); `quantile` times the noise contains 95 % of the rows. data, residuals: (n, columns); model,
    half_width of its 95 % band: (m, columns). time, fine: abscissa of the data (n,) and of the curves (m,), time (s) or
    another quantity, with label and unit.
    """

    name: str
    columns: tuple[str, ...]
    noise: Array
    quantile: float
    data: Array
    residuals: Array
    model: Array
    half_width: Array
    time: Array
    fine: Array
    label: str
    unit: str

    @property
    def clock(self) -> Unit:
        """Unit of the axis."""
        return unit_for(self.fine, self.unit) if self.unit in ("s", "m") else Unit(1.0, self.unit)

    @property
    def pieces(self) -> list[slice]:
        """Pieces of the curve with increasing abscissa: a table of a force test may contain several trials."""
        back = np.flatnonzero(np.diff(self.fine) < 0.0) + 1
        edges = [0, *back.tolist(), len(self.fine)]
        return [slice(a, b) for a, b in pairwise(edges) if b - a > 1]


def draw(
    runs: Sequence[RunPicture], estimates: Sequence[Estimate], correlation: Array, misfit: bool, directory: Path
) -> None:
    """Write a figure for each of the first runs, one of all residuals, and one of the correlations.

    correlation: (p, p), of the shared parameters.
    """
    with style():
        for i, run in enumerate(runs[:MOST_RUNS], 1):
            with drawn(directory / f"run_{i:02d}.png") as file:
                save(overlay(run), file)
        with drawn(directory / "residuals.png") as file:
            save(residuals(runs, misfit), file)
        if len(estimates) > 1:
            with drawn(directory / "correlation.png") as file:
                save(correlations(estimates, correlation), file)


def overlay(run: RunPicture) -> Figure:
    """Data and model of one run: a panel for each column with its residuals below."""
    count = len(run.columns)
    figure = blank(SINGLE, 12.0 + 52.0 * count, layout="constrained")
    grid = column_of(figure, 2 * count, height_ratios=(2.6, 1.0) * count)
    clock = run.clock
    for k, column in enumerate(run.columns):
        suffix = column.rpartition("_")[2]
        base = {"deg": "", "Nm": "N m"}.get(suffix, suffix)  # SI unit, with which prefixes go; empty of angles
        unit, rest = (unit_for(of[:, k], base) if base else Unit(1.0, "deg") for of in (run.data, run.residuals))
        _curves(grid[2 * k], run, k, clock, unit)
        _residuals(grid[2 * k + 1], run, k, clock, rest)
    grid[0].set_title(run.name, loc="left")
    grid[0].legend(loc="best")
    grid[-1].set_xlabel(f"{run.label} ({clock.name})" if clock.name else run.label)
    return figure


def _curves(axes: Axes, run: RunPicture, k: int, clock: Unit, unit: Unit) -> None:
    fine, model, sure = run.fine * clock.factor, run.model[:, k] * unit.factor, run.half_width[:, k] * unit.factor
    new = np.hypot(sure, run.quantile * run.noise[k] * unit.factor)
    for i, piece in enumerate(run.pieces):
        labels = ("95 % of new data", "95 % of the model", "model") if i == 0 else (None, None, None)
        x, y, w, s = fine[piece], model[piece], new[piece], sure[piece]
        axes.fill_between(x, y - w, y + w, color=SKY, alpha=0.3, linewidth=0, label=labels[0])
        axes.fill_between(x, y - s, y + s, color=BLUE, alpha=0.5, linewidth=0, label=labels[1])
        axes.plot(x, y, color=INK, linewidth=0.7, label=labels[2])
    time, data = run.time * clock.factor, run.data[:, k] * unit.factor
    axes.plot(time, data, "o", color=VERMILION, markersize=1.8, label="data")
    axes.set_ylabel(f"{run.columns[k].rpartition('_')[0].replace('_', ' ')} ({unit.name})")


def _residuals(axes: Axes, run: RunPicture, k: int, clock: Unit, unit: Unit) -> None:
    most = run.quantile * run.noise[k] * unit.factor
    axes.axhspan(-most, most, color=SKY, alpha=0.3, linewidth=0)
    fine, sure = run.fine * clock.factor, run.half_width[:, k] * unit.factor
    for piece in run.pieces:
        axes.fill_between(fine[piece], -sure[piece], sure[piece], color=BLUE, alpha=0.5, linewidth=0)
    axes.axhline(0.0, color=FAINT, linewidth=0.5)
    axes.plot(run.time * clock.factor, run.residuals[:, k] * unit.factor, "o", color=VERMILION, markersize=1.8)
    axes.set_ylabel(f"residual ({unit.name})")


def residuals(runs: Sequence[RunPicture], misfit: bool) -> Figure:
    """Residuals in units of the noise: of all runs over their relative time, and their distribution."""
    figure = blank(DOUBLE, 62.0, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(2.2, 1.0), sharey=True)
    values = np.concatenate([(run.residuals / run.noise).ravel() for run in runs])
    most, bins = _histogram(values)
    for run in runs:
        share = np.linspace(0.0, 1.0, len(run.time))
        if run.unit == "s":
            share = (run.time - run.time[0]) / (run.time[-1] - run.time[0])
        for column in (run.residuals / run.noise).T:
            left.plot(share, column, ".", color=BLUE, markersize=1.5 if len(values) > FEW else 5.0, alpha=0.6)
            beyond = np.abs(column) > most
            left.plot(share[beyond], 0.97 * most * np.sign(column[beyond]), "x", color=VERMILION, markersize=3)
    left.axhline(0.0, color=FAINT, linewidth=0.5)
    timed = all(run.unit == "s" for run in runs)
    left.set(xlabel=f"share of the {'time' if timed else 'rows'} of each run", ylabel="residual / noise", xlim=(0, 1))
    left.set_ylim(-most, most)
    beyond = int(np.sum(np.abs(values) > most))
    heading = "misfit: see fit.json" if misfit else "all runs"
    left.set_title(f"{heading}; crosses: {beyond} beyond these axes" if beyond else heading, loc="left")
    right.hist(values, bins, orientation="horizontal", density=True, color=SKY)
    normal = np.linspace(-most, most, 301)
    right.plot(np.exp(-(normal**2) / 2) / np.sqrt(2 * np.pi), normal, color=INK, linewidth=0.7, label="normal")
    right.set_xlabel("density")
    right.legend(loc="upper right")
    return figure


FEW = 100  # residuals, below which each is drawn so large that it is seen
LEAST, TIMES = 4.5, 2.0  # of the axis, in units of the noise; and in quantiles of 99 % of the residuals
MOST_BINS = 60


def _histogram(values: Array) -> tuple[float, Array]:
    """Half the length of the axis of residuals, and edges of bins, by quantiles, which single outliers do not change.

    The width of bins is that of Freedman and Diaconis (1981), 2 IQR / n^(1/3).
    """
    quarter, three, far = np.quantile(np.append(values, -values), [0.25, 0.75, 0.99])
    most = max(LEAST, TIMES * float(far))
    width = 2.0 * float(three - quarter) / len(values) ** (1 / 3)
    count = 2.0 * most / width if width > 0.0 else MOST_BINS
    return most, np.linspace(-most, most, int(np.clip(count, 8, MOST_BINS)) + 1)


def correlations(estimates: Sequence[Estimate], correlation: Array) -> Figure:
    """Correlation of the shared parameters, with values and standard errors beside their names."""
    count = len(estimates)
    size = min(30.0 + 15.0 * count, DOUBLE)
    figure = blank(size + 24.0, size, layout="constrained")
    axes = figure.subplots()
    axes.imshow(correlation, cmap="RdBu_r", vmin=-1, vmax=1)
    for i in range(count):
        for j in range(count):
            value = correlation[i, j]
            if np.isfinite(value):
                colour = "white" if abs(value) > 0.6 else INK
                axes.text(j, i, f"{value:+.2f}".replace("-", "\N{MINUS SIGN}"), ha="center", va="center", color=colour)
    lines = [f"{label}\n{value:.4g} ± {error:.2g}" for label, value, error in estimates]
    axes.set_xticks(range(count), [label for label, _, _ in estimates], rotation=30, ha="right")
    axes.set_yticks(range(count), lines)
    axes.grid(False)
    axes.set_title("correlation of the errors", loc="left")
    return figure
