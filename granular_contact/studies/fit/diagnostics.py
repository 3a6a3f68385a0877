"""Checks of the data of a fit: what makes its standard errors unreliable, each in a sentence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from granular_contact.studies.fit import noise
from granular_contact.studies.fit.problem import Problem

Vector = NDArray[np.float64]

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
        *_dependent(problem, f, noise.at_floor(problem, sigma)),
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
    return [max(map(noise.rounding, series)) for series in problem.by_column().values()]


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
