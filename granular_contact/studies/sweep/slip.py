"""Figure of drawbar pull, torque and sinkage of a wheel against its slip, for sweeps that vary the slip."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from granular_contact.config import Sweep
from granular_contact.report import FIGURES
from granular_contact.studies.sweep.journal import Row

SLIP = "wheel.slip"
COLUMNS = ("wheel.slip", "wheel.drawbar_pull_N", "wheel.torque_Nm", "wheel.sinkage_m")
FIGURE = "wheel_over_slip.png"
MOST = 6  # greatest number of curves


def write(sweep: Sweep, rows: Iterable[Row], folder: Path) -> None:
    """Draw the figure of a sweep that varies the slip, with a curve for each combination of the other values.

    A figure that fails is a `FigureWarning`.

    Parameters
    ----------
    sweep : Sweep
        The sweep; one that does not vary the slip has no such figure.
    rows : iterable of Row
        Results of the cases. Failed cases, and cases without a needed number, are left out.
    folder : Path
        An existing folder.
    """
    if SLIP not in sweep.keys or not sweep.base.output.figures:
        return
    curves: dict[str, list[list[float]]] = {}
    for row in rows:
        if row.failed or any(row.summary.get(key) is None for key in COLUMNS):
            continue
        others = (f"{key.rsplit('.', 1)[-1]} {row.values[key]}" for key in sweep.keys if key != SLIP)
        curves.setdefault(", ".join(others), []).append([row.summary[key] for key in COLUMNS])
    shown = {label: np.array(sorted(points)).T for label, points in list(curves.items())[:MOST] if len(points) > 1}
    if not shown:
        return
    from granular_contact.report.figures.studies import draw_slip

    draw_slip(shown, folder / FIGURES / FIGURE)
