"""One step of the Dormand-Prince pair of order 5(4) for the modal pendulum, with its interpolant.

Coefficients: Dormand & Prince (1980); interpolant of order 4: Shampine (1986).
"""

from __future__ import annotations

import numpy as np

from granular_contact.kernels.compiled import part
from granular_contact.kernels.modal_calls import rates

STAGES = 7
A = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
ERROR = np.array([-71 / 57600, 0, 71 / 16695, -71 / 1920, 17253 / 339200, -22 / 525, 1 / 40])
DENSE = np.array(
    [
        [1, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432],
        [0, 0, 0, 0],
        [0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799],
        [0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072],
        [0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632],
        [0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844],
        [0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423],
    ]
)


@part
def step(y, h, s, w, k, sigma, totals, end):
    """From y, with k[0] = y' there, fill the slopes k (7, size) and the state `end` after h (s)."""
    for stage in range(1, STAGES):
        for i in range(y.shape[0]):
            slope = 0.0
            for j in range(stage):
                slope += A[stage, j] * k[j, i]
            end[i] = y[i] + h * slope
        rates(end, s, w, sigma, totals, k[stage])


@part
def error(h, k, allowed):
    """Largest estimated error of a step over what is `allowed` (coordinates and rates,) for it."""
    worst = 0.0
    for i in range(allowed.shape[0]):
        estimate = 0.0
        for stage in range(STAGES):
            estimate += ERROR[stage] * k[stage, i]
        ratio = abs(h * estimate) / allowed[i]
        if not ratio <= worst:  # a NaN gets through, too
            worst = ratio
    return worst


@part
def interpolant(y, h, k, C):
    """Fill C (5, size) with the coefficients of the step as a polynomial in theta = (t - t_0) / h."""
    for i in range(y.shape[0]):
        C[0, i] = y[i]
        for power in range(4):
            slope = 0.0
            for stage in range(STAGES):
                slope += DENSE[stage, power] * k[stage, i]
            C[power + 1, i] = h * slope


@part
def inside(C, theta, y):
    """Fill y with the state at theta in [0, 1] of a step; C (any number, size)."""
    for i in range(y.shape[0]):
        y[i] = 0.0
        for power in range(C.shape[0] - 1, -1, -1):
            y[i] = theta * y[i] + C[power, i]
