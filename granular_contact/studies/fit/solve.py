"""Problem -> the best parameters: least squares from several starting points, then weighted by the noise.

Derivatives of the model by its parameters, by central differences in the scaled parameters.

A reduced run with the default rtol of 1e-6 is off by 2e-8 m, and rough by less. A step of 0.3 % is long against that
and short against the curvature of the curves: derivatives are right to 1e-5 for a rigid link. For one that bends the
steps that the integrator chooses differ between neighbouring runs: over six impacts errors were 0.03 to 0.2 % by the
median, and 1.2 % at the worst, 1.6 % with another integrator (measured against rtol 1e-10, tests/fit/test_jacobian.py).
Standard errors inherit that.
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

# Told after each starting point how many are done, and of how many.
Progress = Callable[[int, int], None]

MOST_EVALUATIONS = 60
MOST_ROUNDS = 8  # of weights and parameters in turn
NOISE_TOLERANCE = 1e-3  # relative change of the noise that ends them
COARSE_TOLERANCE, FINE_TOLERANCE = 1e-4, 1e-7  # tolerances of the path into a basin, and to its bottom
FAILED_RESIDUAL = 1e6  # residual of parameters for which the model fails
SAME_COST = 0.02  # relative difference of cost between starts that came to the same end
DIED = "the process died"
NEGLIGIBLE_COST = 1e-7  # cost for each value of data that are met but for the errors of the computation


@dataclass(frozen=True)
class Start:
    """End of one start: scaled parameters and half the sum of squares, or the problem that it ended with."""

    scaled: Vector
    cost: float
    problem: str | None = None


@dataclass(frozen=True)
class Solution:
    """The best fit. scaled: parameters (p,); sigma: noise (columns,); residuals: (values,) data less model.

    jacobian: of the model (values, p); at_bound: -1, 0, 1 for each parameter; starts: of all tries.
    """

    scaled: Vector
    sigma: Vector
    residuals: Vector
    jacobian: Vector
    at_bound: NDArray[np.int64]
    starts: tuple[Start, ...]
    converged: bool


def solve(problem: Problem, workers: int = 1, progress: Progress | None = None) -> Solution:
    """Fit from several starts, in `workers` processes, and refine the best.

    Raises
    ------
    SolveError
        The model fails wherever it is started.
    """
    starts = _from_all(problem, workers, progress)
    alive = [one for one in starts if one.problem is None]
    if not alive:
        raise SolveError(f"the model fails at every starting point; at the first: {starts[0].problem}")
    best = min(alive, key=lambda one: one.cost)
    try:
        return _refined(problem, best.scaled, tuple(starts))
    except ModelFailed as error:
        raise SolveError(f"the model fails near the best parameters: {error}") from error


def starting_points(problem: Problem) -> list[Vector]:
    """The given start, then a Sobol sequence within the bounds (scaled); offsets of clocks start as given."""
    low, high = problem.bounds
    points = [np.clip(problem.start, low, high)]
    if problem.starts > 1:
        shares = qmc.Sobol(len(low), seed=problem.seed).random_base2(int(np.ceil(np.log2(problem.starts))))
        for share in shares[: problem.starts - 1]:
            point = low + share * (high - low)
            own = np.array([not p.shared for p in problem.parameters])
            points.append(np.where(own, points[0], point))
    return points


def _from_all(problem: Problem, workers: int, progress: Progress | None) -> list[Start]:
    points = starting_points(problem)
    workers = min(workers, len(points))
    here = ((i, descend(problem, point)) for i, point in enumerate(points))
    found: dict[int, Start] = {}
    for i, start in _from_processes(problem, points, workers) if workers > 1 else here:
        found[i] = start
        if progress is not None:
            progress(len(found), len(points))
    return [found[i] for i in range(len(points))]


def _from_processes(problem: Problem, points: list[Vector], workers: int) -> Iterator[tuple[int, Start]]:
    """Index and end of each start, as they come.

    A start whose process dies is tried once more in a new process, as it may have been killed from outside; never in
    this process.
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
    """Least squares from a point; columns are weighted by their standard deviation, as the noise is not known yet."""
    data, column = problem.data(), problem.column_of()
    spread = np.array([max(float(np.std(data[column == k])), 1e-12) for k in range(len(problem.columns))])
    try:
        problem.model(point, problem.times())
        found = minimise(problem, point, spread, "linear", COARSE_TOLERANCE, rough=True)
    except ModelFailed as error:
        return Start(point, np.inf, str(error))
    return Start(found.x, float(found.cost))


def minimise(
    problem: Problem, point: Vector, sigma: Vector, loss: Loss, tolerance: float = FINE_TOLERANCE, rough: bool = False
) -> Any:
    """`scipy.optimize.least_squares` of residuals in units of sigma (columns,); raises ModelFailed."""
    data, weights, times = problem.data(), 1.0 / sigma[problem.column_of()], problem.times()

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
    """Parameters and noise in turn, until the noise has converged."""
    column, floors = problem.column_of(), diagnostics.floors(problem)
    residuals = problem.data() - problem.model(point, problem.times())
    sigma = estimate_noise(problem, residuals, column, floors)
    settled = False
    for _ in range(MOST_ROUNDS):
        found = minimise(problem, point, sigma, problem.loss)
        point = found.x
        residuals = problem.data() - problem.model(point, problem.times())
        new = estimate_noise(problem, residuals, column, floors)
        settled = bool(np.all(np.abs(new - sigma) <= NOISE_TOLERANCE * sigma))
        sigma = new
        if settled:
            break
    return Solution(
        scaled=point,
        sigma=sigma,
        residuals=residuals,
        jacobian=jacobian(problem, point, problem.times()),
        at_bound=_at_bound(problem, point),
        starts=starts,
        converged=bool(found.status > 0) and settled,
    )


def estimate_noise(problem: Problem, residuals: Vector, column: NDArray[np.intp], floors: Vector) -> Vector:
    """Noise (columns,): as given, else from the residuals (values,)."""
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
    near = 1e-4 * (high - low)
    return np.where(point <= low + near, -1, np.where(point >= high - near, 1, 0))


STEP = 3e-3


def jacobian(problem: Problem, scaled: Vector, times: Sequence[Vector], rough: bool = False) -> Vector:
    """Derivatives (values, parameters) of `problem.model`; rough: one-sided, for half the runs. Raises ModelFailed."""
    blocks = [len(time) * len(run.measured.columns) for run, time in zip(problem.runs, times, strict=True)]
    ends = np.cumsum(blocks)
    result = np.zeros((ends[-1], len(problem.parameters)))
    for j, parameter in enumerate(problem.parameters):
        shifts, weights = _stencil(parameter, float(scaled[j]), rough)
        for i in parameter.runs:
            run = problem.runs[i]
            block = slice(ends[i] - blocks[i], ends[i])
            for shift, weight in zip(shifts, weights, strict=True):
                moved = scaled.copy()
                moved[j] += shift
                result[block, j] += weight * run.at(problem.values(moved), times[i]).ravel()
    return result


def _stencil(parameter: Parameter, at: float, rough: bool) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Shifts and weights of a difference that stays within the bounds, of second order unless rough."""
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
