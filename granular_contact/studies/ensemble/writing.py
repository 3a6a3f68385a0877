"""An ensemble -> statistics.csv, convergence.csv, bands.csv and figures, in the folder of its sweep."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from granular_contact.report import BANDS, CONVERGENCE, FIGURES, STATISTICS, write_table
from granular_contact.report.drawn import drawn
from granular_contact.studies.ensemble.statistics import LEVELS, Summary

HEAD = ["key", "runs", "mean", "standard_error", "standard_deviation", "least", *(f"q{100 * x:02.0f}" for x in LEVELS)]
HEAD = [*HEAD, "greatest"]
MOST = 3  # panels


def write(found: Summary, folder: Path, *, figures: bool = True) -> None:
    """Write the tables, and the figures if asked for; raises OSError."""
    write_table(folder / STATISTICS, HEAD, _statistics(found))
    write_table(folder / CONVERGENCE, ["key", "runs", "mean", "half_width_95"], _convergence(found))
    if found.bands:
        names = ["time_s", *(f"{name}_q{100 * x:02.0f}" for name in found.bands for x in LEVELS)]
        table = np.vstack([found.time, *found.bands.values()]).T
        write_table(folder / BANDS, names, ([repr(float(x)) for x in row] for row in table))
    if figures and found.count > 1:
        from granular_contact.report.figures.ensembles import draw_bands, draw_settling

        if found.bands:
            with drawn(folder / FIGURES / "bands.png") as file:
                draw_bands(found.time, dict(list(found.bands.items())[:MOST]), file)
        if found.numbers:
            settled = {key: one.settling() for key, one in list(found.numbers.items())[:MOST]}
            with drawn(folder / FIGURES / "convergence_of_means.png") as file:
                draw_settling(settled, file)


def _statistics(found: Summary) -> Iterator[list[str]]:
    for key, one in found.numbers.items():
        ends = (one.values.min(), *one.quantiles, one.values.max())
        fields = (one.mean, one.error, one.deviation, *ends)
        yield [key, str(len(one.values)), *(repr(float(x)) for x in fields)]


def _convergence(found: Summary) -> Iterator[list[str]]:
    """Twice as many runs from line to line, and all of them."""
    for key, one in found.numbers.items():
        runs, mean, half = one.settling()
        last = len(runs) - 1
        for i in sorted({*(2**k - 2 for k in range(1, 24) if 2**k - 2 < last), last}):
            yield [key, str(int(runs[i])), repr(float(mean[i])), repr(float(half[i]))]
