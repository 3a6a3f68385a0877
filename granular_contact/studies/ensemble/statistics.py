"""Statistics of an ensemble: mean, deviation and quantiles of key numbers, convergence of means, bands of histories.

They are written as statistics.csv, convergence.csv, bands.csv and figures, in the folder of the ensemble's sweep.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from granular_contact.report import BANDS, CONVERGENCE, FIGURES, STATISTICS, write_table
from granular_contact.report.units import is_number
from granular_contact.studies.ensemble.runs import INSTANTS, SERIES
from granular_contact.studies.sweep.journal import Row
from granular_contact.values.arrays import Vector

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
_NOT_KEY = ("cost.", "versions.", f"{SERIES}.", "strips.", "facets.")
# Key numbers that are listed and drawn first.
FIRST = (
    *("wheel.drawbar_pull_N", "wheel.sinkage_m", "wheel.torque_Nm", "stopping_time_s", "angle_at_stop_deg"),
    *("penetration_time_s", "forward_speed_m_s", "max_depth_m", "max_deflection_m"),
)


@dataclass(frozen=True)
class Numbers:
    """Values (n,) of one key number, of all runs that have it, in the order of the seeds."""

    values: Vector

    @property
    def mean(self) -> float:
        """Mean."""
        return float(self.values.mean())

    @property
    def deviation(self) -> float:
        """Standard deviation of a single run."""
        return float(self.values.std(ddof=1))

    @property
    def error(self) -> float:
        """Standard error of the mean."""
        return self.deviation / float(np.sqrt(len(self.values)))

    @property
    def quantiles(self) -> Vector:
        """Quantiles at LEVELS."""
        return np.quantile(self.values, LEVELS)

    def settling(self) -> tuple[Vector, Vector, Vector]:
        """Numbers of runs (from 2), the mean of that many runs, and the half width of its 95 % confidence interval.

        The interval is Student's: with 2 runs 12.7 standard errors to either side, with 20 runs 2.09.
        """
        n = np.arange(1, len(self.values) + 1)
        mean = np.cumsum(self.values) / n
        centered = self.values - self.values.mean()  # avoids cancellation of the squares
        square = np.cumsum(centered**2) - np.cumsum(centered) ** 2 / n
        half = stdtrit(n[1:] - 1, 0.975) * np.sqrt(np.maximum(square[1:], 0.0) / (n[1:] - 1) / n[1:])
        return n[1:].astype(float), mean[1:], half


@dataclass(frozen=True)
class Summary:
    """Statistics of an ensemble.

    count: number of runs that ended regularly; failed: number of the others; numbers: key numbers that differ between
    runs, by key. time: (INSTANTS,) s, to the end of the longest run; bands: quantiles (levels, INSTANTS) of all runs,
    by column. After its end a run keeps its last value.
    """

    count: int
    failed: int
    numbers: dict[str, Numbers]
    time: Vector
    bands: dict[str, Vector]


def of_rows(rows: Iterable[Row]) -> Summary:
    """Statistics of the runs of an ensemble.

    Parameters
    ----------
    rows : iterable of Row
        A row for each run, in any order: its summary with the histories of `observed`.

    Returns
    -------
    Summary
        Only runs that ended regularly count in its numbers and bands.
    """
    ordered = sorted(rows, key=lambda row: row.index)
    ended = [row.summary for row in ordered if not row.failed]
    time, bands = _bands(ended)
    return Summary(len(ended), len(ordered) - len(ended), _numbers(ended), time, bands)


def _numbers(summaries: list[dict[str, object]]) -> dict[str, Numbers]:
    keys = dict.fromkeys(key for summary in summaries for key in summary if not key.startswith(_NOT_KEY))
    numbers = {}
    for key in sorted(keys, key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST)):
        values = np.array([summary[key] for summary in summaries if is_number(summary.get(key))], dtype=float)
        if len(values) >= 2 and np.ptp(values) > 0.0:
            numbers[key] = Numbers(values)
    return numbers


def _bands(summaries: list[dict[str, object]]) -> tuple[Vector, dict[str, Vector]]:
    time_key = f"{SERIES}.time_s"
    runs = [summary for summary in summaries if time_key in summary]
    if not runs:
        return np.zeros(0), {}
    times = [np.array(run[time_key]) for run in runs]
    time = np.linspace(0.0, max(float(instants[-1]) for instants in times), INSTANTS)
    columns = [key for key in runs[0] if key.startswith(f"{SERIES}.") and key != time_key]
    bands = {}
    for key in columns:
        histories = [np.interp(time, instants, np.array(run[key])) for instants, run in zip(times, runs, strict=True)]
        bands[key.removeprefix(f"{SERIES}.")] = np.quantile(np.array(histories), LEVELS, axis=0)
    return time, bands


HEAD = ["key", "runs", "mean", "standard_error", "standard_deviation", "least", *(f"q{100 * x:02.0f}" for x in LEVELS)]
HEAD = [*HEAD, "greatest"]
MOST = 3  # panels


def write(summary: Summary, folder: Path, *, figures: bool = True) -> None:
    """Write the tables of an ensemble, and its figures.

    Parameters
    ----------
    summary : Summary
        Means, quantiles and bands of the ensemble.
    folder : Path
        An existing folder.
    figures : bool, optional
        Whether figures are drawn.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    write_table(folder / STATISTICS, HEAD, _statistics(summary))
    write_table(folder / CONVERGENCE, ["key", "runs", "mean", "half_width_95"], _convergence(summary))
    if summary.bands:
        names = ["time_s", *(f"{name}_q{100 * x:02.0f}" for name in summary.bands for x in LEVELS)]
        table = np.vstack([summary.time, *summary.bands.values()]).T
        write_table(folder / BANDS, names, table.tolist())
    if figures and summary.count > 1:
        from granular_contact.report.figures.studies import draw_bands, draw_settling

        if summary.bands:
            draw_bands(summary.time, dict(list(summary.bands.items())[:MOST]), folder / FIGURES / "bands.png")
        if summary.numbers:
            settled = {key: numbers.settling() for key, numbers in list(summary.numbers.items())[:MOST]}
            draw_settling(settled, folder / FIGURES / "convergence_of_means.png")


def _statistics(summary: Summary) -> Iterator[list[str | float]]:
    for key, numbers in summary.numbers.items():
        ends = (numbers.values.min(), *numbers.quantiles, numbers.values.max())
        yield [key, len(numbers.values), numbers.mean, numbers.error, numbers.deviation, *map(float, ends)]


def _convergence(summary: Summary) -> Iterator[list[str | float]]:
    """Rows of the table: the number of runs doubles from row to row; the last row has all runs."""
    for key, numbers in summary.numbers.items():
        runs, mean, half = numbers.settling()
        last = len(runs) - 1
        for i in sorted({*(2**k - 2 for k in range(1, 24) if 2**k - 2 < last), last}):
            yield [key, int(runs[i]), float(mean[i]), float(half[i])]
