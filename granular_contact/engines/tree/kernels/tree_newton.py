"""One step of a tree of rigid bodies by the generalised-alpha method, solved by Newton's method.

The method of Chung and Hulbert (1993) in the form of Arnold and Bruels (2007), which is the engine's: accelerations a
that belong to the motion at the ends of a step h, and lagged ones l that move it,

    (1 - alpha_m) l_1 + alpha_m l_0 = (1 - alpha_f) a_1 + alpha_f a_0
    s_1 = s_0 + h s'_0 + h^2 ((1/2 - beta) l_0 + beta l_1),    s'_1 = s'_0 + h ((1 - gamma) l_0 + gamma l_1).

a_1 is found so that every joint passes on what is asked of it at the end of the step, where bristles and all other
forces are those of s_1 and s'_1. With each unit of a_1 coordinates change by of_q and rates by of_v. Start and
acceleration of the iterations: `anderson`. The matrix, an articulated-body inertia, is kept over steps; it is renewed
where an iteration contracts too little, or the step changes by more than the factors SHORTER and LONGER.
"""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.tree_calls import accelerate, begin_iterations, iterate, update_active
from granular_contact.engines.tree.kernels.tree_joints import follow_signals, prescribe
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import copy
from granular_contact.mechanics.kernels.numerics import MOST_ITERATIONS
from granular_contact.mechanics.kernels.step_choice import LONGER, SHORTER


@part
def predict(h, w):
    """Fill the state with what a step of h (s) leads to without any acceleration at its end; of_q and of_v."""
    c, s, rates, s2, lagged = w.scheme[0], w.s, w.rates, w.s2, w.lagged
    s_0, rates_0, s2_0, lagged_0 = w.s_before, w.rates_before, w.s2_before, w.lagged_before
    for i in range(s.shape[0]):
        s2[i], lagged[i] = 0.0, (c.alpha_f * s2_0[i] - c.alpha_m * lagged_0[i]) / (1.0 - c.alpha_m)
        moved = (0.5 - c.beta) * lagged_0[i] + c.beta * lagged[i]
        s[i] = s_0[i] + h * (rates_0[i] + h * moved)
        rates[i] = rates_0[i] + h * ((1.0 - c.gamma) * lagged_0[i] + c.gamma * lagged[i])
    share = (1.0 - c.alpha_f) / (1.0 - c.alpha_m)
    return c.beta * h * h * share, c.gamma * h * share


@part
def begin(of_q, of_v, w):
    """Begin a step with the accelerations of the last one, as `anderson` does."""
    newton = w.newton[0]
    if not SHORTER * newton.matrix_of_v < of_v < LONGER * newton.matrix_of_v:
        newton.matrix_of_v = 0.0
    begin_iterations(of_q, of_v, w)
    prescribe(of_v, w)


@part
def needs_matrix(of_v, w):
    """Count an iteration; whether it needs a new matrix, which then is that of of_v."""
    newton = w.newton[0]
    newton.iterations += 1
    if newton.matrix_of_v != 0.0:
        return False
    newton.matrices += 1
    newton.matrix_of_v = of_v
    return True


@part
def solved(of_q, of_v, allowed, w):
    """Whether Newton's method comes to where the next iteration would change speeds by at most `allowed` (m/s).

    Then forces and accelerations are those of the state.
    """
    newton, change, s, rates, s2 = w.newton[0], w.change, w.s, w.rates, w.s2
    for iteration in range(MOST_ITERATIONS):
        if iteration > 0:
            if accelerate(w):
                newton.matrix_of_v = 0.0
            prescribe(of_v, w)
        size = of_v * iterate(of_q, of_v, w)
        if size <= allowed:
            return True
        if not size < math.inf:
            return False
        for i in range(s.shape[0]):
            s[i] += of_q * change[i]
            rates[i] += of_v * change[i]
            s2[i] += change[i]
    return False


@part
def attempt(h, allowed, w):
    """Whether a step of h (s) can be solved; allowed: see `solved`."""
    clock = w.clock[0]
    clock.tried = h
    update_active(h, w)
    of_q, of_v = predict(h, w)
    follow_signals(clock.now + h, w)
    begin(of_q, of_v, w)
    return solved(of_q, of_v, allowed, w)


@part
def finish(w):
    """Bring the lagged accelerations to the end of a step that is solved."""
    c, s2, lagged = w.scheme[0], w.s2, w.lagged
    for i in range(s2.shape[0]):
        lagged[i] += (1.0 - c.alpha_f) / (1.0 - c.alpha_m) * s2[i]


@part
def go_back(w):
    """Return to the start of a step that can't be solved."""
    copy(w.s, w.s_before)
    copy(w.rates, w.rates_before)
    copy(w.s2, w.s2_before)
    copy(w.lagged, w.lagged_before)


@part
def settle_in(w):
    """Find the accelerations that belong to coordinates and rates at a start, where none are known."""
    s2, newton, change = w.s2, w.newton[0], w.change
    for i in range(s2.shape[0]):
        s2[i] = 0.0
    prescribe(0.0, w)
    newton.matrix_of_v = 0.0
    iterate(0.0, 0.0, w)
    for i in range(s2.shape[0]):
        s2[i] += change[i]
    iterate(0.0, 0.0, w)
    copy(w.lagged, s2)
    newton.matrix_of_v = 0.0
