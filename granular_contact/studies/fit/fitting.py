"""Problem -> Fit: parameters, how well they are known, whether the model describes the data at all.

Coefficients are compared with those published, and forces with those that the law gives. A depth in cm under a header
in mm, or a force in mN under one in N, can be fitted as well as any other: what tells it is a coefficient that no sand
has, or a force that the law does not reach. It is also found here whose medium gets the coefficients, and in what else
the media of the runs differ.
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
from granular_contact.studies.fit.uncertainty import Uncertainty, uncertainty
from granular_contact.values.arrays import Vector

DISTRUST = "the model does not describe these data, and the standard errors are too small"


@dataclass(frozen=True)
class Fit:
    """Result of a fit. residuals: data less model (n, columns) of each run.

    scatter: of the grains, where it was separated from noise.
    """

    problem: Problem
    solution: Solution
    uncertainty: Uncertainty
    goodness: Goodness
    residuals: tuple[Vector, ...]
    scatter: Scattering | None = None

    @property
    def values(self) -> Vector:
        """Best parameters (p,)."""
        return self.problem.values(self.solution.scaled)

    @property
    def agreeing(self) -> int:
        """How many starts ended at the best cost, within a tolerance."""
        costs = np.array([start.cost for start in self.solution.starts])
        return int(np.sum(costs <= np.min(costs) * (1.0 + SAME_COST) + NEGLIGIBLE_COST * len(self.solution.residuals)))

    @property
    def warnings(self) -> tuple[str, ...]:
        """Reasons against trusting the numbers, in sentences."""
        found = []
        if self.goodness.status == "misfit":
            found.append(f"misfit: {'; '.join(self.goodness.words)}: {DISTRUST}")
        if not self.solution.converged:
            found.append("the fit did not converge: try more starts, narrower bounds or fewer parameters")
        found += [*self.goodness.warnings, *self.uncertainty.words]
        found += dict.fromkeys(note for run in self.problem.runs for note in run.measured.notes)
        found += words(self.problem, self.values)
        found += unit_warnings(self.problem, self.values, self.residuals)
        if self.scatter is not None and self.scatter.relative > MOST:
            size = f"{self.scatter.relative:.2g}"
            found.append(f"the medium would scatter by {size}, and {MOST:g} is the most that one can: that is written")
        count = len(self.solution.starts)
        if count > 1 and self.agreeing == 1:
            found.append(f"only 1 of {count} starting points led to this fit; there may be a better one: more starts")
        died = sum(start.problem == DIED for start in self.solution.starts)
        if died:
            found.append(f"{died} of {count} starting points failed: {DIED}, perhaps for lack of memory")
        return tuple(found)


def fit(problem: Problem, workers: int = 1, progress: Progress | None = None) -> Fit:
    """Fit a problem of `granular_contact.studies.fit.prepare`.

    Parameters
    ----------
    problem : Problem
        Runs, data and parameters.
    workers : int, optional
        Processes that the starting points are shared out to.
    progress : callable, optional
        Told how many starting points are done, and of how many.

    Raises
    ------
    SolveError
        The model fails wherever it is started.
    """
    solution = solve(problem, workers, progress)
    grains, judged, covariance = None, solution, None
    if problem.scatter:
        try:
            solution, grains = separate(problem, solution)
        except ModelFailed as error:
            raise SolveError(f"the model fails near the best parameters: {error}") from error
        judged, covariance = replace(solution, residuals=grains.white * grains.noise), grains.covariance
    known = uncertainty(problem, solution, covariance)
    residuals = tuple(problem.split(solution.residuals))
    return Fit(problem, solution, known, goodness(problem, judged), residuals, grains)


BEYOND = 2.0  # times the greatest of several published values, or below the least: more is unlikely for a sand
TABLES = ("alpha_N_cm3",)  # whose single numbers are not judged: small ones differ by more from sand to sand
UNLIKE = 2.0  # factor between measured forces and those of the fitted law: a fit of their size makes it 1
ASKED = "is a column of the data in another unit than its name says?"


def unit_warnings(problem: Problem, values: Vector, residuals: Sequence[Vector]) -> Iterator[str]:
    """Sentences on what looks like another unit.

    values: parameters (p,); residuals: data less model (n, columns) of each run.
    """
    for one in fitted(problem):
        value = float(values[problem.parameters.index(one)])
        if (words := _beyond(one.key, abs(value))) is not None:
            yield f"{one.label}, {value:.3g}, is {words}: {ASKED}"
    for run, left in zip(problem.runs, residuals, strict=True):
        held = run.measured
        for k, name in enumerate(held.columns):
            data, model = held.values[:, k], held.values[:, k] - left[:, k]
            size, share = float(model @ model), float(data @ model)
            if name in SIGNS and share > 0.0 and not 1.0 / UNLIKE < share / size < UNLIKE:
                yield f"{held.file}: {name} is {share / size:.3g} times what the fitted law gives: {ASKED}"


def _beyond(key: Key, value: float) -> str | None:
    """How far a coefficient is from those of the media that are shipped, in words; None where it is not.

    One published value is no range, and is not compared with.
    """
    known = published().get(_name(key), [])
    if len(set(known)) < 2 or value == 0.0 or key[-2] in TABLES:
        return None
    low, high = min(known), max(known)
    span = f"{low:g} to {high:g} in the media that are shipped"
    if value > BEYOND * high:
        return f"{value / high:.2g} times the greatest published value ({span})"
    if value < low / BEYOND:
        return f"1/{low / value:.2g} of the least published value ({span})"
    return None


@cache
def published() -> dict[str, list[float]]:
    """Values other than 0 of each coefficient, by its dotted key, in the media that are shipped."""
    found: dict[str, list[float]] = {}
    for name in medium_names():
        plain = load_medium(name).model_dump(by_alias=True, exclude_unset=True)
        for key, value in _numbers(plain, ()):
            found.setdefault(_name(("", *key)), []).append(value)
    return found


def _numbers(plain: Any, path: Key) -> Iterator[tuple[Key, float]]:
    for key, value in plain.items() if isinstance(plain, dict) else ():
        if isinstance(value, float) and value != 0.0:
            yield (*path, key), abs(value)
        yield from _numbers(value, (*path, key))


def _name(key: Key) -> str:
    """Key of a coefficient within its medium, of which there may be several."""
    return ".".join(part for part in key[1:] if not part.isdecimal())


MEDIUM = "medium"
MOST_SHOWN = 6
# What a medium is called, and where its numbers are from: no property of the sand.
_ABOUT = {"name", "source", "provenance", "range", "standing"}


def fitted(problem: Problem) -> list[Parameter]:
    """The shared parameters that belong to a medium."""
    return [p for p in problem.parameters if p.key[0] == MEDIUM and p.shared]


def carrier(problem: Problem) -> int:
    """Index of the first run on which all the fitted coefficients act; if none has them all, most of them."""
    counts = [sum(i in p.runs for p in fitted(problem)) for i in range(len(problem.runs))]
    return counts.index(max(counts))


def words(problem: Problem, values: NDArray[Any]) -> Iterator[str]:
    """Notes for a reader of the medium, for parameters (p,): what it does not contain, in what other runs differ."""
    if not fitted(problem):
        return
    held = carrier(problem)
    name = problem.runs[held].name
    lacking = [p.label for p in fitted(problem) if held not in p.runs]
    if lacking:
        yield f"no run has all the coefficients: the medium written is that of {name}, without {', '.join(lacking)}"
    shared = {p.key[1:] for p in fitted(problem)}
    media = [_medium(problem, i, values) for i in range(len(problem.runs))]
    differing: dict[str, None] = {}
    for path, mine, other in (found for one in media for found in differences(media[held], one)):
        key = tuple(map(str, path))
        nothing = mine in (None, MISSING) and other in (None, MISSING)  # null is as good as left out
        if not nothing and key not in shared and not _ABOUT & set(key):
            differing[".".join(key) or "law"] = None  # or one has none, or several
    if differing:
        listed = ", ".join([*differing][:MOST_SHOWN]) + (", ..." if len(differing) > MOST_SHOWN else "")
        yield f"the media of the runs differ in {listed}, not fitted to all of them: the one written is that of {name}"


def _medium(problem: Problem, i: int, values: NDArray[Any]) -> Any:
    run = problem.runs[i]
    return scenario_to_dict(run.simulator.load([float(values[j]) for j in run.acting]).scenario)[MEDIUM]
