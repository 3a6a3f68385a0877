"""Noise of data, estimated from the data themselves or robustly from the residuals of a model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from granular_contact.studies.fit.problem import Loss, Problem

Vector = NDArray[np.float64]

# Residuals beyond so many times the noise pull no stronger than that. Of pure noise 2 % of the information is lost.
LOSS_SCALE = 2.0
# E psi^2 of a standard normal residual; psi = f / sqrt(1 + (f / LOSS_SCALE)^2), the slope of soft_l1 with that f_scale.
_EXPECTED = 0.6290461656955636
RELATIVE_FLOOR = 1e-5  # of the range of the data: what interpolation and integration leave uncertain
WHOLE_NUMBER_TOLERANCE = 1e-3  # how far from whole numbers multiples of a step may be
_MAD = 1.4826  # standard deviation over median absolute value, of a normal distribution


def psi(f: Vector, loss: Loss) -> Vector:
    """Influence function of residuals f (in units of the noise)."""
    return f if loss == "linear" else f / np.sqrt(1.0 + (f / LOSS_SCALE) ** 2)


def psi_slope(f: Vector, loss: Loss) -> Vector:
    """Derivative of `psi`."""
    return np.ones_like(f) if loss == "linear" else (1.0 + (f / LOSS_SCALE) ** 2) ** -1.5


def scale(residuals: Vector, loss: Loss, share: float) -> float:
    """Standard deviation of residuals (n,), of whose n degrees of freedom the fit took the given share.

    For soft_l1 the scale at which the mean square influence is that of normal residuals (Huber's second proposal).
    """
    rms = float(np.sqrt(np.mean(residuals**2) / (1.0 - share)))
    if loss == "linear" or rms == 0.0:
        return rms
    sigma = max(_MAD * float(np.median(np.abs(residuals))), 1e-3 * rms)
    for _ in range(100):
        new = sigma * float(np.sqrt(np.mean(psi(residuals / sigma, loss) ** 2) / (_EXPECTED * (1.0 - share))))
        if abs(new - sigma) < 1e-6 * sigma:
            break
        sigma = new
    return new


def roughness(values: Vector) -> float | None:
    """Standard deviation of what changes from row to row, of values (n,) at even times: from third differences.

    A smooth motion adds little to it, so it is the noise or a little more; at least that of rounding, which may leave
    most rows alike. None for too few rows.
    """
    if len(values) < 10:
        return None
    third = np.diff(values, 3)  # of noise of variance s^2 it has 20 s^2
    return max(float(_MAD * np.median(np.abs(third)) / np.sqrt(20.0)), rounding(values) / float(np.sqrt(12.0)))


def rounding(values: Vector) -> float:
    """Step that values (n,) are rounded to; 0 where the smallest one between them is not that of all."""
    levels = np.unique(values)
    steps = np.diff(levels)
    steps = steps[steps > 1e-9 * np.ptp(values)]  # less is the arithmetic of who wrote them
    if len(steps) < 2:
        return 0.0
    step = float(np.min(steps))
    multiples = (levels - levels[0]) / step
    return step if float(np.max(np.abs(multiples - np.round(multiples)))) < WHOLE_NUMBER_TOLERANCE else 0.0


def roughness_of(problem: Problem, column: str) -> float | None:
    """The same of all runs together; None where no run has enough rows."""
    found = [(roughness(one), len(one)) for one in problem.by_column()[column]]
    known = np.array([(size**2, rows) for size, rows in found if size is not None])
    return float(np.sqrt(np.average(known[:, 0], weights=known[:, 1]))) if len(known) else None


def floors(problem: Problem) -> Vector:
    """Noise (columns,) below which the errors of the computation dominate."""
    ranges = [float(np.ptp(np.concatenate(series))) for series in problem.by_column().values()]
    return np.maximum(RELATIVE_FLOOR * np.array(ranges), 1e-12)


def at_floor(problem: Problem, sigma: Vector) -> NDArray[np.bool_]:
    """Whether a noise (columns,) is no more than the errors of the computation."""
    return np.asarray(sigma <= floors(problem) * (1.0 + 1e-9))
