"""Separate the scatter of grains, the noise of the sensor and the coefficients in repeated force tests.

A medium with scatter (`sand.kernels.scatter`) gives a force F (1 + s xi), where xi is a smooth random function of the
path of the body, with the length L. Residuals from scatter are proportional to the force and correlated over L; those
from a sensor are neither. With the force F of the law, the path w and the noise sigma, residuals have the covariance

    Omega_ij = s^2 F_i F_j rho((w_i - w_j) / L) + sigma^2 delta_ij

Estimates of s, L and sigma by maximum likelihood, and of the coefficients by generalised least squares with Omega,
alternate until the coefficients converge. rho is the correlation function of xi, averaged over the position of its
lattice. The force of a body of many strips scatters less than that of one strip; the ratio is estimated from four
hundred equal bodies in the medium.
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

MOST_ROWS = 1000  # greatest number of rows of a test: the run time grows with the cube
ROUNDS = 6  # greatest number of alternations between coefficients and scatter
SETTLED = 1e-3  # change of a coefficient, in standard errors, that ends the alternation
TRIED_LENGTHS = 5  # number of starting values of L, from three rows to a fifth of the path
STEP = 1e-2  # of the logarithms, in differences for the curvature of the likelihood
LEAST_SLOPE = 0.5  # least sine of the direction for which the path is computed from the depth


@dataclass(frozen=True)
class Scattering:
    """Scatter with standard errors: relative scatter of the body's force, its length (m), and the noise (SI).

    relative: relative scatter of the medium, on a piece no longer than the length. covariance: of the scaled parameters
    (p, p); white: residuals (values,) in units of the noise, whitened (without their correlation).
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


def path_length(measured: Measured, sine: float) -> Vector | None:
    """Path length (n,) m of the body, from its column or from the depth; None if neither determines it.

    sine: vertical component of the unit vector of the motion.
    """
    if PATH in measured.prescribed:
        return measured.prescribed[PATH]
    depth = measured.prescribed["depth_m"]
    if abs(sine) < LEAST_SLOPE or float(np.ptp(depth)) == 0.0:
        return None
    return np.concatenate([[0.0], np.cumsum(np.abs(np.diff(depth)))]) / abs(sine)


def faults(requests: Sequence[RunRequest], runs: Sequence[MeasuredRun]) -> Iterator[Fault]:
    """Faults of runs whose scatter cannot be separated from noise."""
    for request, run in zip(requests, runs, strict=True):
        model, measured = run.simulator, run.measured
        rows = len(measured.time)
        if not isinstance(model, LawAlone):
            fault = "is a run, but scatter can be separated from noise only in force tests"
        elif len(measured.columns) > 1:
            columns = ", ".join(measured.columns)
            fault = f"measures {columns}, but scatter can be separated from noise only in tests of one column"
        elif rows > MOST_ROWS:
            fault = f"has {rows} rows; at most {MOST_ROWS} are allowed with scatter: leave every second row out"
        elif path_length(measured, float(model.motion.along[1])) is None:
            fault = "does not determine the path of the body; "
            fault += "allowed is a column path_length_m (cm, mm, um), or a depth that increases"
        else:
            continue
        yield request.at_data.fault(("scatter",), f"{measured.file} {fault}")


