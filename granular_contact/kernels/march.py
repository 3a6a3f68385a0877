"""March of the modal pendulum through time: steps, rows on a regular grid, and what is looked for inside each step.

A step is known as a polynomial C in theta = (t - t_0) / h (see `dormand_prince`), whoever made it; what happens inside
it is found there, see `events`.
"""

from __future__ import annotations

import numpy as np

from granular_contact.kernels.compiled import kernel, part
from granular_contact.kernels.dormand_prince import STAGES, error, inside, interpolant, step
from granular_contact.kernels.events import TOUCHED, look_for_stop, regime_end, shorten
from granular_contact.kernels.modal_calls import rates
from granular_contact.kernels.modal_load import drag
from granular_contact.kernels.modal_motion import follow
from granular_contact.kernels.slip import middle, slip_velocity

# Why `march` came back: its share of steps is done, a regime ended, everything rests, the end, no step is small enough.
PAUSE, REGIME_END, REST, END, FAILED = 0, 1, 2, 3, 4

# Times and speeds in SI units; reach: greatest distance of a point from the pivot (m); rest_time infinite for never.
CONTROL = np.dtype(
    [
        ("end", "f8"),
        ("longest", "f8"),
        ("interval", "f8"),
        ("reach", "f8"),
        ("rest_speed", "f8"),
        ("rest_time", "f8"),
    ]
)
NOW, STEP, RESTING_SINCE = 0, 1, 2  # of clock (3,), s
STEPS, REJECTED, RATES, ROWS = 0, 1, 2, 3  # of counts (4,)


@kernel
def write_row(t, y, s, w, row):
    """Fill a row: time, state, forces of the medium (3, 3) as in `strips`."""
    size = y.shape[0]
    dy, sigma, totals = np.empty_like(y), np.zeros_like(s), np.zeros((3, 3))
    rates(y, s, w, sigma, totals, dy)
    row[0] = t
    for i in range(size):
        row[1 + i] = y[i]
    for i in range(9):
        row[1 + size + i] = totals[i // 3, i % 3]


@kernel
def finish(t, h, C, s, w, control, rows, counts, watch):
    """Take a step from t as accepted: rows, stop, anchors."""
    y, m = np.empty(C.shape[1]), w.pendulum[0].modes + 1
    due = counts[ROWS] * control.interval
    while due <= t + h and counts[ROWS] < rows.shape[0]:
        inside(C, (due - t) / h, y)
        write_row(due, y, s, w, rows[counts[ROWS]])
        counts[ROWS] += 1
        due = counts[ROWS] * control.interval
    if w.lines.shape[0] == 0:
        return
    inside(C, 1.0, y)
    if watch[TOUCHED] == 0.0 and middle(y[:m], w)[2]:
        watch[TOUCHED] = 1.0
    if watch[TOUCHED] != 0.0:
        look_for_stop(t, h, C, w, watch)
    if not w.pendulum[0].true_sign:
        drag(y[:m], y[m : 2 * m], w)


@kernel
def rests(y, s, w, control, clock):
    """Whether all that the medium can hold has been slow for long enough.

    A bristle damps the whole link. The true sign holds the middle of the immersed segment and nothing else: the link
    may vibrate about it for ever.
    """
    m = w.pendulum[0].modes + 1
    speed = abs(y[m]) * control.reach
    for i in range(m + 1, 2 * m):
        speed = max(speed, abs(y[i]))
    if speed > control.rest_speed and m > 1 and w.pendulum[0].true_sign:
        g = np.empty_like(s)
        if slip_velocity(y[:m], y[m : 2 * m], w, g):
            speed = max(abs(g[0]), abs(g[1]))
    if speed > control.rest_speed:
        clock[RESTING_SINCE] = clock[NOW]
    return clock[NOW] - clock[RESTING_SINCE] >= control.rest_time


@part
def attempt(y, s, w, control, allowed, clock, counts, k, sigma, totals, end):
    """Step from y, with k[0] = y' there, as far as the error allows; its length (s), 0 if no step is small enough."""
    h = min(clock[STEP], control.longest, control.end - clock[NOW])
    while True:
        step(y, h, s, w, k, sigma, totals, end)
        counts[RATES] += STAGES
        ratio = error(h, k, allowed)
        if ratio <= 1.0:
            clock[STEP] = h * min(5.0, 0.9 * max(ratio, 1e-10) ** -0.2)
            return h
        counts[REJECTED] += 1
        h *= max(0.2, 0.9 * ratio**-0.2) if ratio < np.inf else 0.1
        if h <= 1e-14 * control.end:
            return 0.0


@kernel
def march(share, y, s, w, control, allowed, clock, rows, counts, watch, stopped):
    """Step on from y until one of the reasons above; at most `share` steps. Everything passed in is kept up to date.

    y state, s regime of `modal_motion`; allowed: error of a step that each coordinate and rate may have; rows: table
    to be filled, (capacity, 1 + size + 9); stopped: the components that ended a regime.
    """
    c = control[0]
    size = y.shape[0]
    k, C, end = np.empty((STAGES, size)), np.empty((5, size)), np.empty(size)
    sigma, totals = np.zeros_like(s), np.zeros((3, 3))
    for _ in range(share):
        if counts[ROWS] >= rows.shape[0]:
            return PAUSE
        if w.pendulum[0].true_sign:
            follow(y, s, w)
        rates(y, s, w, sigma, totals, k[0])
        h = attempt(y, s, w, c, allowed, clock, counts, k, sigma, totals, end)
        if h == 0.0:
            return FAILED
        interpolant(y, h, k, C)
        theta = 2.0
        if w.pendulum[0].true_sign:
            theta = regime_end(C, s, w, stopped)
            if theta <= 1.0:
                # The interpolant is less exact than the step: step there, and look once more. If the end lies just
                # behind, the next step finds it near its start, where its interpolant is exact.
                h *= theta
                step(y, h, s, w, k, sigma, totals, end)
                counts[RATES] += STAGES
                interpolant(y, h, k, C)
                theta = regime_end(C, s, w, stopped)
        if theta <= 1.0:
            h *= theta
            shorten(C, theta)
            inside(C, 1.0, end)
        finish(clock[NOW], h, C, s, w, c, rows, counts, watch)
        for i in range(size):
            y[i] = end[i]
        clock[NOW] += h
        counts[STEPS] += 1
        if theta <= 1.0:
            return REGIME_END
        if rests(y, s, w, c, clock):
            return REST
        if clock[NOW] >= c.end * (1.0 - 1e-14):
            return END
    return PAUSE
