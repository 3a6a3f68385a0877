"""Figures of the measurements with their scatter, and of the models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, ScalarFormatter
from numpy.typing import NDArray

from granular_contact.laws.law import Law
from granular_contact.report.figures.panels import blank
from granular_contact.report.figures.style import DOUBLE, DPI, FAINT, INK, PALETTE, SINGLE, style
from validation.measurements import cmu, others

Vector = NDArray[np.float64]

FIGURES = Path(__file__).parents[1] / "figures"
DASHES = ("-", "--", "-.")
CAPTIONS = {
    "plates": "Pressure under two plates, and the force on the wheel pressed in",
    "wheel": "Force and sinkage of the rolling wheel over slip",
    "ball": "Depth and stopping time of a dropped ball",
    "drag": "Drag of a plate over speed",
}


def plates(models: dict[str, Law]) -> None:
    """Draw both plates and the pressed wheel, (a) to (c)."""
    table = cmu.table("plates_large_box")
    with style():
        figure = blank(DOUBLE, 66.0, layout="constrained")
        axes = figure.subplots(1, 3)
        for panel, size, letter in zip(axes[:2], (60, 80), "ab", strict=True):
            same_size = table["diameter_mm"] == size
            depth = np.linspace(0.0, 1.03e-3 * table["depth_mm"][same_size].max(), 60)
            for i, medium in enumerate(models.values()):
                pressure = 1e-3 * cmu.plate_pressure(medium, depth, size)
                panel.plot(1e3 * depth, pressure, color=PALETTE[i], linestyle=DASHES[i])
            rows = table[same_size]
            panel.errorbar(rows["depth_mm"], rows["pressure_kPa"], rows["sd_kPa"], fmt="o", color=INK, capsize=2)
            title = f"({letter}) plate of {size} mm" + (", two of them fitted" if size == 60 else ", predicted")
            panel.set(xlabel="depth (mm)", ylabel="pressure (kPa)", xlim=(0, None), ylim=(0, None))
            panel.set_title(title, loc="left")
        _pressed(axes[2], models)
        _legend(figure, axes[2])
        _save(figure, "plates")


def _pressed(panel: Axes, models: dict[str, Law]) -> None:
    wheel = cmu.table("wheel_smooth_pressed_in")
    depth = np.linspace(1e-4, 0.041, 60)
    for i, (name, medium) in enumerate(models.items()):
        low, high = (cmu.pressed_wheel(medium, bound, depth) for bound in cmu.BOUNDS)
        panel.fill_between(1e3 * depth, low, high, color=PALETTE[i], alpha=0.15, linewidth=0)
        panel.plot(1e3 * depth, low, color=PALETTE[i], linestyle=DASHES[i], label=name)
        panel.plot(1e3 * depth, high, color=PALETTE[i], linestyle=DASHES[i], linewidth=0.6)
    scatter = 0.1 * wheel["force_N"]
    panel.errorbar(wheel["depth_mm"], wheel["force_N"], scatter, fmt="o", color=INK, capsize=2, label="measured")
    panel.set(xlabel="depth (mm)", ylabel="force (N)", xlim=(0, None), ylim=(0, None))
    panel.set_title("(c) wheel pressed in, predicted", loc="left")


def rolling(media: dict[str, Law]) -> None:
    """Draw forward force and sinkage over slip; bands span the results of both stated sizes of the wheel."""
    data = cmu.rolling()
    slip = np.array([x.slip for x in data])
    with style():
        figure = blank(DOUBLE, 74.0, layout="constrained")
        left, right = figure.subplots(1, 2)
        for i, (name, medium) in enumerate(media.items()):
            computed = np.array([cmu.rolled(medium, bound) for bound in cmu.BOUNDS])
            for panel, values in ((left, computed[:, :, 1]), (right, 1e3 * computed[:, :, 0])):
                panel.fill_between(slip, *values, color=PALETTE[i], alpha=0.2, linewidth=0)
                panel.plot(slip, values.mean(axis=0), color=PALETTE[i], linestyle=DASHES[i], label=name)
        force, within = np.array([(x.force, x.within) for x in data]).T
        left.errorbar(slip, force, within, fmt="o", color=INK, capsize=2, label="measured (bars: within a run)")
        sinkage, spread = 1e3 * np.array([(x.sinkage, x.sinkage_sd) for x in data]).T
        right.errorbar(slip, sinkage, spread, fmt="o", color=INK, capsize=2)
        left.axhline(0.0, color=FAINT, linewidth=0.5)
        left.set(xlabel="slip", ylabel="forward force on the wheel (N)")
        right.set(xlabel="slip", ylabel="sinkage (mm)", ylim=(0, None))
        left.set_title("(a) all predicted", loc="left")
        right.set_title("(b) at the measured load", loc="left")
        _legend(figure, left)
        _save(figure, "wheel")


def ball(drops: others.Ball) -> None:
    """Draw depth over total drop distance, and stopping time over impact speed."""
    heights, speed = others.HEIGHTS, np.sqrt(2.0 * others.G * others.HEIGHTS)
    with style():
        figure = blank(DOUBLE, 62.0, layout="constrained")
        left, right = figure.subplots(1, 2)
        total = heights + drops.depth
        band = {"color": PALETTE[0], "alpha": 0.25, "linewidth": 0}
        left.fill_between(total, *(1e3 * drops.depth_band), label="errors of k/m and d1 as stated", **band)
        left.loglog(total, 1e3 * drops.depth, "o-", color=PALETTE[0], label="preset, in the engine")
        third = 1e3 * drops.depth[2] * (total / total[2]) ** others.EXPONENT
        left.loglog(total, third, color=INK, linestyle="--", label="slope 1/3 (other spheres, measured)")
        left.set(xlabel="drop height + depth (m)", ylabel="depth (mm)")
        for axis in (left.xaxis, left.yaxis):
            axis.set_major_formatter(ScalarFormatter())
            axis.set_minor_formatter(NullFormatter())
        left.set_xticks([0.03, 0.1, 0.3, 1.0])
        left.set_yticks([20, 30, 40, 60, 80])
        left.legend(loc="upper left")
        right.fill_between(speed, *(1e3 * drops.time_band), **band)
        right.plot(speed, 1e3 * drops.time, "o-", color=PALETTE[0])
        right.set(xlabel="impact speed (m/s)", ylabel="stopping time (ms)", ylim=(0, None))
        _save(figure, "ball")


def drag(medium: Law) -> None:
    """Draw the drag of the plate by the formula of its source and by the preset."""
    speed = np.linspace(0.04, 0.64, 60)
    with style():
        figure = blank(SINGLE, 66.0, layout="constrained")
        axes = figure.subplots()
        for i, depth in enumerate(others.DEPTHS):
            label = f"drft, {1e3 * depth:.0f} mm deep"
            axes.plot(speed, others.dragged(medium, depth, speed), color=PALETTE[i], linestyle=DASHES[i], label=label)
            label_of_source = "formula of the source" if i == 0 else None
            axes.plot(others.SPEEDS, others.source(depth, others.SPEEDS), "o", color=INK, label=label_of_source)
        axes.set(xlabel="speed (m/s)", ylabel="drag of one metre of width (N)", ylim=(0, None))
        axes.legend(loc="lower right", ncols=2)
        _save(figure, "drag")


def _legend(figure: Figure, panel: Axes) -> None:
    handles, labels = panel.get_legend_handles_labels()
    labels = [label.replace("k z^n", "$k z^n$") for label in labels]
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))


def _save(figure: Figure, name: str) -> None:
    FIGURES.mkdir(exist_ok=True)
    figure.savefig(FIGURES / f"measured_{name}.png", dpi=DPI, metadata={"Software": None})
