"""Figures of the study."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from granular_contact import scene
from granular_contact.config import load
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import BLUE, DOUBLE, DPI, FAINT, INK, SKY, VERMILION, style
from granular_contact.run import run
from validation.single_mode.cases import CONFIG, MEASURES, Case, Point, models
from validation.single_mode.numbers import NUMBERS, SATURATED, fit


def draw_map(points: Sequence[Point], file: Path) -> None:
    """Draw maps of the error over EI ratio and speed, by model and measure."""
    grid = [p for p in points if p.case.family == "EI, speed"]
    stiffness = sorted({p.case.stiffness for p in grid})
    speeds = sorted({p.case.speed for p in grid})
    at = {(p.case.stiffness, p.case.speed): p for p in grid}
    colours = BoundaryNorm([1e-5, 1e-4, 1e-3, 1e-2, 5e-2, 0.2, 1.0], 256, extend="both")
    with style():
        figure = blank(DOUBLE, 130.0, layout="constrained")
        axes = figure.subplots(3, 3, sharex=True, sharey=True)
        for row, model in zip(axes, ("rigid", "one", "two"), strict=True):
            for axis, measure in zip(row, MEASURES, strict=True):
                if model == "rigid" and measure == "deflection":
                    axis.set_axis_off()
                    continue
                tiles = np.array([[at[k, w].error(model, measure) for k in stiffness] for w in speeds])
                image = axis.imshow(
                    np.minimum(tiles, 10.0), origin="lower", cmap="cividis_r", norm=colours, aspect="auto"
                )
                _borders(axis, tiles)
                for i, w in enumerate(speeds):
                    for j, k in enumerate(stiffness):
                        _mark(axis, j, i, tiles[i, j], at[k, w].known(model, measure))
                axis.set_title(f"{NAMES[model]}, {measure}")
                axis.grid(visible=False)
                axis.set_xticks(range(len(stiffness)), [f"$10^{{{round(math.log10(k))}}}$" for k in stiffness])
                axis.set_yticks(range(len(speeds)), [f"{w:g}" for w in speeds])
            row[0].set_ylabel("impact speed (rad/s)")
        for axis in axes[-1]:
            axis.set_xlabel("$EI$ / that of the paper")
        bar = figure.colorbar(image, ax=axes, shrink=0.6)
        bar.set_label("relative error (in the tiles: per cent); lines: 1 % (orange), 5 % (blue)")
        bar.set_ticks(
            [1e-5, 1e-4, 1e-3, 1e-2, 5e-2, 0.2, 1.0],
            labels=["0.001 %", "0.01 %", "0.1 %", "1 %", "5 %", "20 %", "100 %"],
        )
        figure.savefig(file, dpi=DPI)


NAMES = {"rigid": "rigid", "one": "one mode", "two": "two modes"}


def _mark(axis: Axes, x: int, y: int, error: float, known: bool) -> None:
    """Write the error into a tile, with hatching if the difference of the beams makes it uncertain."""
    if not known:
        axis.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, fill=False, hatch="/////", linewidth=0, edgecolor=FAINT))
    text = (
        "no stop"
        if math.isinf(error)
        else "?"
        if math.isnan(error)
        else "<.001"
        if error < 1e-5
        else f"{100 * error:.2g}"
    )
    axis.text(x, y, text, ha="center", va="center", fontsize=5.5, color="white" if error > 0.01 else INK)


def _borders(axis: Axes, tiles: NDArray[np.float64]) -> None:
    """Draw lines between tiles within a limit and tiles beyond it."""
    for limit, colour in ((0.01, VERMILION), (0.05, SKY)):
        out = ~(tiles <= limit)
        for i, j in np.argwhere(out[:, 1:] != out[:, :-1]):
            axis.plot([j + 0.5, j + 0.5], [i - 0.5, i + 0.5], color=colour, linewidth=1.6)
        for i, j in np.argwhere(out[1:] != out[:-1]):
            axis.plot([j - 0.5, j + 0.5], [i + 0.5, i + 0.5], color=colour, linewidth=1.6)


MARKERS = {"EI, speed": "o", "density": "s", "length": "^", "angle": "D"}


def draw_collapse(points: Sequence[Point], number: str, file: Path) -> None:
    """Draw errors over one dimensionless number, with a marker for each family of cases."""
    with style():
        figure = blank(DOUBLE, 75.0, layout="constrained")
        panels = figure.subplots(1, 3, sharex=True, sharey=True)
        for axis, measure in zip(panels, MEASURES, strict=True):
            for model, colour in (("rigid", FAINT), ("one", BLUE), ("two", VERMILION)):
                if model == "rigid" and measure == "deflection":
                    continue
                _scatter(axis, points, number, model, measure, colour)
                f = fit(points, number, model, measure)
                if f.r2 > 0.5:
                    x = np.array([f.threshold(1e-6), f.threshold(SATURATED)])
                    label = f"{NAMES[model]}: {f.c:.2g} $N^{{{f.p:.2f}}}$, $R^2$ {f.r2:.2f}"
                    axis.plot(x, f.c * x**f.p, color=colour, label=label)
            for limit in (0.01, 0.05):
                axis.axhline(limit, color=INK, linewidth=0.5, linestyle="--")
            axis.set(xscale="log", yscale="log", ylim=(1e-7, 1e3), xlabel=f"$N$ = {WORDS[number]}", title=measure)
            axis.legend(loc="upper left") if axis.get_legend_handles_labels()[0] else None
        panels[0].set_ylabel("relative error (lines: 1 %, 5 %)")
        for family, marker in MARKERS.items():
            panels[2].plot([], [], marker, color=BLUE, label=family)
        panels[2].plot([], [], "x", color=FAINT, label="in doubt, or below the beams' own")
        panels[2].legend(loc="upper left")
        figure.savefig(file, dpi=DPI)


WORDS = {
    "F L^2 / EI": r"$F L^2 / EI$",
    "1 / (w1 T)": r"$1/(\omega_1 T)$",
    "peak deflection of the beam / L": "peak deflection / $L$",
    "sag / z": "sag / depth",
    "sag / (R Q)": "sag / tip travel",
    "speed / w1": r"$\dot q_1(0) / \omega_1$",
}


def _scatter(axis: Axes, points: Sequence[Point], number: str, model: str, measure: str, colour: str) -> None:
    for p in points:
        error = p.error(model, measure)
        if not math.isfinite(error):
            continue
        clear = p.known(model, measure) and 3.0 * p.doubt(measure) < error
        marker = MARKERS[p.case.family] if clear else "x"
        axis.plot(NUMBERS[number](p), error, marker, color=colour, markersize=2.6, markeredgewidth=0.4)


EXAMPLES = (Case("EI, speed", 1.0, 20.0), Case("EI, speed", 0.1, 6.24), Case("EI, speed", 1e-2, 6.24))
CURVES = {"rigid": (FAINT, "-."), "one": (BLUE, "--"), "two": (VERMILION, ":"), "fine": (INK, "-")}


def draw_examples(points: Sequence[Point], file: Path) -> None:
    """Draw the mean rate of three cases by every model, over time relative to the rigid stopping time."""
    with style():
        figure = blank(DOUBLE, 60.0, layout="constrained")
        panels = figure.subplots(1, 3, sharex=True, sharey=True)
        for axis, case in zip(panels, EXAMPLES, strict=True):
            stop = next(p for p in points if p.case == case).rigid["T"]
            by_model = models(stop, 1.4, {"fine": (16, 400)})
            for name, (colour, line) in CURVES.items():
                values = {**case.values, **by_model[name]}
                overrides = [f"{key}={json.dumps(value)}" for key, value in values.items()]
                scenario = load(CONFIG, [*overrides, "solver.rest_time_s=null"]).scenario
                results = run(scene.build(scenario), scenario)
                label = {"fine": "beam"}.get(name) or NAMES[name]
                rate = results["mean_rate_rad_s"] / case.speed
                axis.plot(results["time_s"] / stop, rate, line, color=colour, label=label, linewidth=0.9)
            axis.set(title=f"$EI$ ratio {case.stiffness:g}, {case.speed:g} rad/s", xlabel="time / rigid stopping time")
        panels[0].set(ylim=(-0.15, 1.1), ylabel="mean rate / impact speed")
        panels[0].legend(loc="upper right")
        figure.savefig(file, dpi=DPI)
