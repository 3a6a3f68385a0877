"""Style of figures: size of print in journals, colours, and settings of matplotlib (print.mplstyle).

Colours are those of Okabe and Ito, which colour-blind readers can distinguish. Line styles differ as well, for print in
grey.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import matplotlib

SINGLE, DOUBLE, DPI = 88.0, 180.0, 200  # column widths, mm, and dots per inch
INK, FAINT = "#262626", "#8C8C8C"
BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7"
PALETTE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
LINES = ("-", "--", "-.", ":")  # styles, of curves in one panel
SAND, SAND_EDGE, FLOOR, GRAINS = "#F1E3C4", "#A98F57", "#8A8378", ("#D9C394", "#C4AB76")
PIN = {"marker": "o", "markerfacecolor": "white", "linestyle": "none"}  # of a joint with the ground
LEGEND_ROW = 3.7  # mm of panel height that one row of a legend takes

_SETTINGS = matplotlib.rc_params_from_file(Path(__file__).with_name("print.mplstyle"), use_default_template=False)


@contextmanager
def style() -> Iterator[None]:
    """Use the settings of print.mplstyle within the block; the settings of the caller are restored afterwards."""
    with matplotlib.rc_context(_SETTINGS):
        yield
