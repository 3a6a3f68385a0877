"""March of the modal pendulum through time: steps, rows on a regular grid, and what is looked for inside each step.

A step is known as a polynomial C in theta = (t - t_0) / h (see `dormand_prince`), whoever made it. In it are located
the first end of a regime (`regime_end`), the rows of the table, and the first zeros of the mean rate and of the hub's
own rate after the touch (`finish`).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels.dormand_prince import STAGES, error, inside, interpolant, step
from granular_contact.kernels.modal_load import drag
from granular_contact.kernels.modal_motion import follow, margins, rates
from granular_contact.kernels.pendulum import inertia, momentum
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
TOUCHED, MEAN_SIGN, MEAN_TIME, MEAN_ANGLE, HUB_SIGN, HUB_TIME = 0, 1, 2, 3, 4, 5  # of watch (6,)
HALVINGS = 48


@njit(cache=True)
def least_margin(C, theta, s, w, y, margin):
    """Smallest margin at theta of a step; y and margin are filled."""
    inside(C, theta, y)
    margins(y, s, w, margin)
    return np.min(margin)


@njit(cache=True)
def regime_end(C, s, w, stopped):
    """Theta of the first end of a regime in a step, 2 if there is none; marks the components that end it.

    By the Illinois form of false position; both halves are looked at, as a component may turn and turn back.
    """
    y, margin = np.empty(C.shape[1]), np.empty_like(s)
    stopped[:] = False
    near = w.pendulum[0].still
    low, f_low = 0.0, np.inf
    for high in (0.5, 1.0):
        f_high = least_margin(C, high, s, w, y, margin)
        if f_high >= 0.0:
            low, f_low = high, f_high
            continue
        if f_low == np.inf:
            f_low = least_margin(C, low, s, w, y, margin)
        if f_low < 0.0:
            f_high = least_margin(C, low, s, w, y, margin)
            stopped[:] = margin < 0.0
            return low
        side = 0
        for _ in range(HALVINGS):
            if f_high > -near or high - low < 1e-13:
                break
            theta = (low * f_high - high * f_low) / (f_high - f_low)
            f = least_margin(C, theta, s, w, y, margin)
            if f >= 0.0:
                low, f_low = theta, f
                f_high *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                high, f_high = theta, f
                f_low *= 0.5 if side == -1 else 1.0
                side = -1
        least_margin(C, high, s, w, y, margin)
        stopped[:] = margin < 0.0
        return high
    return 2.0


@njit(cache=True)
def write_row(t, y, s, w, row):
    """Fill a row: time, state, forces of the medium (3, 3) as in `strips`."""
    size = y.shape[0]
    dy, sigma, totals = np.empty_like(y), np.zeros_like(s), np.zeros((3, 3))
    rates(y, s, w, sigma, totals, dy)
    row[0] = t
    row[1 : 1 + size] = y
    for i in range(9):
        row[1 + size + i] = totals[i // 3, i % 3]


@njit(cache=True)
def turning(y, w, which):
    """Mean rate (which = 0) or rate of the hub (which = 1), rad/s."""
    m = w.pendulum[0].modes + 1
    q, v = y[:m], y[m : 2 * m]
    return v[0] if which == 1 else momentum(q, v, w.pendulum[0]) / inertia(q, w.pendulum[0])


@njit(cache=True)
def look_for_stop(t, h, C, w, watch):
    """Locate the first zeros of mean rate and hub rate after the touch."""
    y = np.empty(C.shape[1])
    for which, sign, time in ((0, MEAN_SIGN, MEAN_TIME), (1, HUB_SIGN, HUB_TIME)):
        if not np.isnan(watch[time]):
            continue
        if watch[sign] == 0.0:
            watch[sign] = np.sign(turning(C[0], w, which))
        inside(C, 1.0, y)
        if watch[sign] == 0.0 or turning(y, w, which) * watch[sign] > 0.0:
            continue
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            theta = 0.5 * (low + high)
            inside(C, theta, y)
            if turning(y, w, which) * watch[sign] > 0.0:
                low = theta
            else:
                high = theta
        inside(C, high, y)
        watch[time] = t + high * h
        if which == 0:
            watch[MEAN_ANGLE] = y[0]


@njit(cache=True)
def finish(t, h, C, s, w, control, rows, counts, watch):
    """Take a step from t as accepted: rows, stop, anchors."""
    y, m = np.empty(C.shape[1]), w.pendulum[0].modes + 1
    due = counts[ROWS] * control.interval
    while due <= t + h and counts[ROWS] < rows.shape[0]:
        inside(C, (due - t) / h, y)
        write_row(due, y, s, w, rows[counts[ROWS]])
        counts[ROWS] += 1
        due = counts[ROWS] * control.interval
    if w.runs.shape[0] == 0:
        return
    inside(C, 1.0, y)
    if watch[TOUCHED] == 0.0 and middle(y[:m], w)[2]:
        watch[TOUCHED] = 1.0
    if watch[TOUCHED] != 0.0:
        look_for_stop(t, h, C, w, watch)
    if not w.pendulum[0].true_sign:
        drag(y[:m], y[m : 2 * m], w)


@njit(cache=True)
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


@njit(cache=True)
def shorten(C, theta):
    """Let the polynomial of a step end at theta of it."""
    factor = 1.0
    for power in range(1, C.shape[0]):
        factor *= theta
        C[power] *= factor


@njit(cache=True)
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
        h = min(clock[STEP], c.longest, c.end - clock[NOW])
        while True:
            step(y, h, s, w, k, sigma, totals, end)
            counts[RATES] += STAGES
            ratio = error(h, k, allowed)
            if ratio <= 1.0:
                break
            counts[REJECTED] += 1
            h *= max(0.2, 0.9 * ratio**-0.2) if ratio < np.inf else 0.1
            if h <= 1e-14 * c.end:
                clock[STEP] = h
                return FAILED
        clock[STEP] = h * min(5.0, 0.9 * max(ratio, 1e-10) ** -0.2)
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
        y[:] = end
        clock[NOW] += h
        counts[STEPS] += 1
        if theta <= 1.0:
            return REGIME_END
        if rests(y, s, w, c, clock):
            return REST
        if clock[NOW] >= c.end * (1.0 - 1e-14):
            return END
    return PAUSE
