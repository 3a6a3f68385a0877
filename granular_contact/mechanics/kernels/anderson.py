"""Where Newton's method begins in a step, and Anderson's acceleration of its iterations.

Both are in place on the engine's own arrays, see `iterations`; see `engines.exudyn.predictor` for what they do and why.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, room1, room2
from granular_contact.mechanics.kernels.iterations import (
    A_BEFORE,
    BENT,
    CHANGE,
    COUNT,
    DEPTH,
    FEWEST,
    FIXED,
    FOLLOWS,
    FROM,
    FURTHER,
    JACOBIAN,
    KEPT,
    KEPT_MULTIPLIERS,
    LED,
    LED_APART,
    LED_CONSTRAINTS,
    LEVER,
    MORE,
    MULTIPLIERS,
    MULTIPLIERS_BEFORE,
    NEXT,
    NOWHERE,
    NUMBER,
    OF,
    ON_LINE,
    PAIRS,
    PRODUCTS,
    SEEKS,
    SINCE,
    SQUARE,
    STAGE,
    V_BEFORE,
    A,
    Q,
    V,
    numbers,
    row,
    rows,
)
from granular_contact.mechanics.kernels.line_search import BEYOND, along, draw, found, go_to, turn_back

SAME = 1e-6  # of a step, within which it is as long as another
FARTHEST = 3.0  # times the change of an iteration, at most, that the next one is led elsewhere
# Share of a change: pairs whose changes differ by less say nothing of it, and would be taken many times. Where motions
# agree to round-off and multipliers do not yet, multipliers then ran away.
SMALL = 0.1
DAMPED = 1e-3  # share by which the products of pairs with themselves are greater: what differs little is led on less
# Iterations that a Jacobian costs: once there were so many more than the fewest of a step with it, it is renewed. An
# old one is then in use for about as long as if what it will cost had been known.
WORTH = 5
MANY = 1 << 20  # iterations: more than any step has


@kernel
def begin(words, of_q, of_v, forget, jacobians, fixed, held):
    """Begin a step with what the last one ended with; whether it is to be with a new Jacobian.

    of_q, of_v: from now on in `of`; forget: all iterations; jacobians: how many were computed so far; fixed: whether
    steps are. Where they are, rates that would change their sign begin with zero: what sand stops it does not throw
    back. held (m/s): speed up to which bristles may hold, 0 where there are none; what was no faster, and would become
    so, begins with the rate that it had: the acceleration of the step that brought it to a stop is over.
    """
    q, v, a, multipliers, of = row(words, Q), row(words, V), row(words, A), row(words, MULTIPLIERS), row(words, OF)
    v_before, a_before, multipliers_before = row(words, V_BEFORE), row(words, A_BEFORE), row(words, MULTIPLIERS_BEFORE)
    lever = row(words, LEVER)
    kept, kept_multipliers, number = rows(words, KEPT), rows(words, KEPT_MULTIPLIERS), numbers(words, NUMBER)
    if forget or abs(of_v - of[1]) > SAME * of_v:
        number[PAIRS], number[NEXT] = 0, 0
    of[0], of[1] = of_q, of_v
    number[FOLLOWS], number[STAGE], number[FIXED] = 0, NOWHERE, fixed
    for i in range(a.shape[0]):
        further = a_before[i]
        if fixed and (v[i] + of_v * further) * v_before[i] < 0.0:
            further = -v[i] / of_v
        if lever[i] * abs(v_before[i]) < held and abs(v[i] + of_v * further) > abs(v_before[i]):
            further = (v_before[i] - v[i]) / of_v
        q[i] += of_q * further
        v[i] += of_v * further
        a[i] += further
        kept[FROM, i] = a[i]
    for i in range(multipliers.shape[0]):
        multipliers[i] = kept_multipliers[FROM, i] = multipliers_before[i]
    return worn(number, jacobians) and fixed


@part
def worn(number, jacobians):
    """Whether the Jacobian has cost as many iterations as a new one."""
    if number[SINCE] != jacobians:
        number[SINCE], number[FEWEST], number[MORE] = jacobians, MANY, 0
    else:
        count = max(1, number[COUNT])
        number[FEWEST] = min(number[FEWEST], count)
        number[MORE] += count - number[FEWEST]
    number[COUNT] = 0
    return number[MORE] > WORTH


@part
def keep_pair(words, column):
    """Keep what differs between this iteration and the one before, and its products with the other pairs."""
    a, multipliers, lever = row(words, A), row(words, MULTIPLIERS), row(words, LEVER)
    kept, kept_multipliers = rows(words, KEPT), rows(words, KEPT_MULTIPLIERS)
    led, led_constraints, bent, products = (
        rows(words, LED_APART),
        rows(words, LED_CONSTRAINTS),
        rows(words, BENT),
        rows(words, PRODUCTS),
    )
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
def shares(words, pairs, change, share):
    """Fill share (DEPTH,) with how much of each pair makes the change least; by elimination, of scaled products.

    change: its size (m/s2).
    """
    bent, products, kept = rows(words, BENT), rows(words, PRODUCTS), rows(words, KEPT)
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
    q, v, a, multipliers, of = row(words, Q), row(words, V), row(words, A), row(words, MULTIPLIERS), row(words, OF)
    lever, kept, led, led_constraints = (
        row(words, LEVER),
        rows(words, KEPT),
        rows(words, LED_APART),
        rows(words, LED_CONSTRAINTS),
    )
    square = 0.0
    for i in range(a.shape[0]):
        further = 0.0
        for k in range(DEPTH):
            further -= share[k] * led[i, k]
        kept[FURTHER, i] = further
        square += (lever[i] * further) ** 2
    most = FARTHEST * change
    least = most / math.sqrt(square) if square > most * most else 1.0
    for i in range(a.shape[0]):
        further = least * kept[FURTHER, i]
        q[i] += of[0] * further
        v[i] += of[1] * further
        a[i] += further
    for i in range(multipliers.shape[0]):
        further = 0.0
        for k in range(DEPTH):
            further -= share[k] * led_constraints[i, k]
        multipliers[i] += least * further


@part
def measure(words):
    """Fill the row CHANGE of what is kept; the size of the change (m/s2)."""
    a, lever, kept = row(words, A), row(words, LEVER), rows(words, KEPT)
    square = 0.0
    for i in range(a.shape[0]):
        kept[CHANGE, i] = lever[i] * (a[i] - kept[FROM, i])
        square += kept[CHANGE, i] ** 2
    return math.sqrt(square)


@part
def stay(words, to):
    """Keep the present accelerations and multipliers as those of a row."""
    a, multipliers = row(words, A), row(words, MULTIPLIERS)
    kept, kept_multipliers = rows(words, KEPT), rows(words, KEPT_MULTIPLIERS)
    for i in range(a.shape[0]):
        kept[to, i] = a[i]
    for i in range(multipliers.shape[0]):
        kept_multipliers[to, i] = multipliers[i]


@part
def lead(words, change):
    """Move from where the iteration led to where the pairs lead; change: size of its own change (m/s2)."""
    number = numbers(words, NUMBER)
    stay(words, LED)
    number[FOLLOWS] = 1
    if number[PAIRS] > 0:
        share = room1(DEPTH)
        shares(words, number[PAIRS], change, share)
        move(words, share, change)
    draw(words)


@kernel
def go_on(words, jacobians, gain, leads):
    """Move to where the next iteration starts; whether it is to be with a new Jacobian.

    It is where the change is more than `gain` times the way that led to where it began. jacobians: how many were
    computed so far; leads: False to begin only with what is kept.
    """
    number = numbers(words, NUMBER)
    number[COUNT] += 1
    if jacobians != number[JACOBIAN]:
        number[JACOBIAN], number[PAIRS], number[NEXT], number[FOLLOWS] = jacobians, 0, 0, 0
        number[STAGE] = NOWHERE
    if not leads:
        stay(words, FROM)
        number[STAGE] = NOWHERE
        return False
    if number[FOLLOWS]:
        keep_pair(words, number[NEXT])
        number[NEXT] = (number[NEXT] + 1) % DEPTH
        number[PAIRS] = min(number[PAIRS] + 1, DEPTH)
    change = measure(words)
    if number[STAGE] == SEEKS:
        ends = found(words)
        go_to(words)
        if ends:
            number[STAGE] = NOWHERE
        return ends
    slow = number[STAGE] != NOWHERE and change > gain * math.sqrt(row(words, ON_LINE)[SQUARE])
    # Where the Jacobian is of an earlier step, a new one comes first.
    if slow and number[FIXED] and jacobians > number[SINCE]:
        share = along(words)
        if share < BEYOND:
            turn_back(words, share)
            go_to(words)
            return False
    lead(words, change)
    return slow
