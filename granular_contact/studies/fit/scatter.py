"""Repeated force tests: the scatter of grains, the noise of the sensor and the coefficients, separated.

A medium that scatters (`sand.kernels.scatter`) gives a force F (1 + s xi), xi a smooth random function of the path that
the body has gone, of the length L. Its residuals are as large as the force and alike over L; those of a sensor are
neither. With F the force of the law, path w and noise sigma the residuals have the covariance

    Omega_ij = s^2 F_i F_j rho((w_i - w_j) / L) + sigma^2 delta_ij

s, L and sigma are those of the greatest likelihood, the coefficients those of least squares in the measure of Omega, in
turn until neither changes. rho is that of the form of xi, averaged over where the lattice lies. A body of many strips
scatters less than one: its share is that of four hundred equal bodies in the medium.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.linalg import cho_factor, cho_solve, solve_triangular
from scipy.optimize import minimize

from granular_contact.errors import Fault
from granular_contact.studies.fit.law_alone import LawAlone
from granular_contact.studies.fit.measurements import PATH, Measured
from granular_contact.studies.fit.problem import MeasuredRun, Problem
from granular_contact.studies.fit.solve import Solution, jacobian
from granular_contact.studies.fit.specification import RunRequest
from granular_contact.values.arrays import Vector

# Path length (m), force of the law and residual of a test, (n,) each.
Test = tuple[Vector, Vector, Vector]

MOST_ROWS = 1000  # of a test: the time goes with their cube
ROUNDS, SETTLED = 6, 1e-3  # of coefficients and scatter in turn; change of a coefficient in its errors that ends them
TRIED_LENGTHS = 5  # starting points for L, from three rows to a fifth of the path
STEP = 1e-2  # of the logarithms, for the curvature of the likelihood
LEAST_SLOPE = 0.5  # sine of the direction from which on the path follows from the depth


@dataclass(frozen=True)
class Scattering:
    """Scatter with standard errors: of the body's force (-), its length (m), what is left as noise (SI).

    relative: of the medium, on a piece no longer than the length. covariance: of the scaled parameters (p, p); white:
    residuals (values,) in units of the noise, once what is alike in them is taken out.
    """

    force: float
    force_error: float
    length: float
    length_error: float
    noise: float
    relative: float
    covariance: Vector
    white: Vector

    @property
    def relative_error(self) -> float:
        """Standard error of `relative`."""
        return self.relative * self.force_error / self.force


def path_of(held: Measured, sine: float) -> Vector | None:
    """Path length (n,) m of the body, as its column has it or from the depth; None where neither does."""
    if PATH in held.given:
        return held.given[PATH]
    depth = held.given["depth_m"]
    if abs(sine) < LEAST_SLOPE or float(np.ptp(depth)) == 0.0:
        return None
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(depth)))]) / abs(sine)


def faults(requests: Sequence[RunRequest], runs: Sequence[MeasuredRun]) -> Iterator[Fault]:
    """Why the scatter of these runs can't be separated from noise."""
    for request, run in zip(requests, runs, strict=True):
        model, held = run.simulator, run.measured
        if not isinstance(model, LawAlone):
            words = "is a run, and scatter is separated from noise in force tests alone"
        elif len(held.columns) > 1:
            words = f"measures {', '.join(held.columns)}, and scatter is separated from noise in tests of one column"
        elif len(held.time) > MOST_ROWS:
            words = (
                f"has {len(held.time)} rows; at most {MOST_ROWS} are allowed with scatter: leave every other one out"
            )
        elif path_of(held, float(model.motion.along[1])) is None:
            words = "does not say how far the body went; "
            words += "allowed is a column path_length_m (cm, mm, um), or a depth that grows"
        else:
            continue
        yield request.at_data.fault(("scatter",), f"{held.file} {words}")


def separate(problem: Problem, solution: Solution) -> tuple[Solution, Scattering]:
    """Coefficients and scatter, from the coefficients of a fit that took all for noise; raises ModelFailed."""
    times, paths, data = problem.times(), list(_paths(problem)), problem.data()
    scaled, (low, high) = solution.scaled, problem.bounds
    start = None
    for _ in range(ROUNDS):
        model = problem.model(scaled, times)
        slopes = jacobian(problem, scaled, times)
        tests = list(zip(paths, problem.split(model, times), problem.split(data - model, times), strict=True))
        tests = [(path, own[:, 0], rest[:, 0]) for path, own, rest in tests]
        logs = start = _likeliest(tests, start)
        rows, white = _whitened(tests, slopes, logs)
        covariance = np.asarray(np.linalg.pinv(rows.T @ rows), float)
        step = covariance @ rows.T @ white
        scaled = np.clip(scaled + step, low, high)
        if float(np.max(np.abs(step) / np.sqrt(np.maximum(np.diag(covariance), 1e-300)))) < SETTLED:
            break
    force, length, noise = np.exp(logs)
    errors = _errors(tests, logs)
    found = Scattering(
        float(force),
        float(force * errors[0]),
        float(length),
        float(length * errors[1]),
        float(noise),
        float(force) / _share(problem, scaled, float(length)),
        covariance,
        white,
    )
    sigma = np.full(len(problem.columns), float(noise))
    return replace(solution, scaled=scaled, sigma=sigma, residuals=data - model, jacobian=slopes), found


