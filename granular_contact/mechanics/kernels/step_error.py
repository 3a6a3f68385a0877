"""Changes of the accelerations over a step, from which step-size control estimates the error (`mechanics.stepping`).

Arrays, of a view `w` of CHANGES (`jit.layout`):

    a, v    (m,) accelerations and rates of the engine
    lever   (m,) factors from rates to speeds
    group   (m,) group of a coordinate: EACH counts by itself, NONE not at all; a number from 0 on means one direction
            of a link, of which the mean over its nodes counts
    start   (m,) accelerations at the start of the step, times lever; change: their change since then
    change
    slope   (m,) change over the step before, divided by its length
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
    """Greatest speed (m/s); infinite where a rate is not finite."""
    greatest = 0.0
    for i in range(v.shape[0]):
        size = abs(lever[i] * v[i])
        if not size <= greatest:
            greatest = size if size < math.inf else math.inf
    return greatest


@kernel
def measure(addresses, step):
    """Greatest speed (m/s) and greatest changes of accelerations over a step (s), in m/s2: jump, whole and greatest.

    jump: unexpected part of the change, by which the force may have jumped; whole: the whole change; both of groups.
    greatest: whole change of any single coordinate, so that the bending of links counts. All four are infinite where an
    acceleration is not finite. `change` is filled.
    """
    w = view(addresses)
    a, v, lever, group = w.a, w.v, w.lever, w.group
    start, change, slope, means = w.start, w.change, w.slope, w.means
    clear(means)
    jump, whole, greatest = 0.0, 0.0, 0.0
    for i in range(a.shape[0]):
        change[i] = lever[i] * a[i] - start[i]
        beyond_slope = change[i] - slope[i] * step
        size = abs(change[i])
        if not size < math.inf:
            return math.inf, math.inf, math.inf, math.inf
        unexpected = change[i] if size < abs(beyond_slope) else beyond_slope
        greatest = max(greatest, size)
        if group[i] == EACH:
            jump, whole = max(jump, abs(unexpected)), max(whole, size)
        elif group[i] != NONE:
            mean = means[group[i]]
            mean.count += 1.0
            mean.unexpected += unexpected
            mean.whole += change[i]
    for g in range(means.shape[0]):
        mean = means[g]
        if mean.count > 0.0:
            jump, whole = max(jump, abs(mean.unexpected) / mean.count), max(whole, abs(mean.whole) / mean.count)
    return fastest(v, lever), jump, whole, greatest


@kernel
def begin(addresses, last):
    """Begin a step after one of length `last` (s): fill start and slope, and return the greatest speed (m/s)."""
    w = view(addresses)
    a, v, lever = w.a, w.v, w.lever
    start, change, slope = w.start, w.change, w.slope
    for i in range(a.shape[0]):
        start[i] = lever[i] * a[i]
        slope[i] = change[i] / last
    return fastest(v, lever)
