"""What a choice of steps asks of accelerations, in one call; see `mechanics.stepping`.

Arrays, of a view `w` of CHANGES (`jit.layout`):

    a, v    (m,) accelerations and rates, as the engine has them
    lever   (m,) factors from rates to speeds
    group   (m,) what a coordinate belongs to: EACH counts by itself, NONE not at all, from 0 on to a direction of a
            link, of which the mean counts
    start   (m,) accelerations at the start of the step, times lever; change: what they have changed by since
    change
    slope   (m,) change over the step before, over its length
    means   (groups,) records of MEAN, to work in
"""

from __future__ import annotations

import math

import numpy as np

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.layout import Layout
from granular_contact.jit.memory import clear
from granular_contact.jit.records import fields, record_dtype

EACH, NONE = -1, -2
# Of a group: number of its coordinates, sums of the unexpected changes and of the whole changes (m/s2).
MEAN = record_dtype(fields("f8", "count", "unexpected", "whole"))
CHANGES = Layout(
    "changes",
    **dict.fromkeys(("a", "v", "lever", "start", "change", "slope"), (float, 1)),
    group=(np.int64, 1),
    means=(MEAN, 1),
)
view = CHANGES.view


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
def measure(addresses, step):
    """Greatest speed (m/s), and of the changes over a step (s) the unexpected, the whole and with all that links bend.

    Changes in m/s2; all are infinite where a number is none. `change` is filled.
    """
    w = view(addresses)
    a, v, lever, group = w.a, w.v, w.lever, w.group
    start, change, slope, means = w.start, w.change, w.slope, w.means
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
            mean = means[group[i]]
            mean.count += 1.0
            mean.unexpected += least
            mean.whole += change[i]
    for g in range(means.shape[0]):
        mean = means[g]
        if mean.count > 0.0:
            jump, whole = max(jump, abs(mean.unexpected) / mean.count), max(whole, abs(mean.whole) / mean.count)
    return fastest(v, lever), jump, whole, most


@kernel
def begin(addresses, last):
    """Begin a step after one of `last` (s): fill start and slope; the greatest speed (m/s)."""
    w = view(addresses)
    a, v, lever = w.a, w.v, w.lever
    start, change, slope = w.start, w.change, w.slope
    for i in range(a.shape[0]):
        start[i] = lever[i] * a[i]
        slope[i] = change[i] / last
    return fastest(v, lever)
