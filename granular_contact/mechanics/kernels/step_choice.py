"""Step-size control: length of the next step from the error of the last one; derivation in `mechanics.stepping`.

Arguments that the functions share:

    choice       record of CHOICE
    top_speed    greatest speed since the start of the run (m/s)
    start_speed  greatest speed at the start of the step (m/s)
    prescribed   Prescribed
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.records import fields, record_dtype
from granular_contact.mechanics.kernels.signal_tables import look_up
from granular_contact.mechanics.kernels.step_error import measure

SAFETY, GREATEST_FACTOR, LEAST_FACTOR = 0.85, 2.0, 0.2
# A step within these factors of the last one uses its Jacobian. The step is not lengthened by less than LONGER, except
# to the longest one: without that exception a smooth motion took up to a quarter more steps, also at a looser accuracy.
SHORTER, LONGER = 0.8, 1.25
# Ratio of a step to the one that its error allows, above which it is halved before Newton's method converges. It saves
# robots 3 to 17 % of their iterations, as a third to a half of the refused steps take most of theirs after this point.
TOO_LONG = 1.5
SLOWED = 4.0
ROLLING = 6.0
STEPS_BETWEEN_BENDS = 8  # at least
SAME_INSTANT = 1e-10  # s, difference of two times that count as the same

# excess: |beta - 1/6|, by how much the scheme differs from an acceleration that varies linearly over a step; both: rate
# of the error of positions, over the change of the acceleration and the step; longest, least (s): steps; size (m): of
# the mechanism; rolls: whether it may roll on in space.
CHOICE = record_dtype([*fields("f8", "accuracy", "excess", "both", "longest", "least", "size"), ("rolls", "i8")])


class Prescribed(NamedTuple):
    """Signals of drives, as far as steps depend on them.

    bends (n,): times (s) at which signals bend; followed (k,): indices of the signals of prescribed motions in the
    tables; arms (k,): factors from their values to lengths (m); knots, pieces: the tables, see `signal_tables`; signals
    (signals,): records of SIGNAL to work in.
    """

    bends: Any
    followed: Any
    arms: Any
    knots: Any
    pieces: Any
    signals: Any


@part
def needed(addresses, step, choice, top_speed, start_speed):
    """Ratio of a step (s) to the step that just meets the accuracy; infinite where accelerations are not finite.

    addresses: see `step_error`.
    """
    speed, jump, whole, greatest = measure(addresses, step)
    speed = max(speed, start_speed)
    top_speed = max(speed, top_speed)
    drift = step * (choice.excess * greatest + whole / 12.0) / top_speed
    slow = step * choice.both * whole / max(speed, top_speed / SLOWED)
    if choice.rolls and speed < 0.5 * top_speed:
        slow *= ROLLING
    kick = 0.5 * step * jump * min(1.0, 2.0 * speed / top_speed) / top_speed
    need = max(math.sqrt(max(drift, slow) / choice.accuracy), kick / choice.accuracy)
    return need if need < math.inf else math.inf


@part
def factor(need):
    """Ratio of the next step to the last one, which was `need` times too long."""
    return min(GREATEST_FACTOR, max(LEAST_FACTOR, SAFETY / max(need, 1e-6)))


@part
def limit_prescribed_change(t, step, choice, top_speed, start_speed, prescribed):
    """Halve a step (s) from t (s) until the accelerations of prescribed motions change little enough within it.

    This is done before the step is tried. A refused step across a bend of a prescribed motion would leave its error to
    the shorter steps after it: the prescribed positions are reached in one step, by a force that grows as steps shrink.
    """
    _, followed, arms, knots, pieces, signals = prescribed
    jump = 2.0 * SAFETY * choice.accuracy * top_speed  # half of it is an error of the velocity
    smooth = SAFETY**2 * choice.accuracy * max(start_speed, top_speed / SLOWED) / choice.both
    allowed = min(jump, smooth)
    for i in range(followed.shape[0]):
        k = followed[i]
        look_up(t, knots, pieces, signals)
        before = signals[k].acceleration
        while step > choice.least:
            change = 0.0
            for quarter in range(1, 5):
                look_up(t + 0.25 * quarter * step, knots, pieces, signals)
                change = max(change, abs(signals[k].acceleration - before))
            if arms[i] * change * step <= allowed:
                break
            step *= 0.5
    return step


@part
def until_bend(t, bends):
    """Time (s) from t to the next bend of a drive's signal, at most a share of the time between the bends around t."""
    for i in range(bends.shape[0]):
        if bends[i] > t + SAME_INSTANT:
            left = bends[i] - t
            return left if i == 0 else min(left, (bends[i] - bends[i - 1]) / STEPS_BETWEEN_BENDS)
    return math.inf


@part
def limit_step(t, step, soonest, choice, top_speed, start_speed, prescribed):
    """Shorten a step (s) from t (s) to end at the next bend of a signal or touch of the medium, whichever is sooner.

    soonest: time (s) until a part above the surface may touch it. Shorter times than accuracy size / top_speed do not
    count: within those nothing gets deeper than accuracy times size.
    """
    touch = max(choice.accuracy * choice.size / top_speed, soonest)
    step = min(step, touch, until_bend(t, prescribed.bends))
    return max(limit_prescribed_change(t, step, choice, top_speed, start_speed, prescribed), choice.least)


@kernel
def judge(addresses, step, choice, top_speed, start_speed):
    """Results of `needed` and `factor`, for callers in Python; choice (1,)."""
    need = needed(addresses, step, choice[0], top_speed, start_speed)
    return need, factor(need)


@kernel
def choose(t, step, soonest, choice, top_speed, start_speed, prescribed):
    """Result of `limit_step`, for callers in Python; choice (1,)."""
    return limit_step(t, step, soonest, choice[0], top_speed, start_speed, prescribed)