def separate(problem: Problem, solution: Solution) -> tuple[Solution, Scattering]:
    """Estimate coefficients and scatter, starting from a solution that treats all residuals as noise.

    Raises ModelFailed.
    """
    times, paths, data = problem.times(), list(_paths(problem)), problem.data()
    scaled, (low, high) = solution.scaled, problem.bounds
    start = None
    for _ in range(ROUNDS):
        model = problem.model(scaled, times)
        slopes = jacobian(problem, scaled, times)
        tests = list(zip(paths, problem.split(model, times), problem.split(data - model, times), strict=True))
        tests = [(path, force[:, 0], residual[:, 0]) for path, force, residual in tests]
        logs = start = _maximum_likelihood(tests, start)
        rows, white = _whitened(tests, slopes, logs)
        covariance = np.asarray(np.linalg.pinv(rows.T @ rows), float)
        step = covariance @ rows.T @ white
        scaled = np.clip(scaled + step, low, high)
        if float(np.max(np.abs(step) / np.sqrt(np.maximum(np.diag(covariance), 1e-300)))) < SETTLED:
            break
    force, length, noise = np.exp(logs)
    errors = standard_errors(tests, logs)
    scattering = Scattering(
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
    return replace(solution, scaled=scaled, sigma=sigma, residuals=data - model, jacobian=slopes), scattering


def _paths(problem: Problem) -> Iterator[Vector]:
    for run in problem.runs:
        assert isinstance(run.simulator, LawAlone)  # `faults` refuses other runs
        path = path_length(run.measured, float(run.simulator.motion.along[1]))
        assert path is not None
        yield path


def correlation(lag: Vector) -> Vector:
    """Correlation of xi at lags in units of the length, averaged over the position of the lattice; 0 beyond lag 2."""
    grid, table = _table()
    return np.asarray(np.interp(np.abs(lag), grid, table, right=0.0))


@cache
def _table() -> tuple[Vector, Vector]:
    """Lags and correlations.

    A correlation is the sum over lattice points of the product of the weights at t and t + lag, averaged over the
    position t in a cell.
    """
    t, lags, points = np.linspace(0.0, 1.0, 64, endpoint=False)[:, None], np.linspace(0.0, 2.0, 65), np.arange(4.0)
    at_lag = _weight(np.abs(t + lags[:, None, None] - points))
    return lags, (_weight(np.abs(t - points)) * at_lag).sum(axis=2).mean(axis=1)


def _weight(distance: Vector) -> Vector:
    """Weight of a lattice point by its distance in units of the length; zero from one length on."""
    x = np.minimum(distance, 1.0)
    q = x * x * (3.0 - 2.0 * x)
    return np.asarray((1.0 - q) / np.hypot(1.0 - q, q))


def _omega(path: Vector, model: Vector, logs: Vector) -> Vector:
    """Covariance (n, n) of the residuals of a test; logs: logarithms of s, L and sigma."""
    force, length, noise = np.exp(logs)
    rho = correlation((path[:, None] - path[None, :]) / length)
    return np.asarray(force**2 * np.outer(model, model) * rho + noise**2 * np.eye(len(path)))


def _cost(tests: Sequence[Test], logs: Vector) -> float:
    """Twice the negative logarithm of the likelihood, but for a constant."""
    total = 0.0
    for path, model, residual in tests:
        try:
            factor = cho_factor(_omega(path, model, logs), lower=True)
        except np.linalg.LinAlgError:
            return np.inf
        total += float(residual @ cho_solve(factor, residual)) + 2.0 * float(np.sum(np.log(np.diag(factor[0]))))
    return total


def _maximum_likelihood(tests: Sequence[Test], start: Vector | None) -> Vector:
    """Logarithms of s, L and sigma by maximum likelihood, from a start or from the best of several lengths."""
    paths, models, residuals = zip(*tests, strict=True)
    residual, model = np.concatenate(residuals), np.concatenate(models)
    rms = float(np.sqrt(np.mean(residual**2)))
    size = rms / float(np.sqrt(np.mean(model**2)))
    step = float(np.median(np.concatenate([np.diff(path) for path in paths])))
    span = max(float(np.ptp(path)) for path in paths)
    lengths = np.geomspace(3.0 * step, max(0.2 * span, 4.0 * step), TRIED_LENGTHS)
    points = [np.log([size, length, 0.3 * rms]) for length in lengths] if start is None else [start]
    floor = np.log([1e-6, step, 1e-6 * rms])
    minimum = minimize(
        lambda logs: _cost(tests, np.maximum(logs, floor)),
        min(points, key=lambda logs: _cost(tests, logs)),
        method="Nelder-Mead",
        options={"xatol": 2e-3, "fatol": 1e-3, "maxiter": 200},
    )
    return np.asarray(np.maximum(minimum.x, floor))


def standard_errors(tests: Sequence[Test], logs: Vector) -> Vector:
    """Standard errors of the logarithms of s, L and sigma, from the curvature of the likelihood."""

    def mixed_difference(a: Vector, b: Vector) -> float:
        corners = ((1.0, a + b), (-1.0, a - b), (-1.0, b - a), (1.0, -a - b))
        return sum(sign * _cost(tests, logs + shift) for sign, shift in corners)

    curvature = np.array([[mixed_difference(a, b) for b in STEP * np.eye(3)] for a in STEP * np.eye(3)])
    inverse = np.linalg.pinv(curvature / (8.0 * STEP**2))  # of half the cost
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse), 0.0)))


def _whitened(tests: Sequence[Test], slopes: Vector, logs: Vector) -> tuple[Vector, Vector]:
    """Whiten derivatives (values, p) and residuals (values,): multiply them by the inverse Cholesky factor of Omega."""
    ends = np.cumsum([len(path) for path, _, _ in tests])[:-1]
    blocks = []
    for (path, model, residual), derivative in zip(tests, np.split(slopes, ends), strict=True):
        lower = np.linalg.cholesky(_omega(path, model, logs))
        blocks.append(solve_triangular(lower, np.column_stack([derivative, residual]), lower=True))
    white = np.concatenate(blocks)
    return white[:, :-1], white[:, -1]


def _share(problem: Problem, scaled: Vector, length: float) -> float:
    """Mean over all tests of `LawAlone.share`: scatter of a body's force relative to that of a piece."""
    x, shares = problem.values(scaled), []
    for run in problem.runs:
        assert isinstance(run.simulator, LawAlone)  # `faults` refuses other runs
        shares.append(run.simulator.share(tuple(float(x[i]) for i in run.acting), length))
    return float(np.mean(shares))
