"""Figure of a law: its force against depth, speed and direction of motion."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from granular_contact.report.figures.panels import saved_figure
from granular_contact.report.figures.style import DOUBLE, LINES, PALETTE


def draw_law(title: str, panels: Sequence[Any], file: Path) -> None:
    """Draw panels (of `granular_contact.laws.probe`) side by side into a PNG."""
    with saved_figure(file, 62.0, DOUBLE) as figure:
        figure.suptitle(title, fontsize=8)
        for axes, panel in zip(figure.subplots(1, len(panels)), panels, strict=True):
            for i, curve in enumerate(panel.curves):
                axes.plot(curve.x, curve.y, color=PALETTE[i], linestyle=LINES[i % len(LINES)], label=curve.label)
            axes.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
            axes.set_xlabel(panel.x_label)
            axes.set_ylabel("force (N)")
            axes.set_title(panel.title, fontsize=7)
            if panel.x_label.endswith("(deg)"):
                axes.set_xticks(range(-90, 91, 45))
            axes.legend()
