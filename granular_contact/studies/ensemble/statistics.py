"""Rows of an ensemble -> mean, spread and quantiles of every key number, how the mean settles, bands of histories.

They are written as statistics.csv, convergence.csv, bands.csv and figures, in the folder of its sweep.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from granular_contact.report import BANDS, CONVERGENCE, FIGURES, STATISTICS, write_table
from granular_contact.report.units import is_number
from granular_contact.studies.ensemble.runs import INSTANTS, SERIES
from granular_contact.studies.sweep.journal import Row
from granular_contact.values.arrays import Vector

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
_NOT_KEY = ("cost.", "versions.", f"{SERIES}.", "strips.", "facets.")
# Shown and drawn before all others.
FIRST = (
    *("wheel.drawbar_pull_N", "wheel.sinkage_m", "wheel.torque_Nm", "stopping_time_s", "angle_at_stop_deg"),
    *("penetration_time_s", "forward_speed_m_s", "max_depth_m", "max_deflection_m"),
)
CONFIDENCE = 1.96  # standard errors on either side of a mean: 95 % of a normal one


@dataclass(frozen=True)
class Numbers:
    """One key number of all runs that have it, (n,) in the order of the seeds."""

    values: Vector

    @property
    def mean(self) -> float:
        """Mean."""
        return float(self.values.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation of one run."""
        return float(self.values.std(ddof=1))

    @property
    def error(self) -> float:
        """Standard error of the mean."""
        return self.deviation / float(np.sqrt(len(self.values)))

    @property
    def quantiles(self) -> Vector:
        """At LEVELS."""
        return np.quantile(self.values, LEVELS)

    def settling(self) -> tuple[Vector, Vector, Vector]:
        """Numbers of runs from 2 on, the mean of so many, and half the width of its 95 % interval."""
        n = np.arange(1, len(self.values) + 1)
        mean = np.cumsum(self.values) / n
        off = self.values - self.values.mean()  # or the squares would cancel
        square = np.cumsum(off**2) - np.cumsum(off) ** 2 / n
        half = CONFIDENCE * np.sqrt(np.maximum(square[1:], 0.0) / (n[1:] - 1) / n[1:])
        return n[1:].astype(float), mean[1:], half


@dataclass(frozen=True)
class Summary:
    """count: of runs that came to an end; failed: of the others; numbers: by key, those that differ between runs.

    time (INSTANTS,) s, to the end of the longest run; bands: by column the quantiles (levels, INSTANTS) of all runs,
    each of which stays where it ended.
    """

    count: int
    failed: int
    numbers: dict[str, Numbers]
    time: Vector
    bands: dict[str, Vector]


def of_rows(rows: Iterable[Row]) -> Summary:
    """Statistics of rows in any order; they do not depend on it."""
    ordered = sorted(rows, key=lambda row: row.index)
    ended = [row.summary for row in ordered if not row.failed]
    time, bands = _bands(ended)
    return Summary(len(ended), len(ordered) - len(ended), _numbers(ended), time, bands)


def _numbers(summaries: list[dict[str, object]]) -> dict[str, Numbers]:
    keys = dict.fromkeys(key for one in summaries for key in one if not key.startswith(_NOT_KEY))
    found = {}
    for key in sorted(keys, key=lambda one: FIRST.index(one) if one in FIRST else len(FIRST)):
        values = np.array([one[key] for one in summaries if is_number(one.get(key))], dtype=float)
        if len(values) >= 2 and np.ptp(values) > 0.0:
            found[key] = Numbers(values)
    return found


def _bands(summaries: list[dict[str, object]]) -> tuple[Vector, dict[str, Vector]]:
    clock = f"{SERIES}.time_s"
    clocked = [one for one in summaries if clock in one]
    if not clocked:
        return np.zeros(0), {}
    clocks = [np.array(one[clock]) for one in clocked]
    time = np.linspace(0.0, max(float(one[-1]) for one in clocks), INSTANTS)
    columns = [key for key in clocked[0] if key.startswith(f"{SERIES}.") and key != clock]
    found = {}
    for key in columns:
        runs = [np.interp(time, at, np.array(one[key])) for at, one in zip(clocks, clocked, strict=True)]
        found[key.removeprefix(f"{SERIES}.")] = np.quantile(np.array(runs), LEVELS, axis=0)
    return time, found


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
        write_table(folder / BANDS, names, table.tolist())
    if figures and found.count > 1:
        from granular_contact.report.figures.studies import draw_bands, draw_settling

        if found.bands:
            draw_bands(found.time, dict(list(found.bands.items())[:MOST]), folder / FIGURES / "bands.png")
        if found.numbers:
            settled = {key: one.settling() for key, one in list(found.numbers.items())[:MOST]}
            draw_settling(settled, folder / FIGURES / "convergence_of_means.png")


def _statistics(found: Summary) -> Iterator[list[str | float]]:
    for key, one in found.numbers.items():
        ends = (one.values.min(), *one.quantiles, one.values.max())
        yield [key, len(one.values), one.mean, one.error, one.deviation, *map(float, ends)]


def _convergence(found: Summary) -> Iterator[list[str | float]]:
    """Twice as many runs from line to line, and all of them."""
    for key, one in found.numbers.items():
        runs, mean, half = one.settling()
        last = len(runs) - 1
        for i in sorted({*(2**k - 2 for k in range(1, 24) if 2**k - 2 < last), last}):
            yield [key, int(runs[i]), float(mean[i]), float(half[i])]
