"""Fit a problem: parameters, their uncertainty, whether the model describes the data, and warnings.

Wrong units are found by comparison of coefficients with published ones, and of forces with those of the law. A depth in
cm under a header in mm, or a force in mN under a header in N, can be fitted like any other data. But it gives a
coefficient that no sand has, or forces that the law does not reach. This module also selects the run whose medium is
written with the fitted coefficients, and lists other differences between the media of the runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import scenario_to_dict
from granular_contact.config.differences import MISSING, differences
from granular_contact.config.load import load_medium
from granular_contact.config.references import medium_names
from granular_contact.errors import SolveError
from granular_contact.laws.scatter import MOST
from granular_contact.studies.fit.goodness import Goodness, goodness
from granular_contact.studies.fit.measurements import SIGNS
from granular_contact.studies.fit.problem import Parameter, Problem
from granular_contact.studies.fit.responses import Key, ModelFailed
from granular_contact.studies.fit.scatter import Scattering, separate
from granular_contact.studies.fit.solve import DIED, NEGLIGIBLE_COST, SAME_COST, Progress, Solution, solve
from granular_contact.studies.fit.step_bias import step_bias, step_bias_warnings
from granular_contact.studies.fit.uncertainty import Uncertainty, uncertainty
from granular_contact.values.arrays import Vector

DISTRUST = "the model does not describe these data, and the standard errors are too small"


@dataclass(frozen=True)
class Fit:
    """Result of a fit. residuals: data minus model (n, columns) of each run.

    bias: change of the parameters (p,) with finer steps, see `step_bias`.
    scatter: of the grains; None if it was not separated from noise.
    """

    problem: Problem
    solution: Solution
    uncertainty: Uncertainty
    goodness: Goodness
    residuals: tuple[Vector, ...]
    bias: Vector
    scatter: Scattering | None = None

    @property
    def values(self) -> Vector:
        """Best parameters (p,)."""
        return self.problem.values(self.solution.scaled)

    @property
    def agreeing(self) -> int:
        """Number of starting points that led to the best cost, within a tolerance."""
        costs = np.array([start.cost for start in self.solution.starts])
        return int(np.sum(costs <= np.min(costs) * (1.0 + SAME_COST) + NEGLIGIBLE_COST * len(self.solution.residuals)))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Reasons not to trust the numbers, as sentences."""
        listed = []
        if self.goodness.status == "misfit":
            listed.append(f"misfit: {'; '.join(self.goodness.reasons)}: {DISTRUST}")
        if not self.solution.converged:
            listed.append("the fit did not converge: try more starts, narrower bounds or fewer parameters")
        listed += [*self.goodness.warnings, *self.uncertainty.warnings]
        listed += dict.fromkeys(note for run in self.problem.runs for note in run.measured.notes)
        listed += media_warnings(self.problem, self.values)
        listed += unit_warnings(self.problem, self.values, self.residuals)
        listed += step_bias_warnings(self.uncertainty.estimates, self.bias)
        if self.scatter is not None and self.scatter.relative > MOST:
            size = f"{self.scatter.relative:.2g}"
            listed.append(f"the fitted scatter of the medium, {size}, is above the limit of {MOST:g}, which is written")
        count = len(self.solution.starts)
        if count > 1 and self.agreeing == 1:
            listed.append(f"only 1 of {count} starting points led to this fit; try more starts to find a better one")
        died = sum(start.problem == DIED for start in self.solution.starts)
        if died:
            listed.append(f"{died} of {count} starting points failed: {DIED}, perhaps for lack of memory")
        return tuple(listed)


def fit(problem: Problem, workers: int = 1, progress: Progress | None = None) -> Fit:
    """Fit a problem of `granular_contact.studies.fit.prepare`.

    Parameters
    ----------
    problem : Problem
        Runs, data and parameters.
    workers : int, optional
        Number of processes for the starting points.
    progress : callable, optional
        Called with the number of finished starting points and their total number.

    Returns
    -------
    Fit
        Parameters, standard errors, residuals, and warnings about all of these.

    Raises
    ------
    SolveError
        The model fails at every starting point.
    """
    solution = solve(problem, workers, progress)
    scatter, judged, covariance = None, solution, None
    if problem.scatter:
        try:
            solution, scatter = separate(problem, solution)
        except ModelFailed as error:
            raise SolveError(f"the model fails near the best parameters: {error}") from error
        judged, covariance = replace(solution, residuals=scatter.white * scatter.noise), scatter.covariance
    errors = uncertainty(problem, solution, covariance)
    residuals = tuple(problem.split(solution.residuals))
    bias = step_bias(problem, solution)
    return Fit(problem, solution, errors, goodness(problem, judged), residuals, bias, scatter)


