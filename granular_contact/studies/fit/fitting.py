"""Problem -> Fit: parameters, how well they are known, whether the model describes the data at all."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import SolveError
from granular_contact.laws.scatter import MOST
from granular_contact.studies.fit import media_of_runs
from granular_contact.studies.fit.goodness import Goodness, goodness
from granular_contact.studies.fit.jacobian import jacobian
from granular_contact.studies.fit.plausible import unit_warnings
from granular_contact.studies.fit.problem import Problem
from granular_contact.studies.fit.responses import ModelFailed
from granular_contact.studies.fit.scatter import Scattering, separate
from granular_contact.studies.fit.solve import DIED, NEGLIGIBLE_COST, SAME_COST, Progress, Solution, solve
from granular_contact.studies.fit.uncertainty import Uncertainty, band, uncertainty

Vector = NDArray[np.float64]

BAND_POINTS = 241
DISTRUST = "the model does not describe these data, and the standard errors are too small"


@dataclass(frozen=True)
class Curve:
    """One run as fitted: times (m,) s of the measurement, model and half width of its 95 % band (m, columns)."""

    time: Vector
    model: Vector
    half_width: Vector


@dataclass(frozen=True)
class Fit:
    """Result of a fit. residuals: data less model (n, columns) of each run; curves: for figures.

    scatter: of the grains, where it was separated from noise.
    """

    problem: Problem
    solution: Solution
    uncertainty: Uncertainty
    goodness: Goodness
    residuals: tuple[Vector, ...]
    curves: tuple[Curve, ...]
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
        found += media_of_runs.words(self.problem, self.values)
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
    times = [np.linspace(time[0], time[-1], BAND_POINTS) for time in problem.times()]
    model = problem.split(problem.model(solution.scaled, times), times)
    width = problem.split(band(known, jacobian(problem, solution.scaled, times)), times)
    return Fit(
        problem,
        solution,
        known,
        goodness(problem, judged),
        tuple(problem.split(solution.residuals)),
        tuple(Curve(*one) for one in zip(times, model, width, strict=True)),
        grains,
    )
