"""Derivatives of the model by its parameters, by central differences in the scaled parameters.

A reduced run with the default rtol of 1e-6 is off by 2e-8 m, and rough by less. A step of 0.3 % is long against that
and short against the curvature of the curves: derivatives are right to 1e-5 for a rigid link. For one that bends the
steps that the integrator chooses differ between neighbouring runs: over six impacts errors were 0.03 to 0.2 % by the
median, and 1.2 % at the worst, 1.6 % with another integrator (measured against rtol 1e-10, tests/fit/test_jacobian.py).
Standard errors inherit that.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from granular_contact.studies.fit.problem import Parameter, Problem

Vector = NDArray[np.float64]

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
