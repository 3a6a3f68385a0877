"""Time integration of a tree: fixed steps, or steps as long as their error allows; one row of results per step."""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.tree_arrays import view
from granular_contact.engines.tree.kernels.tree_calls import attempt, end, soonest
from granular_contact.engines.tree.kernels.tree_joints import evaluate_signals, prescribe
from granular_contact.engines.tree.kernels.tree_newton import finish_lagged, initial_accelerations, restore_start
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import copy, flat, piece
from granular_contact.mechanics.kernels import step_error
from granular_contact.mechanics.kernels.step_choice import LONGER, Prescribed, factor, limit_step, needed
from granular_contact.sand.kernels.lines import TIME

# Reasons for which `march` returns: its share of steps is done, all bodies rest, the end time, no step is small enough
# for Newton's method, the motion diverged, too many steps.
PAUSE, REST, END, FAILED, AWAY, MANY_STEPS = 0, 1, 2, 3, 4, 5


@kernel
def start(begins, addresses):
    """Find the accelerations at the start and write the first row; begins: whether to reset the friction state."""
    w = view(addresses)
    table, clock = w.table, w.clock[0]
    evaluate_signals(0.0, w)
    prescribe(0.0, w)
    if begins:
        end(w, piece(table, 0, table.shape[1]), True)
    initial_accelerations(w)
    write_row(0.0, w)
    clock.speed = step_error.begin(w.changes, clock.step)
    clock.greatest = clock.speed


@part
def write_row(t, w):
    """Accept the step that ends at t (s), and write the next rows of `table` and `states`.

    A row of `states` has the poses, their rates, the accelerations and the residuals of all nodes, and the targets of
    their drives.
    """
    table, states, last = w.table, w.states, w.counts[0].steps
    history, row = piece(table, last, table.shape[1]), piece(states, last, states.shape[1])
    copy(history, w.blank)
    end(w, history, False)
    history[TIME] = t
    first = append(flat(w.pose), row, 0)
    first = append(flat(w.pose_rates), row, first)
    first = append(flat(w.acceleration), row, first)
    first, state = append(w.residual, row, first), w.state
    for i in range(state.shape[0]):
        row[first + i] = state[i].target


@part
def append(numbers, row, first):
    """Write numbers into a row from the index `first` on; return the index after them."""
    for i in range(numbers.shape[0]):
        row[first + i] = numbers[i]
    return first + numbers.shape[0]


@part
def keep_start(w):
    """Keep the state as the one at the start of the step."""
    copy(w.s_before, w.s)
    copy(w.rates_before, w.rates)
    copy(w.s2_before, w.s2)
    copy(w.lagged_before, w.lagged)


@part
def newton_tolerance(h, w):
    """Tolerance (m/s) of the iterations of a step h (s), on changes of speeds.

    It is a share of the change of speed that the forces of the scene cause in the step, or of the greatest speed so
    far, whichever is smaller. The first bound alone would leave errors as large as the elastic forces where these are
    small beside the weight of the bodies that they move, and a robot that stands would creep.
    """
    control, greatest = w.control[0], w.clock[0].greatest
    return min(control.tolerance * h, control.share * max(greatest, control.slow))


@part
def adaptive_step(h, w):
    """Step by h (s), or by less as the error allows; return the length (s), 0 if no step can be solved."""
    clock, choice, counts = w.clock[0], w.choice[0], w.counts[0]
    refused, newton = False, w.newton[0]
    while True:
        if not attempt(h, newton_tolerance(h, w), w):
            newton.matrix_of_v = 0.0
            if h <= choice.least:
                return 0.0
            h = max(0.5 * h, choice.least)
            continue
        need = needed(w.changes, h, choice, clock.fastest, clock.speed)
        if need > 1.0 and h > choice.least:
            counts.refused += 1
            newton.matrix_of_v, refused = 0.0, True
            h = max(factor(need) * h, choice.least)
            continue
        wanted = h if refused and need > 1.0 else min(factor(need) * h, choice.longest)
        clock.step = h if h < wanted < LONGER * h and wanted < choice.longest else wanted
        return h


@part
def fixed_step(h, w):
    """Step by h (s), halved until Newton's method converges; return the length (s), 0 if no step can be solved."""
    whole, least = h, w.choice[0].least
    while not attempt(h, newton_tolerance(h, w), w):
        w.newton[0].matrix_of_v = 0.0
        h *= 0.5
        if h < least:
            return 0.0
    w.counts[0].shortened += h < whole
    return h


@part
def next_step(w):
    """Length (s) of the step to try next. The last two steps before the end time are about equally long."""
    clock, choice, is_fixed = w.clock[0], w.choice[0], w.scheme[0].fixed
    t, h, left = clock.now, clock.step, w.control[0].end - clock.now
    if is_fixed:
        return left if h > left * (1.0 - 1e-9) else h
    tables = w.knots, w.pieces, w.wanted
    prescribed = Prescribed(w.bends, w.followed, w.arms, *tables)
    h = limit_step(t, h, soonest(w), choice, clock.fastest, clock.speed, prescribed)
    return left if h > 0.99 * left else min(h, 0.5 * left) if h > 0.5 * left else h


@part
def reason_to_end(w):
    """Code of the reason to end the march; PAUSE if there is a next step."""
    clock, control, counts = w.clock[0], w.control[0], w.counts[0]
    moves = step_error.fastest(flat(w.twist), w.lever) > control.rest_speed
    clock.resting_since = math.inf if moves else min(clock.resting_since, clock.now)
    if clock.now - clock.resting_since >= control.rest_time:
        return REST
    if clock.now >= control.end:
        return END
    return MANY_STEPS if counts.steps > control.most else PAUSE


@part
def advance_clock(h, left, w):
    """Set the clock after a step of h (s), with `left` (s) until the end time before the step.

    Fixed steps are counted: the rounded sum of a hundred thousand steps would be late by more than round-off.
    """
    clock, whole = w.clock[0], w.scheme[0].fixed and h == w.clock[0].step
    if whole and h < left:
        clock.whole += 1.0
        clock.now = clock.origin + clock.whole * h
    else:
        clock.now = w.control[0].end if h == left else clock.now + h
        clock.origin, clock.whole = clock.now, 0.0


@kernel
def march(share, addresses):
    """Take at most `share` steps, for which the tables have room; return the code of the reason to return."""
    w = view(addresses)
    clock, control, counts = w.clock[0], w.control[0], w.counts[0]
    is_fixed = w.scheme[0].fixed
    for _ in range(share):
        keep_start(w)
        asked, left = next_step(w), control.end - clock.now
        h = fixed_step(asked, w) if is_fixed else adaptive_step(asked, w)
        if h == 0.0:
            restore_start(w)
            return FAILED
        if not step_error.fastest(flat(w.twist), w.lever) < control.away:
            return AWAY
        finish_lagged(w)
        advance_clock(h, left, w)
        counts.steps += 1
        write_row(clock.now, w)
        clock.speed = step_error.begin(w.changes, h)
        clock.greatest = max(clock.greatest, clock.speed)
        clock.fastest = max(clock.fastest, clock.speed)
        reason = reason_to_end(w)
        if reason != PAUSE:
            return reason
    return PAUSE
