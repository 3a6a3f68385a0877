"""One step of a tree of rigid bodies by the generalised-alpha method, solved by a modified Newton method.

The time scheme is that of Chung and Hulbert (1993) in the form of Arnold and Bruels (2007), the one that Exudyn uses.
Each end of a step h has accelerations a, which satisfy the equations of motion, and lagged accelerations l, which move
the coordinates:

    (1 - alpha_m) l_1 + alpha_m l_0 = (1 - alpha_f) a_1 + alpha_f a_0
    s_1 = s_0 + h s'_0 + h^2 ((1/2 - beta) l_0 + beta l_1),    s'_1 = s'_0 + h ((1 - gamma) l_0 + gamma l_1).

a_1 is found such that all residuals R of `tree` vanish at the end of the step, with bristles and all other forces at
s_1 and s'_1. A change of a_1 by 1 changes coordinates by of_q (s^2) and rates by of_v (s). `anderson` starts and
accelerates the iterations. The matrix, in the form of articulated-body inertias, is kept over several steps. It is
renewed when an iteration contracts too little, or when the step changes by more than the factors SHORTER and LONGER.
"""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.tree_calls import accelerate, begin_iterations, iterate, update_active
from granular_contact.engines.tree.kernels.tree_joints import evaluate_signals, prescribe
from granular_contact.jit.compiled import part
from granular_contact.jit.memory import copy
from granular_contact.mechanics.kernels.numerics import MOST_ITERATIONS
from granular_contact.mechanics.kernels.step_choice import LONGER, SHORTER, TOO_LONG, needed


@part
def predict(h, w):
    """Fill the state at the end of a step h (s) for zero accelerations a_1; return of_q and of_v."""
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
    """Start the iterations of a step from the accelerations of the last step, as `anderson` does."""
    newton = w.newton[0]
    if not SHORTER * newton.matrix_of_v < of_v < LONGER * newton.matrix_of_v:
        newton.matrix_of_v = 0.0
    begin_iterations(of_q, of_v, w)
    prescribe(of_v, w)


@part
def needs_matrix(of_v, w):
    """Count an iteration; return whether it needs a new matrix, which then is the one for of_v."""
    newton = w.newton[0]
    newton.iterations += 1
    if newton.matrix_of_v != 0.0:
        return False
    newton.matrices += 1
    newton.matrix_of_v = of_v
    return True


@part
def is_too_long(h, w):
    """Return whether an iterate shows a step of h (s) to be more than TOO_LONG times as long as its error allows."""
    clock, choice = w.clock[0], w.choice[0]
    if w.scheme[0].fixed or h <= choice.least:
        return False
    return needed(w.changes, h, choice, clock.fastest, clock.speed) > TOO_LONG


@part
def converges(h, of_q, of_v, allowed, w):
    """Iterate Newton's method until the next change of speeds is at most `allowed` (m/s); return whether it converged.

    Afterwards forces and accelerations of nodes belong to the state. A step that its error would refuse by far does not
    get this far: it ends as soon as an iterate `is_too_long`.
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
        if is_too_long(h, w):
            w.counts[0].refused += 1
            return False
        for i in range(s.shape[0]):
            s[i] += of_q * change[i]
            rates[i] += of_v * change[i]
            s2[i] += change[i]
    return False


@part
def attempt(h, allowed, w):
    """Try a step of h (s); return whether Newton's method converged; allowed (m/s): see `converges`."""
    clock = w.clock[0]
    clock.tried = h
    update_active(h, w)
    of_q, of_v = predict(h, w)
    evaluate_signals(clock.now + h, w)
    begin(of_q, of_v, w)
    return converges(h, of_q, of_v, allowed, w)


@part
def finish_lagged(w):
    """Complete the lagged accelerations at the end of a step that was solved."""
    c, s2, lagged = w.scheme[0], w.s2, w.lagged
    for i in range(s2.shape[0]):
        lagged[i] += (1.0 - c.alpha_f) / (1.0 - c.alpha_m) * s2[i]


@part
def restore_start(w):
    """Return to the state at the start of a step that cannot be solved."""
    copy(w.s, w.s_before)
    copy(w.rates, w.rates_before)
    copy(w.s2, w.s2_before)
    copy(w.lagged, w.lagged_before)


@part
def initial_accelerations(w):
    """Find the accelerations that satisfy the equations of motion at the start; lagged ones are the same."""
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
