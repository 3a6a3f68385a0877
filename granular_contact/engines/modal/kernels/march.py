"""Time integration of the modal pendulum: steps, rows on a regular grid, and events inside each step.

A step is known as a polynomial C in theta = (t - t_0) / h (see `runge_kutta`); `events` locates events in it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from granular_contact.engines.modal.kernels.events import look_for_stop, regime_end, shorten
from granular_contact.engines.modal.kernels.modal import SIZE
from granular_contact.engines.modal.kernels.modal_calls import rates
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays, drag
from granular_contact.engines.modal.kernels.modal_motion import decide, follow
from granular_contact.engines.modal.kernels.runge_kutta import STAGES, error, inside, interpolant, step
from granular_contact.engines.modal.kernels.slip import middle, slip_velocity
from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.memory import clear, copy, piece, room1, room2
from granular_contact.jit.memory import rows as rows_of
from granular_contact.jit.records import fields, record_dtype

# Reasons for which `march` returns: its share of steps is done, the pendulum rests, the end time, no step is small
# enough, the static force reverses again and again.
PAUSE, REST, END, FAILED, CHATTERING = 0, 1, 2, 3, 4

CROWD = 50  # number of ends of regimes within `crowd` seconds that counts as chattering

# end (s): time to march to; longest, interval (s): longest step, and time between rows; reach (m): greatest distance
# of a point from the pivot; rest_speed (m/s), rest_time (s): see `rests`, infinite for never; crowd (s): see CROWD;
# blurred (m/s): upper bound of the speed that counts as none; forces: whether rows get the forces of the medium, which
# cost an evaluation each.
CONTROL = record_dtype(
    [
        *fields("f8", "end", "longest", "interval", "reach"),
        *fields("f8", "rest_speed", "rest_time", "crowd", "blurred"),
        ("forces", "?"),
    ]
)
# now: time reached (s); step: length (s) to try next; resting_since: time (s) since which everything rests; latest,
# ratio: length (s) of the latest step that the error allowed, 0 for none, and its error over the error allowed.
CLOCK = record_dtype(fields("f8", "now", "step", "resting_since", "latest", "ratio"))
SAFETY, FILTER, LEAST_RATIO, MOST_GROWTH = 0.93, 6.0, 1e-6, 5.0  # see `next_step`
# Numbers of steps accepted and rejected, of evaluations of the right-hand side, of rows written, of ends of regimes
# (turns), and of those of them since they last crowded.
COUNTS = record_dtype(fields("i8", "steps", "rejected", "rates", "rows", "turns", "crowded"))


class State(NamedTuple):
    """State of the solve of several pendulums, which are marched one after another.

    y (runs, size): see `modal_motion`; regime, stopped (runs, components): regime of the static law, and components
    that ended the last one; clock, counts, watch (runs,): records of CLOCK, COUNTS and `events.WATCH`; turns (runs,
    CROWD): times (s) of the latest ends of regimes, the k-th at k modulo CROWD; rows (runs, capacity, 1 + size + 9):
    tables of results. Kernels of a single run take its arrays without the first axis, but records with it, as arrays
    (1,).
    """

    y: Any
    regime: Any
    stopped: Any
    clock: Any
    counts: Any
    watch: Any
    turns: Any
    rows: Any


class Room(NamedTuple):
    """Work space: slopes (STAGES, size), a step as a polynomial (5, size), the state at its end (size,).

    pair: `runge_kutta.TSITOURAS`.
    """

    pair: Any
    slopes: Any
    path: Any
    end: Any


@kernel
def write_row(t, y, s, w, row):
    """Fill a row: time, state, forces of the medium (3, 3) as in `strips`."""
    fill_row(t, y, s, w, True, row)


@part
def fill_row(t, y, s, w, forces, row):
    """`write_row`; forces: whether to compute the forces of the medium, else their columns are left as they are."""
    m = w.pendulum[0].modes + 1
    row[0] = t
    size = y.shape[0]
    for i in range(size):
        row[1 + i] = y[i]
    if not forces:
        return
    dy, sigma, totals = rows_of(room1(SIZE), 0, 2 * m + 2), rows_of(room1(2), 0, s.shape[0]), room2(3, 3)
    clear(totals)
    clear(sigma)
    rates(y, s, w, sigma, totals, dy)
    for i in range(9):
        row[1 + size + i] = totals[i // 3, i % 3]


@part
def rows_of_a_step(control):
    """Upper bound of the rows that a step writes, and one more: a table with less room is full."""
    return int(control.longest / control.interval) + 2


@part
def finish(run, h, C, w, control):
    """Accept a step: write its rows, look for the stop, move the anchors."""
    t, rows, counts, watch = run.clock[0].now, run.rows, run.counts[0], run.watch[0]
    m = w.pendulum[0].modes + 1
    y = rows_of(room1(SIZE), 0, C.shape[1])
    due = counts.rows * control.interval
    while due <= t + h and counts.rows < rows.shape[0]:
        inside(C, (due - t) / h, y)
        fill_row(due, y, run.regime, w, control.forces, piece(rows, counts.rows, rows.shape[1]))
        counts.rows += 1
        due = counts.rows * control.interval
    if w.lines.shape[0] == 0:
        return
    inside(C, 1.0, y)
    if watch.touched == 0.0 and middle(rows_of(y, 0, m), w)[2]:
        watch.touched = 1.0
    if watch.touched != 0.0:
        look_for_stop(t, h, C, w, watch)
    if not w.pendulum[0].true_sign:
        drag(rows_of(y, 0, m), rows_of(y, m, m), w)


@part
def rests(run, w, control):
    """Whether all motion that the medium can stop has been slow for the time of rest.

    Bristles damp the whole link. The true sign holds only the middle of the immersed segment, about which the link may
    vibrate for ever; then only that point has to be slow.
    """
    m, y, clock = w.pendulum[0].modes + 1, run.y, run.clock[0]
    speed = abs(y[m]) * control.reach
    for i in range(m + 1, 2 * m):
        speed = max(speed, abs(y[i]))
    if speed > control.rest_speed and m > 1 and w.pendulum[0].true_sign:
        g = rows_of(room1(2), 0, run.regime.shape[0])
        if slip_velocity(rows_of(y, 0, m), rows_of(y, m, m), w, g):
            speed = max(abs(g[0]), abs(g[1]))
    if speed > control.rest_speed:
        clock.resting_since = clock.now
    return clock.now - clock.resting_since >= control.rest_time


@part
def turn(run, w, control):
    """Choose the next regime at the end of one; return False if regimes end again and again (chattering).

    Each time that the latest CROWD ends lie within `crowd`, the speed that counts as none is raised tenfold. The
    pendulum chatters once that speed exceeds `blurred`.
    """
    clock, counts, turns = run.clock[0], run.counts[0], run.turns
    turns[counts.crowded % CROWD] = clock.now
    counts.turns += 1
    counts.crowded += 1
    if counts.crowded > CROWD and clock.now - turns[counts.crowded % CROWD] < control.crowd:
        counts.crowded = 0
        w.pendulum[0].still *= 10.0
        if w.pendulum[0].still > control.blurred:
            return False
    decide(run.y, run.regime, run.stopped, w)
    return True


@part
def next_step(h, ratio, clock):
    """Length (s) of the step after a step h (s), by the filter H211b of Soderlind (2003).

    ratio: error of the step over the error allowed; the clock remembers h and ratio. The error of a vibrating link
    rises and falls four times a period. Steps that follow each fall are too long for the next rise: by the elementary
    controller every fifth step was rejected; the filter follows less.
    """
    if clock.latest > 0.0:
        change = (ratio * clock.ratio) ** (-0.2 / FILTER) * (h / clock.latest) ** (-1.0 / FILTER)
    else:
        change = ratio**-0.2
    clock.latest, clock.ratio = h, ratio
    return h * min(MOST_GROWTH, SAFETY * change)


@part
def attempt(run, w, control, allowed, room, sums):
    """Step from y, with slopes[0] = y' there, as far as the error allows; return the length (s), 0 for no step."""
    clock, counts = run.clock[0], run.counts[0]
    h = min(clock.step, control.longest, control.end - clock.now)
    while True:
        make_step(run, h, w, room, sums)
        ratio = error(room.pair, h, room.slopes, allowed)
        if ratio <= 1.0:
            clock.step = next_step(h, max(ratio, LEAST_RATIO), clock)
            return h
        counts.rejected += 1
        h *= max(0.2, 0.9 * ratio**-0.2) if ratio < np.inf else 0.1
        if h <= 1e-14 * control.end:
            return 0.0


