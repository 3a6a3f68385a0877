"""Solution -> standard errors and correlations of the parameters, and combinations that the data leave open."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import t as student

from granular_contact.studies.fit import diagnostics
from granular_contact.studies.fit.problem import Parameter, Problem
from granular_contact.studies.fit.solve import Solution
from granular_contact.values.arrays import Vector

# Relative standard error along an axis of the ellipsoid of errors, and the parts of its direction by label.
Direction = tuple[float, dict[str, float]]
Directions = tuple[Direction, ...]

CONFIDENCE_LEVEL = 0.95
LARGE_RELATIVE_ERROR = 0.10  # from this standard error on a parameter counts as not determined
HIGH_CORRELATION = 0.95  # correlation of parameters that are hard to distinguish
LEAST_SINGULAR_VALUE = 1e-9  # relative to the largest one: less is round-off
LARGEST_HALF_WIDTH = 100.0  # of an interval, in powers of e or lengths of the scale: wider ones say nothing


@dataclass(frozen=True)
class Estimate:
    """An estimated parameter with standard error and 95 % interval; at_bound: -1 or 1 at a bound, else 0.

    Both are infinite where the data do not determine it.
    """

    parameter: Parameter
    value: float
    error: float
    low: float
    high: float
    at_bound: int


@dataclass(frozen=True)
class Uncertainty:
    """covariance: of the scaled parameters (p, p); correlation: (p, p).

    directions: of the shared parameters, loosest first: relative standard error along it and its parts by label.
    words: what the data can't distinguish. quantile: of Student's t for the 95 % interval.
    """

    estimates: tuple[Estimate, ...]
    covariance: Vector
    correlation: Vector
    directions: Directions
    words: tuple[str, ...]
    quantile: float


def uncertainty(problem: Problem, solution: Solution, covariance: Vector | None = None) -> Uncertainty:
    """Errors from the curvature at the solution and the scatter of the residuals, or from a covariance that is known.

    A parameter at its bound is treated like the others: if it counted as known, those correlated with it would seem
    well known, too.
    """
    if covariance is None:
        covariance = _covariance(problem, solution)
    deviation = np.sqrt(np.diag(covariance))
    known = np.isfinite(deviation)
    product = np.outer(deviation, deviation)
    correlation = np.divide(covariance, product, out=np.full_like(product, np.nan), where=np.outer(known, known))
    quantile = float(student.ppf(0.5 + 0.5 * CONFIDENCE_LEVEL, degrees_of_freedom(problem)))
    estimates = tuple(
        _estimate(p, float(s), float(d), quantile, int(b))
        for p, s, d, b in zip(problem.parameters, solution.scaled, deviation, solution.at_bound, strict=True)
    )
    directions = tuple(_directions(problem, solution, covariance))
    words = (
        *_bound_words(estimates, covariance),
        *_words(directions),
        *(f"{e.parameter.label} is not determined by these data" for e in estimates if _unmoved(e)),
        *_close_words(problem, deviation, correlation, directions),
    )
    return Uncertainty(estimates, covariance, correlation, directions, tuple(dict.fromkeys(words)), quantile)


def degrees_of_freedom(problem: Problem) -> int:
    """Measured values less parameters."""
    return max(len(problem.data()) - len(problem.parameters), 1)


def _covariance(problem: Problem, solution: Solution) -> Vector:
    """Of M-estimates: A^-1 B A^-1, A the sum of E psi' J^T J over the columns, B that of E psi^2 J^T J.

    J in units of the noise. Each column has means of its own: pooled, the residuals of one whose noise was given far
    too large, next to nothing in units of it, would take the scatter out of all others. With a linear loss and noise
    that was estimated it is (J^T J)^-1.
    """
    column = problem.column_of()
    sigma = solution.sigma[column]
    slope, pull = _slopes_and_pulls(problem, solution)
    rows = solution.jacobian * (np.sqrt(slope[column]) / sigma)[:, None]
    # Columns of unit length, so that what counts as nothing does not depend on units.
    length = np.linalg.norm(rows, axis=0)
    moved = np.flatnonzero(length > 0.0)
    covariance = np.diag(np.where(length > 0.0, 0.0, np.inf))  # of what moves nothing, nothing is known
    if len(moved):
        left, singular, right = np.linalg.svd(rows[:, moved] / length[moved], full_matrices=False)
        # Of rows = left S right, A is rows^T rows, and B the same with each row weighted by pull / slope.
        middle = left.T @ (left * (pull / slope)[column][:, None])
        outer = right.T / np.maximum(singular, LEAST_SINGULAR_VALUE * singular[0])
        inside = outer @ middle @ outer.T / np.outer(length[moved], length[moved])
        covariance[np.ix_(moved, moved)] = inside
    return covariance


def _slopes_and_pulls(problem: Problem, solution: Solution) -> tuple[Vector, Vector]:
    """E psi' and E psi^2 (columns,), the latter for as many degrees of freedom as the fit has left.

    Where residuals are smaller than a noise that was given, or than the errors of the computation, that noise counts.
    """
    column = problem.column_of()
    f = solution.residuals / solution.sigma[column]
    left = degrees_of_freedom(problem) / len(f)
    each = range(len(problem.columns))
    slope = np.array([np.mean(diagnostics.psi_slope(f[column == k], problem.loss)) for k in each])
    pull = np.array([np.mean(diagnostics.psi(f[column == k], problem.loss) ** 2) / left for k in each])
    given = np.array([one is not None for one in problem.noise.values()])
    believed = given | diagnostics.at_floor(problem, solution.sigma)
    return slope, np.where(believed, np.maximum(pull, slope**2), pull)


def _estimate(parameter: Parameter, scaled: float, deviation: float, quantile: float, bound: int) -> Estimate:
    value = parameter.value(scaled)
    reach = quantile * deviation
    if reach > LARGEST_HALF_WIDTH:
        low, high = (0.0 if parameter.log else -np.inf), np.inf
    else:
        low, high = (parameter.unbounded(scaled + sign * reach) for sign in (-1, 1))
    return Estimate(parameter, value, abs(parameter.slope(value)) * deviation, low, high, bound)


def _unmoved(one: Estimate) -> bool:
    """Whether the data do not determine a parameter of a single run, which is not in the directions."""
    return not one.parameter.shared and not np.isfinite(one.error)


def _directions(problem: Problem, solution: Solution, covariance: Vector) -> Iterator[Direction]:
    """Axes of the error ellipsoid of the shared parameters, relative to their values: longest first."""
    shared = [j for j, p in enumerate(problem.parameters) if p.shared]
    own = [j for j in shared if np.isfinite(covariance[j, j])]
    yield from ((np.inf, {problem.parameters[j].label: 1.0}) for j in shared if j not in own)
    relative = np.array([_relative(problem.parameters[j], float(solution.scaled[j])) for j in own])
    if not own:
        return
    values, vectors = np.linalg.eigh(covariance[np.ix_(own, own)] * np.outer(relative, relative))
    for k in np.argsort(values)[::-1]:
        vector = vectors[:, k] * np.sign(vectors[np.argmax(np.abs(vectors[:, k])), k])
        yield (
            float(np.sqrt(max(values[k], 0.0))),
            {problem.parameters[j].label: float(v) for j, v in zip(own, vector, strict=True)},
        )


def _relative(parameter: Parameter, scaled: float) -> float:
    """Relative change of the value by change of the scaled one; of a linear one near zero, by its range."""
    if parameter.log:
        return 1.0
    return parameter.unit / max(abs(parameter.value(scaled)), 1e-3 * parameter.unit)


def _bound_words(estimates: Sequence[Estimate], covariance: Vector) -> Iterator[str]:
    for j, one in enumerate(estimates):
        if not one.at_bound:
            continue
        side, bound = ("upper", one.parameter.high) if one.at_bound > 0 else ("lower", one.parameter.low)
        scaled = one.parameter.scaled(one.value)
        if _relative(one.parameter, scaled) * np.sqrt(covariance[j, j]) > LARGE_RELATIVE_ERROR:
            why = "the data hardly determine it"
        else:
            why = "the best value is beyond it: widen the bounds, or check the model"
        yield f"{one.parameter.label} is at its {side} bound, {bound:g}: {why}"


def _words(directions: Directions) -> Iterator[str]:
    """A sentence for each combination that the data do not determine."""
    for members in map(_members, directions):
        names = list(members)
        errors = [f"{100 * error:.0f} %" if error < 3.0 else "any size" for error in members.values()]
        if len(names) == 1:
            yield f"{names[0]} is not determined by these data: its error is {errors[0].replace('any', 'of any')}"
        elif names:
            yield (
                f"{_listed(names)}: only their combination is determined by these data, not each alone; errors of "
                f"{_listed(errors)} go together"
            )


def _members(direction: Direction) -> dict[str, float]:
    """Parameters that a direction makes uncertain by more than `LARGE_RELATIVE_ERROR`, and by how much (relative)."""
    size, parts = direction
    return {label: size * abs(part) for label, part in parts.items() if size * abs(part) > LARGE_RELATIVE_ERROR}


def _listed(words: Sequence[str]) -> str:
    return f"{', '.join(words[:-1])} and {words[-1]}"


def _close_words(problem: Problem, deviation: Vector, correlation: Vector, directions: Directions) -> Iterator[str]:
    """Pairs of well determined but highly correlated parameters; of single runs also those that are not determined."""
    named = [set(_members(direction)) for direction in directions]
    low, high = problem.bounds
    open_by = deviation / (high - low)
    for i, one in enumerate(problem.parameters):
        for j, other in enumerate(problem.parameters[:i]):
            close = np.isfinite(correlation[i, j]) and abs(correlation[i, j]) >= HIGH_CORRELATION
            if close and not one.shared and not other.shared and min(open_by[i], open_by[j]) > 1.0:
                yield (
                    f"{other.label} and {one.label} can't be distinguished by these data: any value of one goes with "
                    "one of the other; give one of them a number"
                )
            elif close and not any({one.label, other.label} <= names for names in named):
                yield f"{other.label} and {one.label} are hard to distinguish: correlation {correlation[i, j]:+.3f}"


def band(uncertainty: Uncertainty, derivatives: Vector) -> Vector:
    """Half width (values,) of the 95 % band of the model, from its derivatives (values, p) by scaled parameters."""
    covariance = np.where(np.isfinite(uncertainty.covariance), uncertainty.covariance, 0.0)  # it moves none of these
    variance = np.einsum("ij,jk,ik->i", derivatives, covariance, derivatives)
    return np.asarray(uncertainty.quantile * np.sqrt(np.maximum(variance, 0.0)))