BEYOND = 2.0  # greatest plausible factor above the largest, or below the smallest published value
TABLES = ("alpha_N_cm3",)  # tables whose single numbers are not judged: small ones vary more from sand to sand
UNLIKE = 2.0  # greatest plausible factor between measured forces and those of the fitted law; for a good fit it is 1
UNIT_QUESTION = "is a column of the data in another unit than its name says?"


def unit_warnings(problem: Problem, values: Vector, residuals: Sequence[Vector]) -> Iterator[str]:
    """Warnings about data that seem to be in another unit.

    values: parameters (p,); residuals: data minus model (n, columns) of each run.
    """
    for parameter in fitted(problem):
        value = float(values[problem.parameters.index(parameter)])
        if (excess := _beyond(parameter.key, abs(value))) is not None:
            yield f"{parameter.label}, {value:.3g}, is {excess}: {UNIT_QUESTION}"
    for run, block in zip(problem.runs, residuals, strict=True):
        measured = run.measured
        for k, name in enumerate(measured.columns):
            data, model = measured.values[:, k], measured.values[:, k] - block[:, k]
            square, product = float(model @ model), float(data @ model)
            if name in SIGNS and product > 0.0 and not 1.0 / UNLIKE < product / square < UNLIKE:
                factor = f"{product / square:.3g}"
                yield f"{measured.file}: {name} is {factor} times what the fitted law gives: {UNIT_QUESTION}"


def _beyond(key: Key, value: float) -> str | None:
    """Describe how far a coefficient is outside the range of the shipped media; None if it is not.

    A single published value is no range, so nothing is compared with it.
    """
    values = published().get(_name(key), [])
    if len(set(values)) < 2 or value == 0.0 or key[-2] in TABLES:
        return None
    low, high = min(values), max(values)
    span = f"{low:g} to {high:g} in the shipped media"
    if value > BEYOND * high:
        return f"{value / high:.2g} times the greatest published value ({span})"
    if value < low / BEYOND:
        return f"1/{low / value:.2g} of the least published value ({span})"
    return None


@cache
def published() -> dict[str, list[float]]:
    """Values other than 0 of each coefficient in the shipped media, by dotted key."""
    values: dict[str, list[float]] = {}
    for name in medium_names():
        plain = load_medium(name).model_dump(by_alias=True, exclude_unset=True)
        for key, value in _numbers(plain, ()):
            values.setdefault(_name(("", *key)), []).append(value)
    return values


def _numbers(plain: Any, path: Key) -> Iterator[tuple[Key, float]]:
    for key, value in plain.items() if isinstance(plain, dict) else ():
        if isinstance(value, float) and value != 0.0:
            yield (*path, key), abs(value)
        yield from _numbers(value, (*path, key))


def _name(key: Key) -> str:
    """Dotted key of a coefficient within its medium, without the index of the medium."""
    return ".".join(part for part in key[1:] if not part.isdecimal())


MEDIUM = "medium"
MOST_SHOWN = 6
# Keys of a medium that are no property of the sand.
_ABOUT = {"name", "source", "provenance", "range", "standing"}


def fitted(problem: Problem) -> list[Parameter]:
    """Shared parameters that are coefficients of a medium."""
    return [p for p in problem.parameters if p.key[0] == MEDIUM and p.shared]


def reference_run(problem: Problem) -> int:
    """Index of the run whose medium is written: the first on which most of the fitted coefficients act."""
    counts = [sum(i in p.runs for p in fitted(problem)) for i in range(len(problem.runs))]
    return counts.index(max(counts))


def media_warnings(problem: Problem, values: NDArray[Any]) -> Iterator[str]:
    """Warnings about the written medium, for parameters (p,): missing coefficients, differences to other runs."""
    if not fitted(problem):
        return
    reference = reference_run(problem)
    name = problem.runs[reference].name
    missing = [p.label for p in fitted(problem) if reference not in p.runs]
    if missing:
        yield f"no run has all fitted coefficients: the written medium is that of {name}, without {', '.join(missing)}"
    shared = {p.key[1:] for p in fitted(problem)}
    media = [_medium(problem, i, values) for i in range(len(problem.runs))]
    changes = (change for medium in media for change in differences(media[reference], medium))
    differing: dict[str, None] = {}
    for path, first, second in changes:
        key = tuple(map(str, path))
        both_unset = first in (None, MISSING) and second in (None, MISSING)  # null means the same as no key
        if not both_unset and key not in shared and not _ABOUT & set(key):
            differing[".".join(key) or "law"] = None  # no key if a run has no medium, or several
    if differing:
        listed = ", ".join([*differing][:MOST_SHOWN]) + (", ..." if len(differing) > MOST_SHOWN else "")
        yield (
            f"the media of the runs differ in {listed}, which is not fitted to all of them: the written medium is that "
            f"of {name}"
        )


def _medium(problem: Problem, i: int, values: NDArray[Any]) -> Any:
    run = problem.runs[i]
    return scenario_to_dict(run.simulator.load([float(values[j]) for j in run.acting]).scenario)[MEDIUM]