@part
def make_step(run, h, w, room, sums):
    """Step from y over h (s): fill the slopes and the state at the end; sums: work space for signs and forces."""
    sigma, totals = sums
    step(room.pair, run.y, h, run.regime, w, room.slopes, sigma, totals, room.end)
    run.counts[0].rates += STAGES - 1


@part
def end_with_regime(run, h, w, room, sums):
    """End a step from y over h (s) where the regime ends, if it does; return its length, and theta of `regime_end`.

    The interpolant is less accurate than the step. So a new step to the end of the regime is made, and the end is
    located once more in it. If the end then lies just behind the step, the next step finds it near its own start, where
    its interpolant is exact.
    """
    if not w.pendulum[0].true_sign:
        return h, 2.0
    C = room.path
    theta = regime_end(C, run.regime, w, run.stopped)
    if theta > 1.0:
        return h, theta
    h *= theta
    make_step(run, h, w, room, sums)
    interpolant(room.pair, run.y, h, room.slopes, C)
    theta = regime_end(C, run.regime, w, run.stopped)
    if theta <= 1.0:
        h *= theta
        shorten(C, theta)
        inside(C, 1.0, room.end)
    return h, theta


@part
def march_one(share, run, w, control, allowed, room):
    """March one run, for at most `share` steps; return the code of the reason to return.

    run: State of the one run; control: record of CONTROL; allowed: allowed error of each coordinate and rate in a step.
    All arguments are updated.
    """
    sigma, totals = rows_of(room1(2), 0, run.regime.shape[0]), room2(3, 3)
    sums, first = (sigma, totals), piece(room.slopes, 0, room.slopes.shape[1])
    known = False  # whether slopes[0] is y' at y
    for _ in range(share):
        if run.counts[0].rows + rows_of_a_step(control) > run.rows.shape[0]:
            return PAUSE
        if w.pendulum[0].true_sign and follow(run.y, run.regime, w):
            known = False
        if not known:
            rates(run.y, run.regime, w, sigma, totals, first)
            run.counts[0].rates += 1
        h = attempt(run, w, control, allowed, room, sums)
        if h == 0.0:
            return FAILED
        interpolant(room.pair, run.y, h, room.slopes, room.path)
        h, theta = end_with_regime(run, h, w, room, sums)
        finish(run, h, room.path, w, control)
        copy(run.y, room.end)
        run.clock[0].now += h
        run.counts[0].steps += 1
        known = theta > 1.0
        if not known:
            if not turn(run, w, control):
                return CHATTERING
            continue
        # The last slope is y' at the end of the step: moving the anchors does not change the forces of bristles.
        copy(first, piece(room.slopes, STAGES - 1, room.slopes.shape[1]))
        if rests(run, w, control):
            return REST
        if run.clock[0].now >= control.end * (1.0 - 1e-14):
            return END
    return PAUSE


