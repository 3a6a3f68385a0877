"""Solve a fit: least squares from several starting points, then refined with weights from the noise.

Derivatives of the model with respect to the scaled parameters are central differences. A reduced run with the default
rtol of 1e-6 has an error of 2e-8 m, and is smooth to less than that. A step of 0.3 % is large compared with this error
and small compared with the curvature of the curves: for a rigid link derivatives have an error of 1e-5. For a flexible
link neighbouring runs have different time steps: over six impacts errors were 0.03 to 0.2 % in the median and at most
1.2 %, 1.6 % with another integrator (measured against rtol 1e-10, tests/fit/test_jacobian.py). Standard errors have the
same relative error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, as_completed
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import qmc

from granular_contact.errors import SolveError
from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.problem import Loss, Parameter, Problem
from granular_contact.studies.fit.responses import ModelFailed
from granular_contact.values.arrays import Vector

# Called after each starting point with the number of finished starting points and their total number.
Progress = Callable[[int, int], None]

MOST_EVALUATIONS = 60  # greatest number of evaluations in one minimisation
MOST_ROUNDS = 8  # greatest number of alternations between parameters and noise
NOISE_TOLERANCE = 1e-3  # relative change of the noise that ends the alternation
COARSE_TOLERANCE, FINE_TOLERANCE = 1e-4, 1e-7  # tolerances of the search from each start, and of the refinement
FAILED_RESIDUAL = 1e6  # residual of parameters for which the model fails
SAME_COST = 0.02  # relative tolerance of the cost of starts that ended at the same minimum
DIED = "the process died"
NEGLIGIBLE_COST = 1e-7  # cost per value that is due to errors of the computation alone


@dataclass(frozen=True)
class Start:
    """Result of the search from one starting point: scaled parameters and half the sum of squares, or its failure."""

    scaled: Vector
    cost: float
    problem: str | None = None


@dataclass(frozen=True)
class Solution:
    """The best fit. scaled: parameters (p,); sigma: noise (columns,); residuals: (values,) data minus model.

    jacobian: of the model (values, p); at_bound: -1, 0 or 1 for each parameter; starts: results of all starting points.
    """

    scaled: Vector
    sigma: Vector
    residuals: Vector
    jacobian: Vector
    at_bound: NDArray[np.int64]
    starts: tuple[Start, ...]
    converged: bool


def solve(problem: Problem, workers: int = 1, progress: Progress | None = None) -> Solution:
    """Fit from several starting points, in `workers` processes, and refine the best result.

    Raises
    ------
    SolveError
        The model fails at every starting point.
    """
    starts = _from_all(problem, workers, progress)
    successful = [start for start in starts if start.problem is None]
    if not successful:
        raise SolveError(f"the model fails at every starting point; at the first: {starts[0].problem}")
    best = min(successful, key=lambda start: start.cost)
    try:
        return _refined(problem, best.scaled, tuple(starts))
    except ModelFailed as error:
        raise SolveError(f"the model fails near the best parameters: {error}") from error


def starting_points(problem: Problem) -> list[Vector]:
    """Starting points (scaled): the given start, then a Sobol sequence within the bounds.

    Parameters of single runs, as offsets of clocks, always have their given start.
    """
    low, high = problem.bounds
    points = [np.clip(problem.start, low, high)]
    if problem.starts > 1:
        is_own = np.array([not parameter.shared for parameter in problem.parameters])
        fractions = qmc.Sobol(len(low), seed=problem.seed).random_base2(int(np.ceil(np.log2(problem.starts))))
        for fraction in fractions[: problem.starts - 1]:
            point = low + fraction * (high - low)
            points.append(np.where(is_own, points[0], point))
    return points


def _from_all(problem: Problem, workers: int, progress: Progress | None) -> list[Start]:
    points = starting_points(problem)
    workers = min(workers, len(points))
    in_this_process = ((i, descend(problem, point)) for i, point in enumerate(points))
    starts: dict[int, Start] = {}
    for i, start in _from_processes(problem, points, workers) if workers > 1 else in_this_process:
        starts[i] = start
        if progress is not None:
            progress(len(starts), len(points))
    return [starts[i] for i in range(len(points))]


def _from_processes(problem: Problem, points: list[Vector], workers: int) -> Iterator[tuple[int, Start]]:
    """Yield index and result of each starting point, in the order in which they finish.

    A start whose process dies is repeated once in a new process, because the process may have been killed from outside.
    It is never repeated in this process, which could die as well.
    """
    from granular_contact.studies.processes import local_processes

    lost: list[int] = []
    with local_processes(workers) as pool:
        tasks = {pool.submit(descend, problem, point): i for i, point in enumerate(points)}
        for task in as_completed(tasks):
            if isinstance(task.exception(), BrokenExecutor):
                lost.append(tasks[task])
            else:
                yield tasks[task], task.result()
    for i in sorted(lost):
        with local_processes(1) as alone:
            task = alone.submit(descend, problem, points[i])
            died = isinstance(task.exception(), BrokenExecutor)
        yield i, Start(points[i], np.inf, DIED) if died else task.result()


def descend(problem: Problem, point: Vector) -> Start:
    """Search from a starting point by least squares.

    Columns are weighted by the standard deviation of their data, because the noise is not known yet.
    """
    data, column = problem.data(), problem.column_indices()
    deviation = np.array([max(float(np.std(data[column == k])), 1e-12) for k in range(len(problem.columns))])
    try:
        problem.model(point, problem.times())
        minimum = minimise(problem, point, deviation, "linear", COARSE_TOLERANCE, rough=True)
    except ModelFailed as error:
        return Start(point, np.inf, str(error))
    return Start(minimum.x, float(minimum.cost))


def minimise(
    problem: Problem, point: Vector, sigma: Vector, loss: Loss, tolerance: float = FINE_TOLERANCE, rough: bool = False
) -> Any:
    """Minimise residuals in units of sigma (columns,) by `scipy.optimize.least_squares`; raises ModelFailed."""
    data, weights, times = problem.data(), 1.0 / sigma[problem.column_indices()], problem.times()

    def residuals(scaled: Vector) -> Vector:
        try:
            return (problem.model(scaled, times) - data) * weights
        except ModelFailed:
            return np.full(len(data), FAILED_RESIDUAL)

    return least_squares(
        residuals,
        point,
        jac=lambda scaled: jacobian(problem, scaled, times, rough) * weights[:, None],
        bounds=problem.bounds,
        x_scale="jac",
        loss=loss,
        f_scale=diagnostics.LOSS_SCALE,
        ftol=tolerance,
        xtol=tolerance,
        gtol=tolerance,
        max_nfev=MOST_EVALUATIONS,
    )


def _refined(problem: Problem, point: Vector, starts: tuple[Start, ...]) -> Solution:
    """Refine the parameters: fit and estimate the noise in turn, until the noise has converged."""
    column, floors = problem.column_indices(), diagnostics.floors(problem)
    residuals = problem.data() - problem.model(point, problem.times())
    sigma = estimate_noise(problem, residuals, column, floors)
    noise_converged = False
    for _ in range(MOST_ROUNDS):
        minimum = minimise(problem, point, sigma, problem.loss)
        point = minimum.x
        residuals = problem.data() - problem.model(point, problem.times())
        new = estimate_noise(problem, residuals, column, floors)
        noise_converged = bool(np.all(np.abs(new - sigma) <= NOISE_TOLERANCE * sigma))
        sigma = new
        if noise_converged:
            break
    return Solution(
        scaled=point,
        sigma=sigma,
        residuals=residuals,
        jacobian=jacobian(problem, point, problem.times()),
        at_bound=_at_bound(problem, point),
        starts=starts,
        converged=bool(minimum.status > 0) and noise_converged,
    )


def estimate_noise(problem: Problem, residuals: Vector, column: NDArray[np.intp], floors: Vector) -> Vector:
    """Noise (columns,): as given, otherwise estimated from the residuals (values,)."""
    share = min(len(problem.parameters) / len(residuals), 0.5)
    return np.array(
        [
            given
            if given is not None
            else max(diagnostics.scale(residuals[column == k], problem.loss, share), floors[k])
            for k, given in enumerate(problem.noise.values())
        ]
    )


def _at_bound(problem: Problem, point: Vector) -> NDArray[np.int64]:
    low, high = problem.bounds
    tolerance = 1e-4 * (high - low)
    return np.where(point <= low + tolerance, -1, np.where(point >= high - tolerance, 1, 0))


STEP = 3e-3  # of a difference, in scaled parameters


def jacobian(problem: Problem, scaled: Vector, times: Sequence[Vector], rough: bool = False) -> Vector:
    """Derivatives (values, parameters) of `problem.model`; raises ModelFailed.

    rough: one-sided differences, which need half the runs.
    """
    blocks = [len(time) * len(run.measured.columns) for run, time in zip(problem.runs, times, strict=True)]
    ends = np.cumsum(blocks)
    result = np.zeros((ends[-1], len(problem.parameters)))
    for j, parameter in enumerate(problem.parameters):
        shifts, weights = _stencil(parameter, float(scaled[j]), rough)
        for i in parameter.runs:
            run = problem.runs[i]
            block = slice(ends[i] - blocks[i], ends[i])
            for shift, weight in zip(shifts, weights, strict=True):
                shifted = scaled.copy()
                shifted[j] += shift
                result[block, j] += weight * run.at(problem.values(shifted), times[i]).ravel()
    return result


def _stencil(parameter: Parameter, at: float, rough: bool) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Shifts and weights of a finite difference within the bounds; of second order, or of first order if rough."""
    low, high = parameter.scaled(parameter.low), parameter.scaled(parameter.high)
    h = min(STEP, 0.25 * (high - low))
    if rough:
        h = h if at + h <= high else -h
        return (0.0, h), (-1.0 / h, 1.0 / h)
    if at - h < low:
        return (0.0, h, 2 * h), (-1.5 / h, 2.0 / h, -0.5 / h)
    if at + h > high:
        return (0.0, -h, -2 * h), (1.5 / h, -2.0 / h, 0.5 / h)
    return (-h, h), (-0.5 / h, 0.5 / h)
