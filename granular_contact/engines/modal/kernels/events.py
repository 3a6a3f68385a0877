"""Event location inside a step of the modal pendulum: ends of regimes of the static law, and zeros of the rate.

A step is known as a polynomial C in theta = (t - t_0) / h, one row of coefficients for each power (dense output).
"""

from __future__ import annotations

import numpy as np

from granular_contact.engines.modal.kernels.modal import SIZE
from granular_contact.engines.modal.kernels.modal_calls import margins
from granular_contact.engines.modal.kernels.pendulum import inertia, momentum
from granular_contact.engines.modal.kernels.runge_kutta import inside
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import piece, room1, rows
from granular_contact.jit.records import fields, record_dtype

MEAN, HUB = 0, 1  # the mean rate of the pendulum, and the rate of its hub
# touched: 1 once the middle of the immersed segment has been below the surface, else 0. Of both rates: sign after the
# touch, 0 until it is known; time (s) and angle q_1 (rad) of the first zero after the touch, NaN until it is found.
WATCH = record_dtype([*fields("f8", "touched"), *((name, "f8", (2,)) for name in ("sign", "time", "angle"))])
HALVINGS = 48


@part
def least_margin(C, theta, s, w, y, margin):
    """Smallest margin of all components at theta of a step; fills y and margin."""
    inside(C, theta, y)
    margins(y, s, w, margin)
    least = np.inf
    for c in range(margin.shape[0]):
        least = min(least, margin[c])
    return least


@part
def mark(margin, stopped):
    """Mark the components that are beyond the end of their regime."""
    for c in range(margin.shape[0]):
        stopped[c] = margin[c] < 0.0


@kernel
def regime_end(C, s, w, stopped):
    """Theta of the first end of a regime in a step, 2 if there is none; marks the components that end it.

    Method: false position in its Illinois form, at most HALVINGS iterations, until the margin is beyond zero by less
    than the speed that counts as none. Both halves of the step are searched, as a component may turn and turn back.
    Limit: two turns within a half are not found.
    """
    y, margin = rows(room1(SIZE), 0, C.shape[1]), rows(room1(2), 0, s.shape[0])
    for c in range(stopped.shape[0]):
        stopped[c] = False
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
            mark(margin, stopped)
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
        mark(margin, stopped)
        return high
    return 2.0


@part
def turning(y, w, which):
    """Mean rate (which = MEAN) or rate of the hub (which = HUB), rad/s."""
    m = w.pendulum[0].modes + 1
    q, v = rows(y, 0, m), rows(y, m, m)
    return v[0] if which == HUB else momentum(q, v, w.pendulum[0]) / inertia(q, w.pendulum[0])


@part
def look_for_stop(t, h, C, w, watch):
    """Locate the first zeros of the mean rate and of the hub's rate after the touch, by bisection."""
    y, sign, time = rows(room1(SIZE), 0, C.shape[1]), watch.sign, watch.time
    for which in (MEAN, HUB):
        if not np.isnan(time[which]):
            continue
        if sign[which] == 0.0:
            sign[which] = np.sign(turning(piece(C, 0, C.shape[1]), w, which))
        inside(C, 1.0, y)
        if sign[which] == 0.0 or turning(y, w, which) * sign[which] > 0.0:
            continue
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            theta = 0.5 * (low + high)
            inside(C, theta, y)
            if turning(y, w, which) * sign[which] > 0.0:
                low = theta
            else:
                high = theta
        inside(C, high, y)
        time[which] = t + high * h
        watch.angle[which] = y[0]


@kernel
def shorten(C, theta):
    """Rescale the polynomial of a step so that the step ends at theta."""
    factor = 1.0
    for power in range(1, C.shape[0]):
        factor *= theta
        for i in range(C.shape[1]):
            C[power, i] *= factor
