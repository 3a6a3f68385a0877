"""March of a tree through time: steps as long as their error allows, one row for each."""

from __future__ import annotations

import math

import numpy as np

from granular_contact.kernels import planar_sand
from granular_contact.kernels.chebyshev import MOST_STAGES, radius, stages_for, step
from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.joint_loads import VALUE
from granular_contact.kernels.lines import TIME
from granular_contact.kernels.memory import copy
from granular_contact.kernels.records import fields
from granular_contact.kernels.tree import SLIDER
from granular_contact.kernels.tree_load import accept, fastest, rates

# Why `march` came back: the table is full, everything rests, the end, no step is small enough.
PAUSE, REST, END, FAILED = 0, 1, 2, 3

# Times and speeds in SI units; allowed: error of a step, in position (m) and in velocity (m/s).
CONTROL = np.dtype([*fields("f8", "end", "longest", "rest_speed", "rest_time"), ("allowed", "f8", (2,))])
NOW, STEP, RESTING_SINCE, RADIUS, AGE = 0, 1, 2, 3, 4  # of clock (5,): s, s, s, 1/s and steps since that was found
STEPS, REJECTED, RATES = 0, 1, 2  # of counts (3,)
MOVES, WIDTH = 9, 11  # numbers of a node in a row of states: before the two works, and in all
OLD = 20  # steps after which the spectral radius is looked at anew


@kernel
def start(y, w, blank, states, rows):
    """Reset the friction state and write the first row."""
    accept(y, w, rows[0], True)
    rates(0.0, y, w, np.empty_like(y))
    write(0.0, y, w, blank, states[0], rows[0])


@part
def write(t, y, w, blank, state, row):
    """Accept y at time t (s) and keep it: the medium's doing in `row`, first made `blank`, all else in `state`.

    state: pose, twist and acceleration of all nodes, both works, efforts of all joints, and what their drives want.
    """
    copy(row, blank)
    accept(y, w, row, False)
    row[TIME] = t
    n = w.nodes.shape[0]
    for i in range(n):
        for k in range(3):
            state[3 * i + k] = w.motion.pose[i, k]
            state[3 * (n + i) + k] = w.motion.twist[i, k]
            state[3 * (2 * n + i) + k] = w.motion.acceleration[i, k]
        state[MOVES * n + 2 + i] = w.motion.effort[i]
        state[(MOVES + 1) * n + 2 + i] = w.state[i, VALUE]
    state[MOVES * n], state[MOVES * n + 1] = y[2 * n], y[2 * n + 1]


@part
def error(y, h, slope, end, end_slope, w, allowed):
    """Estimated error of a step over what is allowed for it; a coordinate that is prescribed has none.

    That of a body's angle is the sum of those of the hinges that carry it, and counts with the reach of the body;
    errors of bodies along a chain add like those of a random walk.
    """
    n, position, velocity = w.nodes.shape[0], 0.0, 0.0
    turned = w.motion.bias  # room for the errors of angles and of their rates; `place` fills it anew
    for i in range(n):
        node, one, two = w.nodes[i], 0.0, 0.0
        if not node.prescribed:
            one = 0.8 * (y[i] - end[i]) + 0.4 * h * (slope[i] + end_slope[i])
            two = 0.8 * (y[n + i] - end[n + i]) + 0.4 * h * (slope[n + i] + end_slope[n + i])
        if node.parent < 0:
            turned[i, 0], turned[i, 1] = 0.0, 0.0
        else:
            turned[i, 0], turned[i, 1] = turned[node.parent, 0], turned[node.parent, 1]
        if node.kind == SLIDER:
            position += one * one
            velocity += two * two
            continue
        turned[i, 0] += one
        turned[i, 1] += two
        position += (node.radius * turned[i, 0]) ** 2
        velocity += (node.radius * turned[i, 1]) ** 2
    return max(math.sqrt(position) / allowed[0], math.sqrt(velocity) / allowed[1])


@part
def tried(h, y, w, c, clock, counts, direction, slope, end, end_slope, before, last):
    """Try a step of h (s), and shorter ones until its error is allowed: its length, 0 if none is, and that ratio.

    slope: rates at y; end and end_slope get where it leads, and the rates there; before, last: to work in.
    """
    t = clock[NOW]
    while True:
        if clock[AGE] >= OLD:
            clock[RADIUS], evaluations = radius(t, y, slope, w, direction, last, before)
            clock[AGE] = 0
            counts[RATES] += evaluations
        stages = stages_for(h, clock[RADIUS])
        if stages == MOST_STAGES:
            h = (MOST_STAGES**2 - 2) / (1.54 * clock[RADIUS])
        step(t, y, h, stages, w, slope, before, last, end)
        rates(t + h, end, w, end_slope)
        counts[RATES] += stages
        ratio = error(y, h, slope, end, end_slope, w, c.allowed)
        if ratio <= 1.0:
            return h, ratio
        counts[REJECTED] += 1
        clock[AGE] = OLD
        h *= max(0.1, 0.8 * ratio ** (-1.0 / 3.0)) if ratio < np.inf else 0.1
        if h <= 1e-13 * c.end:
            return 0.0, ratio


@kernel
def march(y, w, control, clock, counts, direction, blank, states, rows):
    """Step on from y until one of the reasons above; everything passed in is kept up to date.

    direction: of the power method, see `chebyshev.radius`; states, rows: tables with a row for each accepted step, of
    which the first counts[STEPS] + 1 are filled.
    """
    c = control[0]
    slope, end, end_slope = np.empty_like(y), np.empty_like(y), np.empty_like(y)
    before, last = np.empty_like(y), np.empty_like(y)
    while True:
        if counts[STEPS] + 1 >= rows.shape[0]:
            return PAUSE
        h = min(clock[STEP], c.longest)
        left = c.end - clock[NOW]
        h = left if h > 0.99 * left else min(h, 0.5 * left) if h > 0.5 * left else h
        planar_sand.update_active(w.sand, h)
        rates(clock[NOW], y, w, slope)
        counts[RATES] += 1
        h, ratio = tried(h, y, w, c, clock, counts, direction, slope, end, end_slope, before, last)
        if h == 0.0:
            return FAILED
        clock[STEP] = h * min(5.0, 0.8 * max(ratio, 1e-10) ** (-1.0 / 3.0))
        clock[NOW] = c.end if h == left else clock[NOW] + h
        clock[AGE] += 1
        counts[STEPS] += 1
        copy(y, end)
        write(clock[NOW], y, w, blank, states[counts[STEPS]], rows[counts[STEPS]])
        if fastest(w) > c.rest_speed:
            clock[RESTING_SINCE] = clock[NOW]
        if clock[NOW] - clock[RESTING_SINCE] >= c.rest_time:
            return REST
        if clock[NOW] >= c.end:
            return END
