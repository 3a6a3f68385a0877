"""How figures look: the size journals print them, colours and settings of matplotlib.

Colours are those of Okabe and Ito, which colour-blind readers can distinguish; line styles differ, too, for print in
grey.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib

SINGLE, DOUBLE, DPI = 88.0, 180.0, 200  # column widths, mm, and dots per inch
INK, FAINT, GRID = "#262626", "#8C8C8C", "#E9E9E9"
BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7"
PALETTE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
LINES = ("-", "--", "-.", ":")  # styles, of curves in one panel
SAND, SAND_EDGE, FLOOR, GRAINS = "#F1E3C4", "#A98F57", "#8A8378", ("#D9C394", "#C4AB76")
LEGEND_ROW = 3.7  # mm of panel height that one row of a legend takes

_SETTINGS: Any = {  # rcParams
    "text.usetex": False,
    "font.family": "STIXGeneral",  # comes with matplotlib, so figures look alike everywhere
    "mathtext.fontset": "stix",
    "font.size": 8,
    "axes.labelsize": 8,
    "axes.titlesize": 8,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7,
    "text.color": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.edgecolor": INK,
    "axes.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "grid.color": GRID,
    "grid.linewidth": 0.4,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 3,
    "legend.edgecolor": "none",
    "legend.facecolor": "white",
    "legend.framealpha": 1.0,
    "legend.fancybox": False,
    "legend.handlelength": 1.6,
    "legend.handletextpad": 0.5,
    "legend.columnspacing": 1.0,
    "legend.labelspacing": 0.25,
    "legend.borderpad": 0.2,
    "legend.borderaxespad": 0.1,
    "figure.dpi": DPI,
    "figure.constrained_layout.h_pad": 0.03,
    "figure.constrained_layout.w_pad": 0.03,
    "figure.constrained_layout.hspace": 0.03,
}


@contextmanager
def style() -> Iterator[None]:
    """Matplotlib with this module's settings; the caller's are back afterwards."""
    with matplotlib.rc_context(_SETTINGS):
        yield
