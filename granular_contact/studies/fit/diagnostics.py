"""Checks of the data of a fit: warnings about everything that makes the standard errors unreliable.

Estimates of the noise of data, from the data themselves or robustly from the residuals of a model.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from granular_contact.studies.fit.problem import Loss, Problem
from granular_contact.values.arrays import Vector

# The influence of a residual is at most that of this many times the noise. For pure noise it costs 2 % of information.
LOSS_SCALE = 2.0
# E psi^2 of a standard normal residual; psi = f / sqrt(1 + (f / LOSS_SCALE)^2), the slope of soft_l1 with that f_scale.
_EXPECTED = 0.6290461656955636
RELATIVE_FLOOR = 1e-5  # error of the computation (interpolation and integration), relative to the range of the data
WHOLE_NUMBER_TOLERANCE = 1e-3  # tolerance for multiples of a step of rounding
_MAD = 1.4826  # standard deviation over median absolute value, of a normal distribution


def psi(f: Vector, loss: Loss) -> Vector:
    """Influence function of residuals f (in units of the noise)."""
    return f if loss == "linear" else f / np.sqrt(1.0 + (f / LOSS_SCALE) ** 2)


def psi_slope(f: Vector, loss: Loss) -> Vector:
    """Derivative of `psi`."""
    return np.ones_like(f) if loss == "linear" else (1.0 + (f / LOSS_SCALE) ** 2) ** -1.5


def scale(residuals: Vector, loss: Loss, share: float) -> float:
    """Standard deviation of residuals (n,); share: of the n degrees of freedom that the fit used.

    For soft_l1 it is the scale at which the mean square influence is that of normal residuals (Huber's proposal 2).
    """
    rms = float(np.sqrt(np.mean(residuals**2) / (1.0 - share)))
    if loss == "linear" or rms == 0.0:
        return rms
    sigma = max(_MAD * float(np.median(np.abs(residuals))), 1e-3 * rms)
    for _ in range(100):
        new = sigma * float(np.sqrt(np.mean(psi(residuals / sigma, loss) ** 2) / (_EXPECTED * (1.0 - share))))
        if abs(new - sigma) < 1e-6 * sigma:
            break
        sigma = new
    return new


def roughness(values: Vector) -> float | None:
    """Standard deviation of the noise of values (n,) at evenly spaced times, from third differences.

    A smooth motion adds little to third differences, so the result is the noise or slightly more. It is at least the
    noise of rounding, because rounding can make most rows equal. None for too few rows.
    """
    if len(values) < 10:
        return None
    third = np.diff(values, 3)  # noise of variance s^2 has third differences of variance 20 s^2
    return max(float(_MAD * np.median(np.abs(third)) / np.sqrt(20.0)), rounding(values) / float(np.sqrt(12.0)))


def rounding(values: Vector) -> float:
    """Step to which values (n,) are rounded; 0 if their differences are not multiples of the smallest difference."""
    levels = np.unique(values)
    steps = np.diff(levels)
    steps = steps[steps > 1e-9 * np.ptp(values)]  # smaller steps are round-off
    if len(steps) < 2:
        return 0.0
    step = float(np.min(steps))
    multiples = (levels - levels[0]) / step
    return step if float(np.max(np.abs(multiples - np.round(multiples)))) < WHOLE_NUMBER_TOLERANCE else 0.0


def roughness_of(problem: Problem, column: str) -> float | None:
    """Roughness of a column over all runs (root mean square by rows); None if no run has enough rows."""
    sizes = [(roughness(series), len(series)) for series in problem.by_column()[column]]
    variances = np.array([(size**2, rows) for size, rows in sizes if size is not None])
    return float(np.sqrt(np.average(variances[:, 0], weights=variances[:, 1]))) if len(variances) else None


def floors(problem: Problem) -> Vector:
    """Noise (columns,) below which errors of the computation dominate."""
    ranges = [float(np.ptp(np.concatenate(series))) for series in problem.by_column().values()]
    return np.maximum(RELATIVE_FLOOR * np.array(ranges), 1e-12)


def at_floor(problem: Problem, sigma: Vector) -> NDArray[np.bool_]:
    """Whether the noise of each column (columns,) is no larger than the errors of the computation."""
    return np.asarray(sigma <= floors(problem) * (1.0 + 1e-9))


OUTLIER = 4.0  # least residual of an outlier, in units of the noise
MOST_OUTLIERS = 0.1  # of all values: a greater share is not a matter of single outliers
MOST_LINES = 6  # greatest number of lines that a warning names
SMALL_RESIDUAL = 0.5  # of the given noise: smaller residuals contradict it
LEAST_PROBABILITY = 1e-3  # least probability of residuals this small, if the given noise is right
LEAST_CORRELATION = 0.5  # from this correlation on measurements are reported as not independent
LEAST_SIGNIFICANCE = 4.0  # least ratio of the correlation to its standard deviation for independent noise
MOST_COMPARED = 50  # greatest number of runs that are compared with each other
LEAST_ROUNDING = 0.5  # from this share of rounding in the noise on it is reported


def data_warnings(problem: Problem, f: Sequence[Vector], sigma: Vector) -> list[str]:
    """Warnings about residuals f, (n, columns) of each run, in units of the noise sigma (columns,)."""
    return [
        *_outliers(problem, f),
        *_small(problem, f),
        *_rounded(problem, sigma),
        *_dependent(problem, f, at_floor(problem, sigma)),
    ]


def outliers(f: Sequence[Vector]) -> float:
    """Share of outliers among all residuals."""
    return float(np.mean(np.abs(np.concatenate([block.ravel() for block in f])) > OUTLIER))


def _outliers(problem: Problem, f: Sequence[Vector]) -> Iterator[str]:
    """Warning that names the lines of outliers, if there are few."""
    if not 0.0 < outliers(f) <= MOST_OUTLIERS:
        return
    count = sum(int(np.sum(np.abs(block) > OUTLIER)) for block in f)
    places = []
    for run, block in zip(problem.runs, f, strict=True):
        rows = np.flatnonzero(np.any(np.abs(block) > OUTLIER, axis=1))
        if len(rows):
            numbers = run.measured.lines or range(1, len(block) + 1)  # data that come from no file have no lines
            noun = ("line" if run.measured.lines else "row") + "s" * (len(rows) > 1)
            listed = ", ".join(str(numbers[i]) for i in rows[:MOST_LINES])
            places.append(f"{run.measured.file} {noun} {listed}{' and more' * (len(rows) > MOST_LINES)}")
    subject = "1 value is an outlier" if count == 1 else f"{count} values are outliers"
    yield f"{subject}, farther than {OUTLIER:g} times the noise from the model: {'; '.join(places)}"


def _small(problem: Problem, f: Sequence[Vector]) -> Iterator[str]:
    """Warnings for columns whose residuals are much smaller than the given noise."""
    for name, given in problem.noise.items():
        if given is not None:
            residuals = np.concatenate(problem.by_column(f)[name])
            total, rms = float(np.sum(residuals**2)), float(np.sqrt(np.mean(residuals**2)))
            degrees = max(len(residuals) - len(problem.parameters), 1)
            if rms < SMALL_RESIDUAL and chi2.cdf(total, degrees) < LEAST_PROBABILITY:
                yield f"residuals of {name} are only {rms:.2g} of the given noise, {given:.3g}: is its unit right?"


def _rounded(problem: Problem, sigma: Vector) -> Iterator[str]:
    """Warnings for columns whose noise is mostly rounding."""
    for name, size, step in zip(problem.columns, sigma, _steps(problem), strict=True):
        if _mostly_rounding(step, size):
            yield (
                f"{name} is rounded to {step:.3g}, which is most of its noise, {size:.3g}: errors of rounding are "
                "correlated, so their order is not judged, and the standard errors may be too small"
            )


def rounded(problem: Problem, sigma: Vector) -> NDArray[np.bool_]:
    """Whether the noise of each column (columns,) is mostly rounding."""
    return np.array([_mostly_rounding(step, size) for step, size in zip(_steps(problem), sigma, strict=True)])


def _mostly_rounding(step: float, size: float) -> bool:
    return bool(step / np.sqrt(12.0) > LEAST_ROUNDING * size)


def _steps(problem: Problem) -> list[float]:
    """Coarsest step of rounding of each column over all runs; 0 for a column that is not rounded."""
    return [max(map(rounding, series)) for series in problem.by_column().values()]


def _dependent(problem: Problem, f: Sequence[Vector], tiny: NDArray[np.bool_]) -> Iterator[str]:
    """Warnings for columns of one run, and for a column in two runs, whose noise is correlated.

    tiny: mask of columns whose noise is no larger than the errors of the computation; they are not compared.
    """
    groups: list[set[str]] = []
    runs: dict[tuple[str, str], list[str]] = {}
    for pair in _pairs(problem, tiny):
        (i, name), (j, other) = pair
        first, second = (f[run][:, problem.runs[run].measured.columns.index(column)] for run, column in pair)
        if len(first) != len(second) or abs(_correlation(first, second)) <= _critical_correlation(len(first)):
            continue
        if i == j:
            touched = [group for group in groups if group & {name, other}]
            groups = [group for group in groups if group not in touched] + [{name, other}.union(*touched)]
        else:
            runs.setdefault((problem.runs[i].name, problem.runs[j].name), []).append(name)
    subjects = [" and ".join(name for name in problem.columns if name in group) for group in groups]
    subjects += [f"{' and '.join(names)} in {first} and {second}" for (first, second), names in runs.items()]
    for subject in subjects:
        yield (
            f"the noise of {subject} is mostly the same, so they are not independent measurements: the standard errors "
            "are too small"
        )


Place = tuple[int, str]  # index of a run, column


def _pairs(problem: Problem, tiny: NDArray[np.bool_]) -> Iterator[tuple[Place, Place]]:
    """Pairs of columns to compare: all columns of one run, and the same column in two runs."""
    checked = {name for name, small in zip(problem.columns, tiny, strict=True) if not small}
    columns = [[name for name in run.measured.columns if name in checked] for run in problem.runs]
    for i, names in enumerate(columns):
        for name, other in combinations(names, 2):
            yield (i, name), (i, other)
    for i, j in combinations(range(min(len(columns), MOST_COMPARED)), 2):
        for name in columns[i]:
            if name in columns[j]:
                yield (i, name), (j, name)


def _correlation(first: Vector, second: Vector) -> float:
    """Correlation of the differences from row to row of two series of residuals.

    Differences contain the noise, but hardly the slow deviations of the model, which can be common to both.
    """
    a, b = (np.clip(np.diff(values), -OUTLIER, OUTLIER) for values in (first, second))
    return float(np.sum(a * b) / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-300))


def _critical_correlation(rows: int) -> float:
    """Correlation above which noise is not independent; for differences its variance is 1.5 times that for noise."""
    return max(LEAST_CORRELATION, LEAST_SIGNIFICANCE * float(np.sqrt(1.5 / rows)))
