"""Standard errors and correlations of the parameters, and combinations that the data do not determine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.problem import Parameter, Problem
from granular_contact.studies.fit.solve import Solution
from granular_contact.values.arrays import Vector

# Relative standard error along an axis of the error ellipsoid, and the components of the axis by parameter label.
Direction = tuple[float, dict[str, float]]
Directions = tuple[Direction, ...]

CONFIDENCE_LEVEL = 0.95
LARGE_RELATIVE_ERROR = 0.10  # above this relative standard error a parameter counts as not determined
HIGH_CORRELATION = 0.95  # from this correlation on two parameters are hard to distinguish
LEAST_SINGULAR_VALUE = 1e-9  # relative to the largest; smaller singular values are round-off
LARGEST_HALF_WIDTH = 100.0  # of an interval, in scaled units; wider intervals are reported as unlimited


@dataclass(frozen=True)
class Estimate:
    """An estimated parameter with standard error and 95 % interval; at_bound: -1 or 1 at a bound, else 0.

    Error and interval are infinite if the data do not determine the parameter.
    """

    parameter: Parameter
    value: float
    error: float
    low: float
    high: float
    at_bound: int


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of the parameters of a fit.

    covariance: of the scaled parameters (p, p); correlation: (p, p). directions: axes of the error ellipsoid of the
    shared parameters, the least determined first. warnings: about parameters that the data do not determine or
    distinguish. quantile: of Student's t for the 95 % interval.
    """

    estimates: tuple[Estimate, ...]
    covariance: Vector
    correlation: Vector
    directions: Directions
    warnings: tuple[str, ...]
    quantile: float


def uncertainty(problem: Problem, solution: Solution, covariance: Vector | None = None) -> Uncertainty:
    """Standard errors from the curvature at the solution and the scatter of the residuals, or from a given covariance.

    A parameter at its bound is treated like the others. If it counted as known, parameters correlated with it would
    seem well determined, too.
    """
    if covariance is None:
        covariance = _covariance(problem, solution)
    deviation = np.sqrt(np.diag(covariance))
    finite = np.isfinite(deviation)
    product = np.outer(deviation, deviation)
    correlation = np.divide(covariance, product, out=np.full_like(product, np.nan), where=np.outer(finite, finite))
    quantile = float(student.ppf(0.5 + 0.5 * CONFIDENCE_LEVEL, degrees_of_freedom(problem)))
    estimates = tuple(
        _estimate(parameter, float(scaled), float(width), quantile, int(bound))
        for parameter, scaled, width, bound in zip(
            problem.parameters, solution.scaled, deviation, solution.at_bound, strict=True
        )
    )
    directions = tuple(_directions(problem, solution, covariance))
    undetermined = (estimate.parameter.label for estimate in estimates if _own_without_effect(estimate))
    warnings = (
        *_bound_warnings(estimates, covariance),
        *_direction_warnings(directions),
        *(f"{label} is not determined by these data" for label in undetermined),
        *_correlation_warnings(problem, deviation, correlation, directions),
    )
    return Uncertainty(estimates, covariance, correlation, directions, tuple(dict.fromkeys(warnings)), quantile)


def degrees_of_freedom(problem: Problem) -> int:
    """Number of measured values minus number of parameters, at least 1."""
    return max(len(problem.data()) - len(problem.parameters), 1)


def _covariance(problem: Problem, solution: Solution) -> Vector:
    """Covariance of M-estimates: A^-1 B A^-1, A the sum of E psi' J^T J over the columns, B that of E psi^2 J^T J.

    J is in units of the noise. The means E are taken for each column separately. With common means, the tiny residuals
    of a column whose noise was given far too large would reduce the scatter of all other columns. With a linear loss
    and estimated noise the covariance is (J^T J)^-1.
    """
    column = problem.column_indices()
    sigma = solution.sigma[column]
    slope, square = _slopes_and_squares(problem, solution)
    rows = solution.jacobian * (np.sqrt(slope[column]) / sigma)[:, None]
    # Columns are scaled to unit length, so that the rank does not depend on units.
    length = np.linalg.norm(rows, axis=0)
    active = np.flatnonzero(length > 0.0)
    covariance = np.diag(np.where(length > 0.0, 0.0, np.inf))  # infinite for parameters without effect
    if len(active):
        left, singular, right = np.linalg.svd(rows[:, active] / length[active], full_matrices=False)
        # With rows = left S right, A is rows^T rows, and B the same with each row weighted by square / slope.
        middle = left.T @ (left * (square / slope)[column][:, None])
        outer = right.T / np.maximum(singular, LEAST_SINGULAR_VALUE * singular[0])
        inside = outer @ middle @ outer.T / np.outer(length[active], length[active])
        covariance[np.ix_(active, active)] = inside
    return covariance


def _slopes_and_squares(problem: Problem, solution: Solution) -> tuple[Vector, Vector]:
    """E psi' and E psi^2 (columns,); the latter is corrected for the degrees of freedom that the fit used.

    If residuals are smaller than the given noise, or than the errors of the computation, that noise is used instead.
    """
    column = problem.column_indices()
    f = solution.residuals / solution.sigma[column]
    remaining = degrees_of_freedom(problem) / len(f)
    columns = range(len(problem.columns))
    slope = np.array([np.mean(diagnostics.psi_slope(f[column == k], problem.loss)) for k in columns])
    square = np.array([np.mean(diagnostics.psi(f[column == k], problem.loss) ** 2) / remaining for k in columns])
    given = np.array([noise is not None for noise in problem.noise.values()])
    is_known = given | diagnostics.at_floor(problem, solution.sigma)
    return slope, np.where(is_known, np.maximum(square, slope**2), square)