def _paths(problem: Problem) -> Iterator[Vector]:
    for run in problem.runs:
        assert isinstance(run.simulator, LawAlone)  # or there was a fault
        path = path_of(run.measured, float(run.simulator.motion.along[1]))
        assert path is not None
        yield path


def correlation(lag: Vector) -> Vector:
    """Correlation of xi over lags in lengths, averaged over where the lattice lies; 0 from two lengths on."""
    grid, table = _table()
    return np.asarray(np.interp(np.abs(lag), grid, table, right=0.0))


@cache
def _table() -> tuple[Vector, Vector]:
    """Lags, and the mean over the place t in a cell of the sum over lattice points of the weights at t and t + lag."""
    t, grid, points = np.linspace(0.0, 1.0, 64, endpoint=False)[:, None], np.linspace(0.0, 2.0, 65), np.arange(4.0)
    there = _weight(np.abs(t + grid[:, None, None] - points))
    return grid, (_weight(np.abs(t - points)) * there).sum(axis=2).mean(axis=1)


def _weight(distance: Vector) -> Vector:
    """Weight of a lattice point by its distance in lengths; none from one length on."""
    x = np.minimum(distance, 1.0)
    q = x * x * (3.0 - 2.0 * x)
    return np.asarray((1.0 - q) / np.hypot(1.0 - q, q))


def _omega(path: Vector, model: Vector, logs: Vector) -> Vector:
    force, length, noise = np.exp(logs)
    alike = correlation((path[:, None] - path[None, :]) / length)
    return np.asarray(force**2 * np.outer(model, model) * alike + noise**2 * np.eye(len(path)))


def _cost(tests: Sequence[Test], logs: Vector) -> float:
    """Half the negative logarithm of the likelihood, twice."""
    total = 0.0
    for path, model, rest in tests:
        try:
            factor = cho_factor(_omega(path, model, logs), lower=True)
        except np.linalg.LinAlgError:
            return np.inf
        total += float(rest @ cho_solve(factor, rest)) + 2.0 * float(np.sum(np.log(np.diag(factor[0]))))
    return total


def _likeliest(tests: Sequence[Test], start: Vector | None) -> Vector:
    """Logarithms of s, L and sigma of the greatest likelihood, from an earlier one or from several lengths."""
    paths, models, residuals = zip(*tests, strict=True)
    rest, model = np.concatenate(residuals), np.concatenate(models)
    rms = float(np.sqrt(np.mean(rest**2)))
    size = rms / float(np.sqrt(np.mean(model**2)))
    step = float(np.median(np.concatenate([np.diff(path) for path in paths])))
    span = max(float(np.ptp(path)) for path in paths)
    lengths = np.geomspace(3.0 * step, max(0.2 * span, 4.0 * step), TRIED_LENGTHS)
    points = [np.log([size, length, 0.3 * rms]) for length in lengths] if start is None else [start]
    floor = np.log([1e-6, step, 1e-6 * rms])
    found = minimize(
        lambda one: _cost(tests, np.maximum(one, floor)),
        min(points, key=lambda one: _cost(tests, one)),
        method="Nelder-Mead",
        options={"xatol": 2e-3, "fatol": 1e-3, "maxiter": 200},
    )
    return np.asarray(np.maximum(found.x, floor))


def _errors(tests: Sequence[Test], logs: Vector) -> Vector:
    """Standard errors of the logarithms, from the curvature of the likelihood."""

    def curved(a: Vector, b: Vector) -> float:
        corners = ((1.0, a + b), (-1.0, a - b), (-1.0, b - a), (1.0, -a - b))
        return sum(sign * _cost(tests, logs + x) for sign, x in corners)

    curvature = np.array([[curved(a, b) for b in STEP * np.eye(3)] for a in STEP * np.eye(3)])
    inverse = np.linalg.pinv(curvature / (8.0 * STEP**2))  # of half the cost
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse), 0.0)))


def _whitened(tests: Sequence[Test], slopes: Vector, logs: Vector) -> tuple[Vector, Vector]:
    """Derivatives (values, p) and residuals (values,) in the measure of Omega."""
    ends = np.cumsum([len(path) for path, _, _ in tests])[:-1]
    found = []
    for (path, model, rest), derivative in zip(tests, np.split(slopes, ends), strict=True):
        lower = np.linalg.cholesky(_omega(path, model, logs))
        found.append(solve_triangular(lower, np.column_stack([derivative, rest]), lower=True))
    both = np.concatenate(found)
    return both[:, :-1], both[:, -1]


def _share(problem: Problem, scaled: Vector, length: float) -> float:
    """Scatter of the body's force over that of a piece no longer than the length; the mean of all tests."""
    x, shares = problem.values(scaled), []
    for run in problem.runs:
        assert isinstance(run.simulator, LawAlone)  # or there was a fault
        shares.append(run.simulator.share(tuple(float(x[i]) for i in run.acting), length))
    return float(np.mean(shares))
