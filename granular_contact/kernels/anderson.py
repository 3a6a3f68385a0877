"""Anderson's acceleration of depth one for the iterations of Newton's method, in place on the engine's own arrays.

See `multibody.predictor` for what it does and why.
"""

from __future__ import annotations

from granular_contact.kernels.compiled import kernel

# Rows of `kept`: accelerations from which the iteration under way began, those that the one before led to, its change.
FROM, LED, CHANGE = 0, 1, 2
FIRST = 2  # iteration from which on changes are kept: the first one is that of the prediction


@kernel
def begin(q, v, a, multipliers, a_before, multipliers_before, of_q, of_v):
    """Begin a step with the accelerations a_before (m,) and multipliers (k,) of the last one; the others as below."""
    for i in range(a.shape[0]):
        q[i] += of_q * a_before[i]
        v[i] += of_v * a_before[i]
        a[i] += a_before[i]
    for i in range(multipliers.shape[0]):
        multipliers[i] = multipliers_before[i]


@kernel
def go_on(q, v, a, multipliers, lever, kept, kept_multipliers, of_q, of_v, iteration):
    """Move to where the next iteration starts.

    q, v, a (m,): coordinates, rates and accelerations to which the last iteration led, all of which are moved; with a
    change of a go `of_q` times as much of q and `of_v` times as much of v. multipliers (k,), moved too. lever (m,):
    factors from rates to speeds. kept (3, m), kept_multipliers (k,): of the iterations before; iteration: 1 after the
    first one of a step.
    """
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
            q[i] += of_q * further
            v[i] += of_v * further
            a[i] += further
            kept[FROM, i] = led + further
    for i in range(multipliers.shape[0]):
        led = multipliers[i]
        if back != 0.0:
            multipliers[i] += back * (led - kept_multipliers[i])
        kept_multipliers[i] = led