def _estimate(parameter: Parameter, scaled: float, deviation: float, quantile: float, bound: int) -> Estimate:
    value = parameter.value(scaled)
    reach = quantile * deviation
    if reach > LARGEST_HALF_WIDTH:
        low, high = (0.0 if parameter.log else -np.inf), np.inf
    else:
        low, high = (parameter.unbounded(scaled + sign * reach) for sign in (-1, 1))
    return Estimate(parameter, value, abs(parameter.slope(value)) * deviation, low, high, bound)


def _own_without_effect(estimate: Estimate) -> bool:
    """Return whether it is a parameter of a single run, which the directions do not contain, without any effect."""
    return not estimate.parameter.shared and not np.isfinite(estimate.error)


def _directions(problem: Problem, solution: Solution, covariance: Vector) -> Iterator[Direction]:
    """Axes of the error ellipsoid of the shared parameters, relative to their values: longest first."""
    shared = [j for j, p in enumerate(problem.parameters) if p.shared]
    finite = [j for j in shared if np.isfinite(covariance[j, j])]
    yield from ((np.inf, {problem.parameters[j].label: 1.0}) for j in shared if j not in finite)
    relative = np.array([_relative(problem.parameters[j], float(solution.scaled[j])) for j in finite])
    if not finite:
        return
    values, vectors = np.linalg.eigh(covariance[np.ix_(finite, finite)] * np.outer(relative, relative))
    for k in np.argsort(values)[::-1]:
        vector = vectors[:, k] * np.sign(vectors[np.argmax(np.abs(vectors[:, k])), k])
        yield (
            float(np.sqrt(max(values[k], 0.0))),
            {problem.parameters[j].label: float(v) for j, v in zip(finite, vector, strict=True)},
        )


def _relative(parameter: Parameter, scaled: float) -> float:
    """Relative change of a value per change of the scaled value; relative to the range for a linear value near zero."""
    if parameter.log:
        return 1.0
    return parameter.unit / max(abs(parameter.value(scaled)), 1e-3 * parameter.unit)


def _bound_warnings(estimates: Sequence[Estimate], covariance: Vector) -> Iterator[str]:
    for j, estimate in enumerate(estimates):
        if not estimate.at_bound:
            continue
        parameter = estimate.parameter
        side, bound = ("upper", parameter.high) if estimate.at_bound > 0 else ("lower", parameter.low)
        scaled = parameter.scaled(estimate.value)
        if _relative(parameter, scaled) * np.sqrt(covariance[j, j]) > LARGE_RELATIVE_ERROR:
            reason = "the data hardly determine it"
        else:
            reason = "the best value is beyond it: widen the bounds, or check the model"
        yield f"{parameter.label} is at its {side} bound, {bound:g}: {reason}"


def _direction_warnings(directions: Directions) -> Iterator[str]:
    """A sentence for each parameter or combination of parameters that the data do not determine."""
    for members in map(_members, directions):
        names = list(members)
        errors = [f"{100 * error:.0f} %" if error < 3.0 else "unlimited" for error in members.values()]
        if len(names) == 1:
            yield f"{names[0]} is not determined by these data: its standard error is {errors[0]}"
        elif names:
            yield (
                f"{_listed(names)}: only their combination is determined by these data, not each alone; their standard "
                f"errors are {_listed(errors)}, and compensate each other"
            )


def _members(direction: Direction) -> dict[str, float]:
    """Parameters whose relative standard error along a direction exceeds `LARGE_RELATIVE_ERROR`, with this error."""
    size, parts = direction
    return {label: size * abs(part) for label, part in parts.items() if size * abs(part) > LARGE_RELATIVE_ERROR}


def _listed(entries: Sequence[str]) -> str:
    return f"{', '.join(entries[:-1])} and {entries[-1]}"


def _correlation_warnings(
    problem: Problem, deviation: Vector, correlation: Vector, directions: Directions
) -> Iterator[str]:
    """Warnings about pairs of highly correlated parameters that no other warning names together."""
    named = [set(_members(direction)) for direction in directions]
    low, high = problem.bounds
    relative_deviation = deviation / (high - low)
    for i, first in enumerate(problem.parameters):
        for j, second in enumerate(problem.parameters[:i]):
            close = np.isfinite(correlation[i, j]) and abs(correlation[i, j]) >= HIGH_CORRELATION
            are_open = min(relative_deviation[i], relative_deviation[j]) > 1.0
            if close and not first.shared and not second.shared and are_open:
                yield (
                    f"{second.label} and {first.label} can't be distinguished by these data: for any value of one "
                    "there is a value of the other that fits as well; give one of them a fixed number"
                )
            elif close and not any({first.label, second.label} <= names for names in named):
                yield f"{second.label} and {first.label} are hard to distinguish: correlation {correlation[i, j]:+.3f}"


def band(uncertainty: Uncertainty, derivatives: Vector) -> Vector:
    """Half width (values,) of the 95 % band of the model, from derivatives (values, p) by the scaled parameters."""
    # Parameters of infinite variance have no effect, so their derivatives are zero.
    covariance = np.where(np.isfinite(uncertainty.covariance), uncertainty.covariance, 0.0)
    variance = np.einsum("ij,jk,ik->i", derivatives, covariance, derivatives)
    return np.asarray(uncertainty.quantile * np.sqrt(np.maximum(variance, 0.0)))
