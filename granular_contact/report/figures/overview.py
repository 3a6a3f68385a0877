"""One number of all cases of a sweep against each varied quantity."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import BLUE, SINGLE
from granular_contact.report.units import Array, scaled

MOST = 3  # panels, and figures of a sweep


def draw(varied: Mapping[str, Array], found: tuple[str, Array], file: Path) -> None:
    """Draw what was found, a key and its values (n,), over each of the varied quantities (n,), into a PNG."""
    words, values = scaled(*found)
    shown = [scaled(*one) for one in list(varied.items())[:MOST]]
    with saved_figure(file, 58.0, SINGLE * (1 if len(shown) < 3 else 1.5)) as figure:
        panels = figure.subplots(1, len(shown), sharey=True, squeeze=False)[0]
        size = float(np.clip(60.0 / np.sqrt(len(values)), 0.5, 14.0))
        for axes, (name, along) in zip(panels, shown, strict=True):
            axes.scatter(along, values, s=size, color=BLUE, alpha=0.75, linewidths=0)
            axes.set_xlabel(name)
            axes.locator_params(axis="x", nbins=5)
        panels[0].set_ylabel(words)
