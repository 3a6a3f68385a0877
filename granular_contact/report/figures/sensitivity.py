"""Sobol indices of an output as bars: the share of its variance that each input explains, alone and with others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import BLUE, INK, ORANGE

ROW = 8.0  # mm


@dataclass(frozen=True)
class Bars:
    """Indices (inputs,) and the ends of their intervals (2, inputs), with what they are called."""

    label: str
    values: NDArray[np.float64]
    ends: NDArray[np.float64]


def draw_sensitivity(output: str, inputs: Sequence[str], first: Bars, total: Bars, file: Path) -> None:
    """Draw both kinds of indices into a PNG, the inputs in the order of their total."""
    order = np.argsort(total.values)  # the greatest on top
    with saved_figure(file, 24.0 + ROW * len(inputs)) as figure:
        axes = figure.subplots()
        places = np.arange(len(inputs))
        for bars, offset, colour in ((first, 0.19, BLUE), (total, -0.19, ORANGE)):
            axes.barh(places + offset, bars.values[order], 0.36, color=colour, label=bars.label)
            low, high = bars.ends[:, order]
            axes.hlines(places + offset, low, high, color=INK, linewidth=0.8)
        axes.set_yticks(places, [inputs[i] for i in order])
        axes.set_xlabel(f"part of the variance of {output}")
        axes.set_xlim(min(0.0, float(first.ends.min())), None)
        axes.grid(visible=False, axis="y")
        axes.tick_params(axis="y", length=0)
        figure.legend(loc="outside upper left", ncols=2)
