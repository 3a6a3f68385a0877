"""Where Newton's method begins in a step, and Anderson's acceleration of its iterations.

Both are in place on the engine's own arrays; see `multibody.predictor` for what they do and why. Their arrays are
found by their places (`lending`), in this order:

    q, v, a             (m,) coordinates, rates and accelerations, and the multipliers (k,) of constraints, which are
    multipliers         moved: with a change of a go of[0] times as much of q and of[1] times as much of v
    a_before            accelerations and multipliers at the start of the step
    multipliers_before
    lever               (m,) factors from rates to speeds
    kept                (3, m) of the iteration before, and (k,) multipliers
    kept_multipliers
    of                  (2,)
    led, led_constraints  (m, DEPTH) and (k, DEPTH): how far from each other two iterations led,
    bent                (m, DEPTH) by how much their changes (in speeds) differed,
    products            (DEPTH, DEPTH) of these with each other
    number              (4,) whole numbers, see below
    size                (1,) of the last change of this step, 0 where there was none
"""

from __future__ import annotations

import math

from numba import types

from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.lending import lender
from granular_contact.kernels.memory import clear, room1, room2

# Rows of `kept`: accelerations from which the iteration under way began, those that the one before led to, its change.
FROM, LED, CHANGE = 0, 1, 2
DEPTH = 6  # pairs of iterations that are kept
# Of `number`: pairs there are, column of the next one, Jacobians that were computed when the last one was kept, whether
# an iteration with the same Jacobian came before this one.
PAIRS, NEXT, JACOBIAN, FOLLOWS, NUMBERS = 0, 1, 2, 3, 4
SAME = 1e-6  # of a step, within which it is as long as another
FARTHEST = 3.0  # times the change of an iteration, at most, that the next one is led elsewhere
# Share of a change: pairs whose changes differ by less say nothing of it, and would be taken many times. Where motions
# agree to round-off and multipliers do not yet, multipliers then ran away.
SMALL = 0.1
DAMPED = 1e-3  # share by which the products of pairs with themselves are greater: what differs little is led on less
_row, _rows = (lender(types.Array(types.float64, axes, "C")) for axes in (1, 2))
_numbers = lender(types.Array(types.int64, 1, "C"))


@kernel
def begin(words, of_q, of_v, forget):
    """Begin a step with what the last one ended with; of_q, of_v: from now on in `of`; forget: all iterations."""
    q, v, a, multipliers, of = _row(words, 0), _row(words, 1), _row(words, 2), _row(words, 3), _row(words, 9)
    a_before, multipliers_before = _row(words, 4), _row(words, 5)
    kept, number, size = _rows(words, 7), _numbers(words, 14), _row(words, 15)
    if forget or abs(of_v - of[1]) > SAME * of_v:
        number[PAIRS], number[NEXT] = 0, 0
    of[0], of[1] = of_q, of_v
    number[FOLLOWS], size[0] = 0, 0.0
    for i in range(a.shape[0]):
        further = a_before[i]
        q[i] += of_q * further
        v[i] += of_v * further
        a[i] += further
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        multipliers[i] = multipliers_before[i]


@part
def keep_pair(words, column):
    """Keep what differs between this iteration and the one before, and its products with the other pairs."""
    a, multipliers, lever = _row(words, 2), _row(words, 3), _row(words, 6)
    kept, kept_multipliers = _rows(words, 7), _row(words, 8)
    led, led_constraints, bent, products = _rows(words, 10), _rows(words, 11), _rows(words, 12), _rows(words, 13)
    sums = room1(DEPTH)
    clear(sums)
    for i in range(a.shape[0]):
        led[i, column] = a[i] - kept[LED, i]
        bent[i, column] = difference = lever[i] * (a[i] - kept[FROM, i]) - kept[CHANGE, i]
        for k in range(DEPTH):
            sums[k] += difference * bent[i, k]
    for i in range(multipliers.shape[0]):
        led_constraints[i, column] = multipliers[i] - kept_multipliers[i]
    for k in range(DEPTH):
        products[column, k] = products[k, column] = sums[k]


