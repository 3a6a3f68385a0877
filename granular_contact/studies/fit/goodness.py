"""Do the residuals look like noise? A model that can't describe the data leaves a pattern in them, which is reported.

Where the noise is not known the size of the residuals proves nothing, as the noise is estimated from them. Two things
still do: residuals of noise are independent from row to row (Ljung and Box 1978), and they are no larger than what the
data themselves change by from row to row. Residuals as small as the errors of the computation are not judged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.stats import chi2

from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.diagnostics import OUTLIER, data_warnings, outliers, rounded
from granular_contact.studies.fit.problem import Problem
from granular_contact.studies.fit.solve import Solution
from granular_contact.studies.fit.uncertainty import degrees_of_freedom
from granular_contact.values.arrays import Vector

LEAST_PROBABILITY = 1e-3  # probability below which residuals are taken for no noise
LARGE_RESIDUAL = 2.0  # times the roughness of the data: residuals of no noise
MOST_LAGS = 10


@dataclass(frozen=True)
class ColumnFit:
    """One column over all runs, as fit.json has it: noise as used, whether it was given, rows, rms of the residuals.

    row_to_row_noise: roughness of the data. reduced_chi_square: of the residuals in units of the given noise; None
    where it was estimated from them. durbin_watson: 2 for independent residuals, towards 0 for correlated ones.
    """

    column: str
    noise: float
    noise_given: bool
    rows: int
    residual_rms: float
    row_to_row_noise: float | None
    reduced_chi_square: float | None
    durbin_watson: float


@dataclass(frozen=True)
class Goodness:
    """status: `fits` or `misfit`; words: why; ljung_box: probability that noise is so correlated; outliers: values
    farther than four times the noise from the model, as a share of all.

    without_outliers: the reduced chi-square of the others. warnings: what else speaks against the errors.
    """

    status: Literal["fits", "misfit"]
    words: tuple[str, ...]
    columns: tuple[ColumnFit, ...]
    degrees_of_freedom: int
    reduced_chi_square: float
    ljung_box: float
    outliers: float
    without_outliers: float
    warnings: tuple[str, ...]


def goodness(problem: Problem, solution: Solution) -> Goodness:
    """Judge residuals by their size, where that can be known, and by their order."""
    free, degrees = len(problem.parameters), degrees_of_freedom(problem)
    f = solution.residuals / solution.sigma[problem.column_of()]
    tiny = diagnostics.at_floor(problem, solution.sigma)
    unordered = tiny | rounded(problem, solution.sigma)
    blocks = problem.split(f)
    by_column = problem.by_column(blocks)
    columns = tuple(_columns(problem, solution, by_column))
    series = [one for held, no in zip(by_column.values(), unordered, strict=True) if not no for one in held]
    probability = ljung_box(series, free)
    considered = [one for one, small in zip(columns, tiny, strict=True) if not small]
    inside = f[np.abs(f) <= OUTLIER]
    words = [*_size_words(considered, free), *_order_words(probability, series)]
    return Goodness(
        status="misfit" if words else "fits",
        words=tuple(words),
        columns=columns,
        degrees_of_freedom=degrees,
        reduced_chi_square=float(np.sum(f**2)) / degrees,
        ljung_box=probability,
        outliers=outliers(blocks),
        without_outliers=float(np.sum(inside**2)) / max(len(inside) - free, 1),
        warnings=tuple(data_warnings(problem, blocks, solution.sigma)),
    )


def _columns(problem: Problem, solution: Solution, series: Mapping[str, Sequence[Vector]]) -> Iterator[ColumnFit]:
    column = problem.column_of()
    share = min(len(problem.parameters) / len(column), 0.5)
    for k, (name, given) in enumerate(problem.noise.items()):
        own = solution.residuals[column == k]
        known = None if given is None else float(np.sum((own / given) ** 2) / (len(own) * (1.0 - share)))
        yield ColumnFit(
            column=name,
            noise=float(solution.sigma[k]),
            noise_given=given is not None,
            rows=len(own),
            residual_rms=float(np.sqrt(np.mean(own**2))),
            row_to_row_noise=diagnostics.roughness_of(problem, name),
            reduced_chi_square=known,
            durbin_watson=_durbin_watson(series[name]),
        )


def _durbin_watson(series: Sequence[Vector]) -> float:
    total = sum(float(np.sum(one**2)) for one in series)
    return sum(float(np.sum(np.diff(one) ** 2)) for one in series) / total if total > 0.0 else 2.0


def ljung_box(series: Sequence[Vector], parameters: int) -> float:
    """Probability that noise is correlated as much as these series (n,) are, over up to ten rows.

    Outliers are limited to three times the noise, so that a few of them can neither hide a pattern nor make one.
    """
    statistic, lags = 0.0, 0
    for one in series:
        values = np.clip(one, -3.0, 3.0)
        n, total = len(values), float(np.sum(values**2))
        if n < 8 or total == 0.0:
            continue
        count = min(MOST_LAGS, n // 4)
        for lag in range(1, count + 1):
            correlation = float(np.sum(values[lag:] * values[:-lag])) / total
            statistic += n * (n + 2) * correlation**2 / (n - lag)
        lags += count
    return float(chi2.sf(statistic, max(lags - parameters, 1))) if lags else 1.0


def _size_words(columns: Sequence[ColumnFit], free: int) -> Iterator[str]:
    for one in columns:
        if one.reduced_chi_square is not None:
            degrees = max(one.rows - free, 1)
            if chi2.sf(one.reduced_chi_square * degrees, degrees) < LEAST_PROBABILITY:
                times = np.sqrt(one.reduced_chi_square)
                yield f"residuals of {one.column} are {times:.3g} times the noise that was given, {one.noise:.3g}"
        elif (rough := one.row_to_row_noise) is not None and one.noise > LARGE_RESIDUAL * rough:
            times = f"{one.noise / rough:.2g} times" if rough > 0.0 else "more than"
            yield f"residuals of {one.column} ({one.noise:.3g}) are {times} what the data scatter from row to row"


def _order_words(probability: float, series: Sequence[Vector]) -> Iterator[str]:
    if probability < LEAST_PROBABILITY:
        shown = f"p = {probability:.1g}" if probability > 1e-300 else "p < 1e-300"
        yield (
            f"residuals are correlated from row to row (Durbin-Watson {_durbin_watson(series):.2f}, 2 for noise; "
            f"Ljung-Box {shown})"
        )
