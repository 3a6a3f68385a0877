"""Step-size control: length of the next step by the error of the last; derivation in `mechanics.stepping`.

Arguments that the functions share:

    choice       record of CHOICE
    fastest, now  greatest speed so far, and that at the start of the step (m/s)
    prescribed   Prescribed
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from granular_contact.jit.compiled import kernel, part
from granular_contact.jit.records import fields, record_dtype
from granular_contact.mechanics.kernels.signal_tables import look_up
from granular_contact.mechanics.kernels.step_error import measure

SAFETY, MOST, LEAST = 0.85, 2.0, 0.2
# Within these factors of the last step its Jacobian serves, and no longer one is taken, but the longest: held below
# that for good, a smooth motion took up to a quarter more steps, with a looser accuracy too.
SHORTER, LONGER = 0.8, 1.25
SLOWED = 4.0
ROLLING = 6.0
BETWEEN = 8  # steps between two bends, at the least
AT = 1e-10  # s, within which an instant is reached

# excess: coefficient of the scheme, apart from that of an acceleration that varies linearly over a step; both: speed
# with which a change of the acceleration puts positions off, over that change and the step; longest, least (s); size
# (m) of the mechanism; rolls: whether it may roll on in space.
CHOICE = record_dtype([*fields("f8", "accuracy", "excess", "both", "longest", "least", "size"), ("rolls", "i8")])


class Prescribed(NamedTuple):
    """What drives ask of steps.

    bends (n,): times (s) at which signals bend; followed (k,): signals of prescribed motions among those of
    `signal_tables`, arms (k,): what makes their values lengths (m); knots, pieces: the tables of signals; signals
    (signals,): records of SIGNAL, room to look them up in.
    """

    bends: Any
    followed: Any
    arms: Any
    knots: Any
    pieces: Any
    signals: Any


@part
def needed(addresses, step, choice, fastest, now):
    """How many times longer a step (s) was than it should be; infinite where that is not known.

    addresses: see `step_error`.
    """
    speed, jump, whole, most = measure(addresses, step)
    speed = max(speed, now)
    fastest = max(speed, fastest)
    drift = step * (choice.excess * most + whole / 12.0) / fastest
    slow = step * choice.both * whole / max(speed, fastest / SLOWED)
    if choice.rolls and speed < 0.5 * fastest:
        slow *= ROLLING
    kick = 0.5 * step * jump * min(1.0, 2.0 * speed / fastest) / fastest
    need = max(math.sqrt(max(drift, slow) / choice.accuracy), kick / choice.accuracy)
    return need if need < math.inf else math.inf


@part
def factor(need):
    """Of the next step to one that was so many times too long."""
    return min(MOST, max(LEAST, SAFETY / max(need, 1e-6)))


@part
def foreseen(t, step, choice, fastest, now, prescribed):
    """A step (s) from t (s), or a shorter one that what is prescribed does not change its acceleration too much in.

    A step that came to a bend of a prescribed motion and were refused would leave its error to the next ones: what
    positions ask for they make up for in one step, with a force that grows as steps shrink.
    """
    _, followed, arms, knots, pieces, signals = prescribed
    jump = 2.0 * SAFETY * choice.accuracy * fastest  # half of it acts
    smooth = SAFETY**2 * choice.accuracy * max(now, fastest / SLOWED) / choice.both
    most = min(jump, smooth)
    for i in range(followed.shape[0]):
        k = followed[i]
        look_up(t, knots, pieces, signals)
        before = signals[k].acceleration
        while step > choice.least:
            change = 0.0
            for quarter in range(1, 5):
                look_up(t + 0.25 * quarter * step, knots, pieces, signals)
                change = max(change, abs(signals[k].acceleration - before))
            if arms[i] * change * step <= most:
                break
            step *= 0.5
    return step


@part
def until_bend(t, bends):
    """Time (s) from t until the next bend of a drive's signal, or a share of the time between two of them."""
    for i in range(bends.shape[0]):
        if bends[i] > t + AT:
            left = bends[i] - t
            return left if i == 0 else min(left, (bends[i] - bends[i - 1]) / BETWEEN)
    return math.inf


@part
def ahead(t, step, soonest, choice, fastest, now, prescribed):
    """A step (s) from t (s), or a shorter one that ends at a bend or where something may touch the medium.

    soonest: time (s) until something above the surface may be in it. At least as long as the deepest it can get in
    that time does not matter.
    """
    touch = max(choice.accuracy * choice.size / fastest, soonest)
    step = min(step, touch, until_bend(t, prescribed.bends))
    return max(foreseen(t, step, choice, fastest, now, prescribed), choice.least)


@kernel
def judge(addresses, step, choice, fastest, now):
    """`needed` and `factor`, for callers in Python; choice (1,)."""
    need = needed(addresses, step, choice[0], fastest, now)
    return need, factor(need)


@kernel
def choose(t, step, soonest, choice, fastest, now, prescribed):
    """`ahead`, for callers in Python; choice (1,)."""
    return ahead(t, step, soonest, choice[0], fastest, now, prescribed)
