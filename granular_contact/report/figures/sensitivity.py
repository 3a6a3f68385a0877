"""Sobol indices of an output as bars: the share of its variance that each input explains, alone and with others."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import BLUE, INK, ORANGE
from granular_contact.report.units import Array

ROW = 8.0  # mm


Bars = tuple[Array, Array]  # indices (inputs,), and the ends of their intervals (2, inputs)


def draw_sensitivity(output: str, inputs: Sequence[str], first: Bars, total: Bars, file: Path) -> None:
    """Draw indices of first order and total ones into a PNG, the inputs in the order of their total."""
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
