"""Where Newton's method begins in a step, and Anderson's acceleration of depth one for its iterations.

Both are in place on the engine's own arrays; see `multibody.predictor` for what they do and why. Their arrays are
found by their places (`lending`), in this order:

    q, v, a             (m,) coordinates, rates and accelerations, and the multipliers (k,) of constraints, which are
    multipliers         moved: with a change of a go of[0] times as much of q and of[1] times as much of v
    a_before            accelerations and multipliers at the start of the step
    multipliers_before
    lever               (m,) factors from rates to speeds
    kept                (3, m) of the iterations before, and (k,) multipliers
    kept_multipliers
    of                  (2,)
"""

from __future__ import annotations

from numba import types

from granular_contact.kernels.compiled import kernel
from granular_contact.kernels.lending import lender

# Rows of `kept`: accelerations from which the iteration under way began, those that the one before led to, its change.
FROM, LED, CHANGE = 0, 1, 2
FIRST = 2  # iteration from which on changes are kept: the first one is that of the prediction
_row, _rows = (lender(types.Array(types.float64, axes, "C")) for axes in (1, 2))


@kernel
def begin(words, of_q, of_v):
    """Begin a step with what the last one ended with; of_q, of_v: from now on in `of`."""
    q, v, a, multipliers, of = _row(words, 0), _row(words, 1), _row(words, 2), _row(words, 3), _row(words, 9)
    a_before, multipliers_before = _row(words, 4), _row(words, 5)
    of[0], of[1] = of_q, of_v
    for i in range(a.shape[0]):
        further = a_before[i]
        q[i] += of_q * further
        v[i] += of_v * further
        a[i] += further
    for i in range(multipliers.shape[0]):
        multipliers[i] = multipliers_before[i]


@kernel
def go_on(words, iteration):
    """Move to where the next iteration starts; iteration: 1 after the first one of a step."""
    q, v, a, multipliers, of = _row(words, 0), _row(words, 1), _row(words, 2), _row(words, 3), _row(words, 9)
    lever, kept, kept_multipliers = _row(words, 6), _rows(words, 7), _row(words, 8)
    square, product = 0.0, 0.0
    for i in range(a.shape[0]):
        led, change = a[i], lever[i] * (a[i] - kept[FROM, i])
        bend = change - kept[CHANGE, i]
        square += bend * bend
        product += bend * change
        kept[FROM, i], kept[CHANGE, i] = led, change
    back = 0.0
    if iteration > FIRST and square > 0.0:
        back = -min(1.0, max(-1.0, product / square))
    for i in range(a.shape[0]):
        led, further = a[i], back * (a[i] - kept[LED, i])
        kept[LED, i] = led
        if back != 0.0:
            q[i] += of[0] * further
            v[i] += of[1] * further
            a[i] += further
            kept[FROM, i] = led + further
    for i in range(multipliers.shape[0]):
        led = multipliers[i]
        if back != 0.0:
            multipliers[i] += back * (led - kept_multipliers[i])
        kept_multipliers[i] = led
