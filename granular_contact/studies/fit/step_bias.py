"""Bias of the parameters of a fit that the steps of its runs cause.

Curves of runs with finer steps differ by e from the curves of the fit. One Gauss-Newton step estimates how far the best
parameters would move with finer steps, in scaled parameters,

    delta = -(J^T W J)^-1 J^T W e,

with the Jacobian J at the solution and the weights W = 1 / sigma^2 of the residuals. The finer runs have a tenth of
`solver.accuracy`, for which strips and facets are chosen as well, or of a fixed step. Cost: one finer run for
each measured run. Limits: errors of the curves from other causes than the steps are not detected; reduced models, whose
own tolerance is far below any noise, and force tests by the law alone count as exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from granular_contact.studies.fit.problem import MeasuredRun, Problem
from granular_contact.studies.fit.responses import ModelFailed
from granular_contact.studies.fit.solve import Solution
from granular_contact.studies.fit.uncertainty import LEAST_SINGULAR_VALUE, Estimate
from granular_contact.values.arrays import Vector

FINER = 0.1  # step or accuracy of the finer runs, relative to that of the fit
LEAST_BIAS = 1e-3  # relative to the parameter: a smaller bias gives no warning


def step_bias(problem: Problem, solution: Solution) -> Vector:
    """Return the change (p,) of the parameters, in their own units, with finer steps.

    NaN where a finer run fails.
    """
    parameters = problem.values(solution.scaled)
    try:
        departure = np.concatenate(
            [_departure(run, parameters, time) for run, time in zip(problem.runs, problem.times(), strict=True)]
        )
    except ModelFailed:
        return np.full(len(parameters), np.nan)
    if not departure.any():
        return np.zeros(len(parameters))
    weights = 1.0 / solution.sigma[problem.column_indices()]
    weighted = solution.jacobian * weights[:, None]
    delta = np.linalg.lstsq(weighted, -departure * weights, rcond=LEAST_SINGULAR_VALUE)[0]
    return problem.values(solution.scaled + delta) - parameters


def step_bias_warnings(estimates: Sequence[Estimate], bias: Vector) -> Iterator[str]:
    """Sentences on parameters whose bias exceeds their standard error."""
    for estimate, change in zip(estimates, bias.tolist(), strict=True):
        if abs(change) > max(estimate.error, LEAST_BIAS * abs(estimate.value)):
            moved = f"{estimate.parameter.label} would be {estimate.value + change:.4g} with finer steps"
            error = f"{abs(change) / estimate.error:.2g} standard errors away" if estimate.error > 0.0 else "not this"
            yield f"{moved}, {error}: take a smaller solver.accuracy or solver.step_s"


def _departure(run: MeasuredRun, parameters: Vector, time: Vector) -> Vector:
    """Change (n * columns,) of the curves of a run with finer steps, at times (n,) s of the measurement."""
    finer = run.simulator.refined([float(parameters[i]) for i in run.acting], FINER)
    if finer is None:
        return np.zeros(len(time) * len(run.measured.columns))
    change: Vector = replace(run, simulator=finer).at(parameters, time) - run.at(parameters, time)
    return change.ravel()