@part
def shares(words, pairs, change, share):
    """Fill share (DEPTH,) with how much of each pair makes the change least; by elimination, of scaled products.

    change: its size (m/s2).
    """
    bent, products, kept = _rows(words, 12), _rows(words, 13), _rows(words, 7)
    A, scale = room2(DEPTH, DEPTH), room1(DEPTH)
    clear(share)
    for i in range(kept.shape[1]):
        for k in range(DEPTH):
            share[k] += bent[i, k] * kept[CHANGE, i]
    for k in range(pairs):
        scale[k] = 1.0 / math.sqrt(products[k, k]) if products[k, k] > (SMALL * change) ** 2 else 0.0
    for k in range(pairs):
        share[k] *= scale[k]
        for j in range(pairs):
            A[k, j] = scale[k] * scale[j] * products[k, j]
        A[k, k] = 1.0 + DAMPED
    for k in range(pairs):
        for j in range(k + 1, pairs):
            factor = A[j, k] / A[k, k]
            for i in range(k, pairs):
                A[j, i] -= factor * A[k, i]
            share[j] -= factor * share[k]
    for back in range(pairs):
        k = pairs - 1 - back
        for j in range(k + 1, pairs):
            share[k] -= A[k, j] * share[j]
        share[k] /= A[k, k]
    for k in range(DEPTH):
        share[k] = scale[k] * share[k] if k < pairs else 0.0


@part
def move(words, share, change):
    """Move away from where the iteration led by these shares of the pairs; change: size of its own change (m/s2)."""
    q, v, a, multipliers, of = _row(words, 0), _row(words, 1), _row(words, 2), _row(words, 3), _row(words, 9)
    lever, kept, led, led_constraints = _row(words, 6), _rows(words, 7), _rows(words, 10), _rows(words, 11)
    square = 0.0
    for i in range(a.shape[0]):
        further = 0.0
        for k in range(DEPTH):
            further -= share[k] * led[i, k]
        kept[FROM, i] = further
        square += (lever[i] * further) ** 2
    most = FARTHEST * change
    least = most / math.sqrt(square) if square > most * most else 1.0
    for i in range(a.shape[0]):
        further = least * kept[FROM, i]
        q[i] += of[0] * further
        v[i] += of[1] * further
        a[i] += further
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        further = 0.0
        for k in range(DEPTH):
            further -= share[k] * led_constraints[i, k]
        multipliers[i] += least * further


@kernel
def go_on(words, jacobians, gain, leads):
    """Move to where the next iteration starts; whether the last change is more than `gain` times the one before.

    jacobians: how many were computed so far; leads: False to begin only with what is kept.
    """
    a, multipliers, lever = _row(words, 2), _row(words, 3), _row(words, 6)
    kept, kept_multipliers, number, size = _rows(words, 7), _row(words, 8), _numbers(words, 14), _row(words, 15)
    if jacobians != number[JACOBIAN]:
        number[JACOBIAN], number[PAIRS], number[NEXT], number[FOLLOWS] = jacobians, 0, 0, 0
    if not leads:
        for i in range(a.shape[0]):
            kept[FROM, i] = a[i]
        return False
    if number[FOLLOWS]:
        keep_pair(words, number[NEXT])
        number[NEXT] = (number[NEXT] + 1) % DEPTH
        number[PAIRS] = min(number[PAIRS] + 1, DEPTH)
    number[FOLLOWS] = 1
    square = 0.0
    for i in range(a.shape[0]):
        kept[CHANGE, i] = lever[i] * (a[i] - kept[FROM, i])
        kept[LED, i] = kept[FROM, i] = a[i]
        square += kept[CHANGE, i] ** 2
    for i in range(multipliers.shape[0]):
        kept_multipliers[i] = multipliers[i]
    change = math.sqrt(square)
    slow = 0.0 < gain * size[0] < change
    size[0] = change
    if number[PAIRS] > 0:
        share = room1(DEPTH)
        shares(words, number[PAIRS], change, share)
        move(words, share, change)
    return slow
