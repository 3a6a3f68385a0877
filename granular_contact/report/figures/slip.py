"""Drawbar pull, torque and sinkage of a wheel against its slip."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import DOUBLE, INK, PALETTE
from granular_contact.report.units import Array


def draw_slip(curves: Mapping[str, Array], file: Path) -> None:
    """Draw curves by their labels (one label may be empty) into a PNG; sinkage grows downward.

    Each (4, n) is of one wheel: slip in rising order, pull (N), torque (N m) and sinkage (m).
    """
    with saved_figure(file, 62.0, DOUBLE) as figure:
        panels = figure.subplots(1, 3)
        for i, (label, (slip, pull, torque, sinkage)) in enumerate(curves.items()):
            for axes, values in zip(panels, (pull, torque, 1e3 * sinkage), strict=True):
                axes.plot(slip, values, "o-", color=PALETTE[i % len(PALETTE)], label=label)
        for axes, words in zip(panels, ("drawbar pull (N)", "torque (N\N{MIDDLE DOT}m)", "sinkage (mm)"), strict=True):
            axes.set_xlabel("slip")
            axes.set_ylabel(words)
            axes.axvline(0.0, color=INK, linewidth=0.4)
        for axes in panels[:2]:
            axes.axhline(0.0, color=INK, linewidth=0.4)
        panels[2].invert_yaxis()
        if len(curves) > 1:
            figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=min(4, len(curves)))
