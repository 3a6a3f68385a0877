"""March of a tree through time: steps that are fixed, or as long as their error allows, one row for each."""

from __future__ import annotations

import math

from granular_contact.engines.tree.kernels.tree_arrays import view
from granular_contact.engines.tree.kernels.tree_calls import attempt, end, soonest
from granular_contact.engines.tree.kernels.tree_joints import follow_signals, prescribe
from granular_contact.engines.tree.kernels.tree_newton import finish, go_back, settle_in
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import copy, flat, piece
from granular_contact.mechanics.kernels import step_error
from granular_contact.mechanics.kernels.step_choice import LONGER, Prescribed, factor, limit_step, needed
from granular_contact.sand.kernels.lines import TIME

# Why `march` came back: its share of steps is done, everything rests, the end, no step is small enough, the motion
# diverged, there are too many steps.
PAUSE, REST, END, FAILED, AWAY, MANY_STEPS = 0, 1, 2, 3, 4, 5


@kernel
def start(begins, addresses):
    """Find the accelerations and write the first row; begins: with a friction state that is reset, else as it is."""
    w = view(addresses)
    table, clock = w.table, w.clock[0]
    follow_signals(0.0, w)
    prescribe(0.0, w)
    if begins:
        end(w, piece(table, 0, table.shape[1]), True)
    settle_in(w)
    write(0.0, w)
    clock.speed = step_error.begin(w.changes, clock.step)


@part
def write(t, w):
    """Accept a step that ends at t (s) and keep it in the next row.

    Of states: poses, their rates and accelerations of all nodes, what joints lack, and what their drives want.
    """
    table, states, at = w.table, w.states, w.counts[0].steps
    history, kept = piece(table, at, table.shape[1]), piece(states, at, states.shape[1])
    copy(history, w.blank)
    end(w, history, False)
    history[TIME] = t
    first = put(flat(w.pose), kept, 0)
    first = put(flat(w.pose_rates), kept, first)
    first = put(flat(w.acceleration), kept, first)
    first, state = put(w.rest, kept, first), w.state
    for i in range(state.shape[0]):
        kept[first + i] = state[i].target


@part
def put(numbers, kept, first):
    """Write numbers into a row from a place on; where they end."""
    for i in range(numbers.shape[0]):
        kept[first + i] = numbers[i]
    return first + numbers.shape[0]


@part
def keep(w):
    """Keep the state as that at the start of a step."""
    copy(w.s_before, w.s)
    copy(w.rates_before, w.rates)
    copy(w.s2_before, w.s2)
    copy(w.lagged_before, w.lagged)


@part
def allowed(h, w):
    """Change of speeds (m/s) at which the iterations of a step of h (s) end.

    A share of what the forces of the scene change in the step, and of the fastest speed so far: where elastic forces
    are small beside the weight of what they move, the first alone leaves as much of them as there is.
    """
    control, fastest = w.control[0], w.clock[0].fastest
    return min(control.tolerance * h, control.share * max(fastest, control.slow))


@part
def chosen(h, w):
    """Step by h (s), or by less, as the error allows; its length (s), 0 if no step can be solved."""
    clock, choice, counts = w.clock[0], w.choice[0], w.counts[0]
    refused, newton = False, w.newton[0]
    while True:
        if not attempt(h, allowed(h, w), w):
            newton.matrix_of_v = 0.0
            h *= 0.5
            if h < choice.least:
                return 0.0
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
def fixed(h, w):
    """Step by h (s), or by half of it and so on where that can't be solved; its length (s), 0 if none can be."""
    whole, least = h, w.choice[0].least
    while not attempt(h, allowed(h, w), w):
        w.newton[0].matrix_of_v = 0.0
        h *= 0.5
        if h < least:
            return 0.0
    w.counts[0].shortened += h < whole
    return h


@part
def next_step(w):
    """Length (s) of the step to try next; one that shares the time left evenly with the one after it."""
    clock, choice, is_fixed = w.clock[0], w.choice[0], w.scheme[0].fixed
    t, h, left = clock.now, clock.step, w.control[0].end - clock.now
    if is_fixed:
        return left if h > left * (1.0 - 1e-9) else h
    tables = w.knots, w.pieces, w.wanted
    prescribed = Prescribed(w.bends, w.followed, w.arms, *tables)
    h = limit_step(t, h, soonest(w), choice, clock.fastest, clock.speed, prescribed)
    return left if h > 0.99 * left else min(h, 0.5 * left) if h > 0.5 * left else h


@part
def is_over(w):
    """Why there is no next step; PAUSE where there is one."""
    clock, control, counts = w.clock[0], w.control[0], w.counts[0]
    moves = step_error.fastest(flat(w.twist), w.lever) > control.rest_speed
    clock.resting_since = math.inf if moves else min(clock.resting_since, clock.now)
    if clock.now - clock.resting_since >= control.rest_time:
        return REST
    if clock.now >= control.end:
        return END
    return MANY_STEPS if counts.steps > control.most else PAUSE


@part
def tick(h, left, w):
    """Set the clock after a step of h (s), with so much left (s) before it.

    Fixed steps are counted: the sum of a hundred thousand would be late by more than round-off.
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
    """Step on until one of the reasons above; at most `share` steps, for which the tables have room."""
    w = view(addresses)
    clock, control, counts = w.clock[0], w.control[0], w.counts[0]
    is_fixed = w.scheme[0].fixed
    for _ in range(share):
        keep(w)
        asked, left = next_step(w), control.end - clock.now
        h = fixed(asked, w) if is_fixed else chosen(asked, w)
        if h == 0.0:
            go_back(w)
            return FAILED
        if not step_error.fastest(flat(w.twist), w.lever) < control.away:
            return AWAY
        finish(w)
        tick(h, left, w)
        counts.steps += 1
        write(clock.now, w)
        clock.speed = step_error.begin(w.changes, h)
        clock.fastest = max(clock.fastest, clock.speed)
        why = is_over(w)
        if why != PAUSE:
            return why
    return PAUSE
