"""Goodness of fit: judge whether the residuals look like noise, or whether the model cannot describe the data.

If the noise is not given, it is estimated from the residuals, so their size alone proves nothing. Two tests remain:
residuals of noise are independent from row to row (Ljung and Box 1978), and they are no larger than the scatter of the
data from row to row. Residuals as small as the errors of the computation are not judged.
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

LEAST_PROBABILITY = 1e-3  # below this probability residuals are not taken for noise
LARGE_RESIDUAL = 2.0  # above this ratio to the roughness of the data residuals are not taken for noise
MOST_LAGS = 10


@dataclass(frozen=True)
class ColumnFit:
    """Fit of one column over all runs, as in fit.json: noise used, whether it was given, rows, rms of the residuals.

    row_to_row_noise: roughness of the data. reduced_chi_square: of the residuals in units of the given noise; None if
    the noise was estimated from the residuals. durbin_watson: 2 for independent residuals, towards 0 for correlated
    ones.
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
    """Goodness of a fit.

    status: `fits` or `misfit`; reasons: of a misfit; ljung_box: probability of this correlation for independent noise;
    outliers: share of values farther than four times the noise from the model; without_outliers: reduced chi-square of
    the other values. warnings: further reasons against the standard errors.
    """

    status: Literal["fits", "misfit"]
    reasons: tuple[str, ...]
    columns: tuple[ColumnFit, ...]
    degrees_of_freedom: int
    reduced_chi_square: float
    ljung_box: float
    outliers: float
    without_outliers: float
    warnings: tuple[str, ...]


def goodness(problem: Problem, solution: Solution) -> Goodness:
    """Judge residuals by their size, if the noise is known, and by their correlation from row to row."""
    parameters, degrees = len(problem.parameters), degrees_of_freedom(problem)
    f = solution.residuals / solution.sigma[problem.column_indices()]
    tiny = diagnostics.at_floor(problem, solution.sigma)
    no_order = tiny | rounded(problem, solution.sigma)  # columns whose correlation is not judged
    blocks = problem.split(f)
    by_column = problem.by_column(blocks)
    columns = tuple(_columns(problem, solution, by_column))
    judged = [column for column, skip in zip(by_column.values(), no_order, strict=True) if not skip]
    series = [residuals for column in judged for residuals in column]
    probability = ljung_box(series, parameters)
    considered = [column for column, small in zip(columns, tiny, strict=True) if not small]
    inside = f[np.abs(f) <= OUTLIER]
    reasons = [*_size_reasons(considered, parameters), *_order_reasons(probability, series)]
    return Goodness(
        status="misfit" if reasons else "fits",
        reasons=tuple(reasons),
        columns=columns,
        degrees_of_freedom=degrees,
        reduced_chi_square=float(np.sum(f**2)) / degrees,
        ljung_box=probability,
        outliers=outliers(blocks),
        without_outliers=float(np.sum(inside**2)) / max(len(inside) - parameters, 1),
        warnings=tuple(data_warnings(problem, blocks, solution.sigma)),
    )


def _columns(problem: Problem, solution: Solution, series: Mapping[str, Sequence[Vector]]) -> Iterator[ColumnFit]:
    column = problem.column_indices()
    share = min(len(problem.parameters) / len(column), 0.5)
    for k, (name, given) in enumerate(problem.noise.items()):
        residuals = solution.residuals[column == k]
        degrees = len(residuals) * (1.0 - share)
        yield ColumnFit(
            column=name,
            noise=float(solution.sigma[k]),
            noise_given=given is not None,
            rows=len(residuals),
            residual_rms=float(np.sqrt(np.mean(residuals**2))),
            row_to_row_noise=diagnostics.roughness_of(problem, name),
            reduced_chi_square=None if given is None else float(np.sum((residuals / given) ** 2) / degrees),
            durbin_watson=_durbin_watson(series[name]),
        )


def _durbin_watson(series: Sequence[Vector]) -> float:
    total = sum(float(np.sum(residuals**2)) for residuals in series)
    return sum(float(np.sum(np.diff(residuals) ** 2)) for residuals in series) / total if total > 0.0 else 2.0


def ljung_box(series: Sequence[Vector], parameters: int) -> float:
    """Ljung-Box test: probability that independent noise is as correlated as these series (n,), over up to ten lags.

    Residuals are clipped to three times the noise, so that a few outliers can neither hide nor feign a correlation.
    """
    statistic, lags = 0.0, 0
    for residuals in series:
        values = np.clip(residuals, -3.0, 3.0)
        n, total = len(values), float(np.sum(values**2))
        if n < 8 or total == 0.0:
            continue
        count = min(MOST_LAGS, n // 4)
        for lag in range(1, count + 1):
            correlation = float(np.sum(values[lag:] * values[:-lag])) / total
            statistic += n * (n + 2) * correlation**2 / (n - lag)
        lags += count
    return float(chi2.sf(statistic, max(lags - parameters, 1))) if lags else 1.0


def _size_reasons(columns: Sequence[ColumnFit], parameters: int) -> Iterator[str]:
    for fit in columns:
        if fit.reduced_chi_square is not None:
            degrees = max(fit.rows - parameters, 1)
            if chi2.sf(fit.reduced_chi_square * degrees, degrees) < LEAST_PROBABILITY:
                times = np.sqrt(fit.reduced_chi_square)
                yield f"residuals of {fit.column} are {times:.3g} times the given noise, {fit.noise:.3g}"
        elif (rough := fit.row_to_row_noise) is not None and fit.noise > LARGE_RESIDUAL * rough:
            times = f"{fit.noise / rough:.2g} times" if rough > 0.0 else "larger than"
            yield f"residuals of {fit.column} ({fit.noise:.3g}) are {times} the scatter of the data from row to row"


def _order_reasons(probability: float, series: Sequence[Vector]) -> Iterator[str]:
    if probability < LEAST_PROBABILITY:
        shown = f"p = {probability:.1g}" if probability > 1e-300 else "p < 1e-300"
        yield (
            f"residuals are correlated from row to row (Durbin-Watson {_durbin_watson(series):.2f}, 2 for noise; "
            f"Ljung-Box {shown})"
        )
