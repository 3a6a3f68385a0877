"""One step of the Runge-Kutta-Chebyshev method of order 2, with as many stages as stiffness asks for.

For a system whose stiffness is damping: the eigenvalues that limit explicit steps lie along the negative real axis,
and s stages reach 2/3 (s^2 - 1) along it. So the cost of a step grows with the root of its stiffness, and no matrix is
needed. A bristle that sticks is such stiffness: with its damping time tau its fast root is that of the dashpot.

Coefficients, estimate of the error and choice of stages: Sommeijer, Shampine & Verwer (1998).
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels.compiled import part
from granular_contact.kernels.memory import copy
from granular_contact.kernels.tree_load import rates

DAMPING = 2.0 / 13.0
MOST_STAGES = 200


@part
def stages_for(h, radius):
    """Stages that keep a step h (s) stable where the spectral radius is so large (1/s)."""
    return min(MOST_STAGES, max(2, 1 + int(math.sqrt(1.0 + 1.54 * h * radius))))


@part
def step(t, y, h, stages, w, slope, before, last, end):
    """Fill `end` with the state after h (s), from y at t (s) with y' = slope; before, last: room for two states."""
    w0 = 1.0 + DAMPING / (stages * stages)
    root = math.sqrt(w0 * w0 - 1.0)
    argument = stages * math.log(w0 + root)
    w1 = math.sinh(argument) * (w0 * w0 - 1.0) / (math.cosh(argument) * stages * root - w0 * math.sinh(argument))
    b_last = b_before = 1.0 / (2.0 * w0) ** 2
    copy(before, y)
    for i in range(y.shape[0]):
        last[i] = y[i] + (w1 * b_last * h) * slope[i]
    share = w1 * b_last  # of the step, where `last` stands
    # Chebyshev polynomials T at w0 with their first and second derivatives, of the last two degrees.
    t2, t1, d2, d1, dd2, dd1 = 1.0, w0, 0.0, 1.0, 0.0, 0.0
    for _ in range(2, stages + 1):
        polynomial = 2.0 * w0 * t1 - t2
        d = 2.0 * w0 * d1 - d2 + 2.0 * t1
        dd = 2.0 * w0 * dd1 - dd2 + 4.0 * d1
        b = dd / (d * d)
        a = 1.0 - t1 * b_last
        mu = 2.0 * w0 * b / b_last
        nu = -b / b_before
        weight = mu * w1 / w0
        rates(t + share * h, last, w, end)
        for i in range(y.shape[0]):
            new = (1.0 - mu - nu) * y[i] + mu * last[i] + nu * before[i] + h * weight * (end[i] - a * slope[i])
            before[i], last[i] = last[i], new
        share = w1 * dd / d
        t2, t1, d2, d1, dd2, dd1 = t1, polynomial, d1, d, dd1, dd
        b_before, b_last = b_last, b
    copy(end, last)


@part
def radius(t, y, slope, w, direction, moved, response):
    """Spectral radius (1/s) of the rates about y at t (s) by a nonlinear power method; direction is kept for later.

    Returns it with a margin, and the evaluations it took.
    """
    size = y.shape[0] - 2  # works drive nothing
    norm = 0.0
    for i in range(size):
        norm += direction[i] * direction[i]
    if norm == 0.0:
        copy(direction, slope)
        for i in range(size):
            norm += slope[i] * slope[i]
    scale = 1e-8 * (1.0 + np.sqrt(np.dot(y[:size], y[:size])))
    found = 0.0
    for count in range(1, 21):
        if norm == 0.0:
            return 0.0, count
        factor = scale / math.sqrt(norm)
        copy(moved, y)
        for i in range(size):
            moved[i] += factor * direction[i]
        rates(t, moved, w, response)
        norm = 0.0
        for i in range(size):
            direction[i] = response[i] - slope[i]
            norm += direction[i] * direction[i]
        before, found = found, math.sqrt(norm) / scale
        if count > 1 and abs(found - before) <= 0.05 * found:
            break
    return 1.2 * found, count
