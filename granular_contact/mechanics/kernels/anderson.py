"""Start of Newton's method in a step, and Anderson acceleration of its iterations (type II, depth `DEPTH`).

Start: accelerations and multipliers of the last step, in place of the zero of Arnold and Bruels (2007). Zero costs an
iteration more, and several where bristles are.

Acceleration (Anderson 1965; Walker and Ni 2011): an iteration of modified Newton leads from x to x + g(x). With the
differences G and E of g and of x + g between the last iterations, the next one starts from

    x + g - E c,    where c makes |g - G c|^2 + r |diag(G) c|^2 least,

by the normal equations of columns of unit length; r: `REGULARISATION`. Speeds (rates times levers) are what is
compared. Pairs serve over steps as well, for as long as the Jacobian and the step stay the same.

Cost: DEPTH + 2 products of vectors an iteration. Limits: g must be nearly linear over the last iterations; where a
bristle yields it is not, and the next Jacobian drops all pairs. Arrays: `iterations`.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, room1, room2
from granular_contact.mechanics.kernels.iterations import (
    CHANGE,
    FOLLOWS,
    FROM,
    ITERATIONS,
    JACOBIAN,
    LED,
    NEXT,
    PAIRS,
    SIZE,
)
from granular_contact.mechanics.kernels.numerics import CONTRACTION, DEPTH, LEAST_DIFFERENCE, REGULARISATION

view = ITERATIONS.view
_SAME_STEP = 1e-6  # of a step: round-off of its length


@kernel
def begin(addresses, of_q, of_v):
    """Begin a step with the accelerations and multipliers of the last one; of_q, of_v: from now on in `of`."""
    w = view(addresses)
    q, v, a, multipliers, of = w.q, w.v, w.a, w.multipliers, w.of
    a_before, multipliers_before = w.a_before, w.multipliers_before
    kept, kept_multipliers, number = w.kept, w.kept_multipliers, w.number
    if abs(of_v - of[1]) > _SAME_STEP * of_v:
        number[PAIRS], number[NEXT] = 0, 0
    of[0], of[1], of[SIZE] = of_q, of_v, math.inf
    number[FOLLOWS] = 0
    for i in range(a.shape[0]):
        q[i] += of_q * a_before[i]
        v[i] += of_v * a_before[i]
        a[i] += a_before[i]
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        multipliers[i] = kept_multipliers[FROM, i] = multipliers_before[i]


@part
def keep_pair(w, column):
    """Keep what differs between this iteration and the one before, and its products with the other pairs."""
    a, multipliers, lever = w.a, w.multipliers, w.lever
    kept, kept_multipliers = w.kept, w.kept_multipliers
    led, led_constraints, bent, products = w.led, w.led_constraints, w.bent, w.products
    sums = room1(DEPTH)
    clear(sums)
    for i in range(a.shape[0]):
        led[i, column] = a[i] - kept[LED, i]
        bent[i, column] = difference = lever[i] * (a[i] - kept[FROM, i]) - kept[CHANGE, i]
        for k in range(DEPTH):
            sums[k] += difference * bent[i, k]
    for i in range(multipliers.shape[0]):
        led_constraints[i, column] = multipliers[i] - kept_multipliers[LED, i]
    for k in range(DEPTH):
        products[column, k] = products[k, column] = sums[k]


@part
def coefficients(w, pairs, change, c):
    """Fill c (DEPTH,) with the least-squares coefficients, by elimination; change: size of g (m/s2)."""
    bent, products, kept = w.bent, w.products, w.kept
    M, scale = room2(DEPTH, DEPTH), room1(DEPTH)
    clear(c)
    for i in range(kept.shape[1]):
        for k in range(DEPTH):
            c[k] += bent[i, k] * kept[CHANGE, i]
    for k in range(pairs):
        counts = products[k, k] > (LEAST_DIFFERENCE * change) ** 2
        scale[k] = 1.0 / math.sqrt(products[k, k]) if counts else 0.0
    for k in range(pairs):
        c[k] *= scale[k]
        for j in range(pairs):
            M[k, j] = scale[k] * scale[j] * products[k, j]
        M[k, k] = 1.0 + REGULARISATION
    for k in range(pairs):
        for j in range(k + 1, pairs):
            factor = M[j, k] / M[k, k]
            for i in range(k, pairs):
                M[j, i] -= factor * M[k, i]
            c[j] -= factor * c[k]
    for back in range(pairs):
        k = pairs - 1 - back
        for j in range(k + 1, pairs):
            c[k] -= M[k, j] * c[j]
        c[k] /= M[k, k]
    for k in range(DEPTH):
        c[k] = scale[k] * c[k] if k < pairs else 0.0


@part
def extrapolate(w, c):
    """Move by -E c from where the iteration led."""
    q, v, a, multipliers, of = w.q, w.v, w.a, w.multipliers, w.of
    led, led_constraints = w.led, w.led_constraints
    for i in range(a.shape[0]):
        further = 0.0
        for k in range(DEPTH):
            further -= c[k] * led[i, k]
        q[i] += of[0] * further
        v[i] += of[1] * further
        a[i] += further
    for i in range(multipliers.shape[0]):
        for k in range(DEPTH):
            multipliers[i] -= c[k] * led_constraints[i, k]


@part
def last_change(w):
    """Size (m/s2) of the change of the iteration, and whether it goes back on the one before.

    Its parts come into row CHANGE of `kept`, in place of those of the one before.
    """
    a, lever, kept = w.a, w.lever, w.kept
    square, along = 0.0, 0.0
    for i in range(a.shape[0]):
        change = lever[i] * (a[i] - kept[FROM, i])
        square, along = square + change * change, along + change * kept[CHANGE, i]
        kept[CHANGE, i] = change
    return math.sqrt(square), along < 0.0


@part
def keep_as(w, to):
    """Keep the present accelerations and multipliers as those of a row."""
    a, multipliers = w.a, w.multipliers
    kept, kept_multipliers = w.kept, w.kept_multipliers
    for i in range(a.shape[0]):
        kept[to, i] = a[i]
    for i in range(multipliers.shape[0]):
        kept_multipliers[to, i] = multipliers[i]


@kernel
def accelerate(addresses, jacobians):
    """Move to where the next iteration starts; whether the last one contracted too little, for a new Jacobian.

    Not of one that goes back: the one before has passed the solution, as resistance grew on the way to it. Its Jacobian
    had the direction, and of how far to go the two know more than a new one. jacobians: how many were computed so far.
    """
    w = view(addresses)
    number, of = w.number, w.of
    if jacobians != number[JACOBIAN]:
        number[JACOBIAN], number[PAIRS], number[NEXT], number[FOLLOWS] = jacobians, 0, 0, 0
        of[SIZE] = math.inf
    if number[FOLLOWS]:
        keep_pair(w, number[NEXT])
        number[NEXT] = (number[NEXT] + 1) % DEPTH
        number[PAIRS] = min(number[PAIRS] + 1, DEPTH)
    change, goes_back = last_change(w)
    slow = change > CONTRACTION * of[SIZE] and not goes_back
    keep_as(w, LED)
    number[FOLLOWS] = 1
    of[SIZE] = change
    if number[PAIRS] > 0:
        c = room1(DEPTH)
        coefficients(w, number[PAIRS], change, c)
        extrapolate(w, c)
    keep_as(w, FROM)
    return slow
