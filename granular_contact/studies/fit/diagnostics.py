"""Checks of the data of a fit: what makes its standard errors unreliable, each in a sentence.

Noise of data, estimated from the data themselves or robustly from the residuals of a model.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from granular_contact.studies.fit.problem import Loss, Problem
from granular_contact.values.arrays import Vector

# Residuals beyond so many times the noise pull no stronger than that. Of pure noise 2 % of the information is lost.
LOSS_SCALE = 2.0
# E psi^2 of a standard normal residual; psi = f / sqrt(1 + (f / LOSS_SCALE)^2), the slope of soft_l1 with that f_scale.
_EXPECTED = 0.6290461656955636
RELATIVE_FLOOR = 1e-5  # of the range of the data: what interpolation and integration leave uncertain
WHOLE_NUMBER_TOLERANCE = 1e-3  # how far from whole numbers multiples of a step may be
_MAD = 1.4826  # standard deviation over median absolute value, of a normal distribution


def psi(f: Vector, loss: Loss) -> Vector:
    """Influence function of residuals f (in units of the noise)."""
    return f if loss == "linear" else f / np.sqrt(1.0 + (f / LOSS_SCALE) ** 2)


def psi_slope(f: Vector, loss: Loss) -> Vector:
    """Derivative of `psi`."""
    return np.ones_like(f) if loss == "linear" else (1.0 + (f / LOSS_SCALE) ** 2) ** -1.5


def scale(residuals: Vector, loss: Loss, share: float) -> float:
    """Standard deviation of residuals (n,), of whose n degrees of freedom the fit took the given share.

    For soft_l1 the scale at which the mean square influence is that of normal residuals (Huber's second proposal).
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
    """Standard deviation of what changes from row to row, of values (n,) at even times: from third differences.

    A smooth motion adds little to it, so it is the noise or a little more; at least that of rounding, which may leave
    most rows alike. None for too few rows.
    """
    if len(values) < 10:
        return None
    third = np.diff(values, 3)  # of noise of variance s^2 it has 20 s^2
    return max(float(_MAD * np.median(np.abs(third)) / np.sqrt(20.0)), rounding(values) / float(np.sqrt(12.0)))


def rounding(values: Vector) -> float:
    """Step that values (n,) are rounded to; 0 where the smallest one between them is not that of all."""
    levels = np.unique(values)
    steps = np.diff(levels)
    steps = steps[steps > 1e-9 * np.ptp(values)]  # less is the arithmetic of who wrote them
    if len(steps) < 2:
        return 0.0
    step = float(np.min(steps))
    multiples = (levels - levels[0]) / step
    return step if float(np.max(np.abs(multiples - np.round(multiples)))) < WHOLE_NUMBER_TOLERANCE else 0.0


def roughness_of(problem: Problem, column: str) -> float | None:
    """The same of all runs together; None where no run has enough rows."""
    found = [(roughness(one), len(one)) for one in problem.by_column()[column]]
    known = np.array([(size**2, rows) for size, rows in found if size is not None])
    return float(np.sqrt(np.average(known[:, 0], weights=known[:, 1]))) if len(known) else None


def floors(problem: Problem) -> Vector:
    """Noise (columns,) below which the errors of the computation dominate."""
    ranges = [float(np.ptp(np.concatenate(series))) for series in problem.by_column().values()]
    return np.maximum(RELATIVE_FLOOR * np.array(ranges), 1e-12)


def at_floor(problem: Problem, sigma: Vector) -> NDArray[np.bool_]:
    """Whether a noise (columns,) is no more than the errors of the computation."""
    return np.asarray(sigma <= floors(problem) * (1.0 + 1e-9))


OUTLIER = 4.0  # times the noise
MOST_OUTLIERS = 0.1  # of all values: more are no exceptions
MOST_LINES = 6  # that are named
SMALL_RESIDUAL = 0.5  # of the noise that was given: smaller residuals contradict it
LEAST_PROBABILITY = 1e-3  # of residuals as small as these
LEAST_CORRELATION = 0.5  # of measurements that are not independent
LEAST_SIGNIFICANCE = 4.0  # of that correlation, in units of what chance gives
MOST_COMPARED = 50  # runs
LEAST_ROUNDING = 0.5  # share of rounding in the noise from which on it is reported


def data_warnings(problem: Problem, f: Sequence[Vector], sigma: Vector) -> list[str]:
    """Sentences for residuals f, (n, columns) of each run in units of the noise sigma (columns,) of the problem."""
    return [
        *_outliers(problem, f),
        *_small(problem, f),
        *_rounded(problem, sigma),
        *_dependent(problem, f, at_floor(problem, sigma)),
    ]


def outliers(f: Sequence[Vector]) -> float:
    """Share of values farther from the model than noise goes."""
    return float(np.mean(np.abs(np.concatenate([one.ravel() for one in f])) > OUTLIER))


def _outliers(problem: Problem, f: Sequence[Vector]) -> Iterator[str]:
    """Places of the outliers, if they are few."""
    if not 0.0 < outliers(f) <= MOST_OUTLIERS:
        return
    count = sum(int(np.sum(np.abs(one) > OUTLIER)) for one in f)
    places = []
    for run, one in zip(problem.runs, f, strict=True):
        rows = np.flatnonzero(np.any(np.abs(one) > OUTLIER, axis=1))
        if len(rows):
            numbers = run.measured.lines or range(1, len(one) + 1)  # data that are of no file have rows
            kind = ("line" if run.measured.lines else "row") + "s" * (len(rows) > 1)
            shown = ", ".join(str(numbers[i]) for i in rows[:MOST_LINES])
            places.append(f"{run.measured.file} {kind} {shown}{' and more' * (len(rows) > MOST_LINES)}")
    said = "1 value is an outlier" if count == 1 else f"{count} values are outliers"
    yield f"{said}, farther than {OUTLIER:g} times the noise from the model: {'; '.join(places)}"


def _small(problem: Problem, f: Sequence[Vector]) -> Iterator[str]:
    """Columns whose residuals are far smaller than the noise that was given."""
    for name, given in problem.noise.items():
        if given is not None:
            own = np.concatenate(problem.by_column(f)[name])
            total, rms = float(np.sum(own**2)), float(np.sqrt(np.mean(own**2)))
            if rms < SMALL_RESIDUAL and chi2.cdf(total, max(len(own) - len(problem.parameters), 1)) < LEAST_PROBABILITY:
                yield f"residuals of {name} are {rms:.2g} of the noise that was given, {given:.3g}: is its unit right?"


def _rounded(problem: Problem, sigma: Vector) -> Iterator[str]:
    """Columns whose noise is mostly rounding."""
    for name, size, step in zip(problem.columns, sigma, _steps(problem), strict=True):
        if _mostly_rounding(step, size):
            yield (
                f"{name} is rounded to {step:.3g}, which is most of its noise, {size:.3g}: errors of rounding are "
                "correlated, so their order is not judged, and the standard errors may be too small"
            )


def rounded(problem: Problem, sigma: Vector) -> NDArray[np.bool_]:
    """Whether the noise of a column (columns,) is that of its rounding."""
    return np.array([_mostly_rounding(*one) for one in zip(_steps(problem), sigma, strict=True)])


def _mostly_rounding(step: float, size: float) -> bool:
    return bool(step / np.sqrt(12.0) > LEAST_ROUNDING * size)


def _steps(problem: Problem) -> list[float]:
    """What each column is rounded to, at the coarsest; 0 if to nothing."""
    return [max(map(rounding, series)) for series in problem.by_column().values()]


def _dependent(problem: Problem, f: Sequence[Vector], tiny: NDArray[np.bool_]) -> Iterator[str]:
    """Columns of a run, and columns of two runs, whose noise is the same."""
    groups: list[set[str]] = []
    runs: dict[tuple[str, str], list[str]] = {}
    for pair in _pairs(problem, tiny):
        (i, name), (j, other) = pair
        first, second = (f[run][:, problem.runs[run].measured.columns.index(column)] for run, column in pair)
        if len(first) != len(second) or abs(_correlation(first, second)) <= _most(len(first)):
            continue
        if i == j:
            touched = [one for one in groups if one & {name, other}]
            groups = [one for one in groups if one not in touched] + [{name, other}.union(*touched)]
        else:
            runs.setdefault((problem.runs[i].name, problem.runs[j].name), []).append(name)
    named = [" and ".join(name for name in problem.columns if name in group) for group in groups]
    named += [f"{' and '.join(names)} in {one} and {other}" for (one, other), names in runs.items()]
    for words in named:
        yield (
            f"the noise of {words} is the same for the most part, so they are not independent measurements: the errors "
            "are too small"
        )


Place = tuple[int, str]  # index of a run, column


def _pairs(problem: Problem, tiny: NDArray[np.bool_]) -> Iterator[tuple[Place, Place]]:
    """Columns that may have noise in common."""
    checked = {name for name, small in zip(problem.columns, tiny, strict=True) if not small}
    held = [[name for name in run.measured.columns if name in checked] for run in problem.runs]
    for i, names in enumerate(held):
        for name, other in combinations(names, 2):
            yield (i, name), (i, other)
    for i, j in combinations(range(min(len(held), MOST_COMPARED)), 2):
        for name in held[i]:
            if name in held[j]:
                yield (i, name), (j, name)


def _correlation(one: Vector, other: Vector) -> float:
    """Correlation of what changes from row to row: of the noise, and not of what the model misses in both."""
    a, b = (np.clip(np.diff(values), -OUTLIER, OUTLIER) for values in (one, other))
    return float(np.sum(a * b) / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-300))


def _most(rows: int) -> float:
    """Correlation that noise of so many rows does not have: differences of it have 1.5 times its variance."""
    return max(LEAST_CORRELATION, LEAST_SIGNIFICANCE * float(np.sqrt(1.5 / rows)))