@kernel(nogil=True)
def march(share, codes, state, stacked, control, allowed, room):
    """March all runs whose code is PAUSE, each by at most `share` steps; set codes (runs,) to their reasons to return.

    Other threads of Python go on meanwhile. state: State of the runs; stacked: `modal_load.PendulumArrays` with a
    leading axis of runs in all arrays but `starts` and `room`; control (runs,), allowed (runs, coordinates and rates);
    room: Room.
    """
    for i in range(codes.shape[0]):
        if codes[i] != PAUSE:
            continue
        run, w = state_of_run(state, i), arrays_of_run(stacked, i)
        codes[i] = march_one(share, run, w, control[i], piece(allowed, i, allowed.shape[1]), room)


@part
def state_of_run(state, i):
    """State of the i-th run."""
    parts = state.regime.shape[1]
    return State(
        piece(state.y, i, state.y.shape[1]), piece(state.regime, i, parts), piece(state.stopped, i, parts),
        rows_of(state.clock, i, 1), rows_of(state.counts, i, 1), rows_of(state.watch, i, 1),
        piece(state.turns, i, CROWD), piece(state.rows, i, state.rows.shape[1]),
    )  # fmt: skip


@part
def arrays_of_run(w, i):
    """PendulumArrays of the i-th run."""
    stations = w.geometry.shape[1]
    return PendulumArrays(
        rows_of(w.pendulum, i, 1), piece(w.geometry, i, stations), w.starts,
        piece(w.lines, i, w.lines.shape[1]), piece(w.profile, i, w.profile.shape[1]), rows_of(w.medium, i, 1),
        piece(w.anchors, i, stations), w.room,
    )  # fmt: skip
