"""What a choice of steps asks of accelerations, in one call; see `mechanics.stepping`.

Arrays are found by their places (`lending`), in this order:

    a, v    (m,) accelerations and rates, as the engine has them
    lever   (m,) factors from rates to speeds
    group   (m,) what a coordinate belongs to: EACH counts by itself, NONE not at all, from 0 on to a direction of a
            link, of which the mean counts
    start   (m,) accelerations at the start of the step, times lever; change: what they have changed by since
    change
    slope   (m,) change over the step before, over its length
    means   (groups, 3) to work in
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.lending import lender
from granular_contact.jit.memory import clear

EACH, NONE = -1, -2
_row, _rows = (lender(np.float64, axes) for axes in (1, 2))
_groups = lender(np.int64, 1)


@part
def fastest(v, lever):
    """Greatest speed; infinite where one is no number."""
    most = 0.0
    for i in range(v.shape[0]):
        size = abs(lever[i] * v[i])
        if not size <= most:
            most = size if size < math.inf else math.inf
    return most


@kernel
def measure(words, step):
    """Greatest speed (m/s), and of the changes over a step (s) the unexpected, the whole and with all that links bend.

    Changes in m/s2; all are infinite where a number is none. `change` is filled.
    """
    a, v, lever, group = _row(words, 0), _row(words, 1), _row(words, 2), _groups(words, 3)
    start, change, slope, means = _row(words, 4), _row(words, 5), _row(words, 6), _rows(words, 7)
    clear(means)
    jump, whole, most = 0.0, 0.0, 0.0
    for i in range(a.shape[0]):
        change[i] = lever[i] * a[i] - start[i]
        other = change[i] - slope[i] * step
        size = abs(change[i])
        if not size < math.inf:
            return math.inf, math.inf, math.inf, math.inf
        least = change[i] if size < abs(other) else other
        most = max(most, size)
        if group[i] == EACH:
            jump, whole = max(jump, abs(least)), max(whole, size)
        elif group[i] != NONE:
            means[group[i], 0] += 1.0
            means[group[i], 1] += least
            means[group[i], 2] += change[i]
    for g in range(means.shape[0]):
        if means[g, 0] > 0.0:
            jump, whole = max(jump, abs(means[g, 1]) / means[g, 0]), max(whole, abs(means[g, 2]) / means[g, 0])
    return fastest(v, lever), jump, whole, most


@kernel
def begin(words, last):
    """Begin a step after one of `last` (s): fill start and slope; the greatest speed (m/s)."""
    a, v, lever = _row(words, 0), _row(words, 1), _row(words, 2)
    start, change, slope = _row(words, 4), _row(words, 5), _row(words, 6)
    for i in range(a.shape[0]):
        start[i] = lever[i] * a[i]
        slope[i] = change[i] / last
    return fastest(v, lever)
