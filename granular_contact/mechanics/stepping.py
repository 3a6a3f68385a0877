"""Step-size control of generalised-alpha by an estimate of the local error (after Zienkiewicz and Xie 1991).

Order 2 for smooth motion, 1 at jumps of the force; cost: one pass over the accelerations of a step. Limits: the
estimate holds for small steps (`COARSE`), and knows of a jump only after the step that it came in.

All the scheme knows of a step h is the acceleration at its ends, a_0 and a_1. Let V be the greatest speed so far.

Smooth motion. The scheme lets a vary over the step as its coefficient beta says; were it to vary linearly, beta would
be 1/6. So positions are off by |beta - 1/6| h^2 |a_1 - a_0| (Zienkiewicz and Xie, 1991). Velocities are off by
h^3 a''/12, which adds up over the steps to h^2 a'/12 = h |a_1 - a_0| / 12. The speed with which both put positions off
is held below accuracy v with the speed v, or accuracy V / SLOWED where that is more: positions are then off by no more
than about `accuracy` times the path length. With V in place of v a body that goes on turning or sliding slowly after
its impact would keep, all that time, an error that is small beside the speed of the impact only.

Jumps of the force (a flat touch, a bristle that is stretched in 5 us). When in the step it came is not known, and the
scheme gives it half of the step: velocities are off by up to h |J| / 2. J is what the change a_1 - a_0 has of the
unexpected: itself or what differs from the change before, whichever is less. Such a velocity error acts for as long as
the motion lasts, about v / a, which for a motion that ends is V / 2 v times less than at its start. It is held below
accuracy V, times that factor; then the step goes down as the accuracy.

Bodies in space that nothing drives may roll on after their impact, on one facet after another. The force goes up and
down with each facet, and what a step does wrong with that does not cancel from facet to facet: the sand then takes too
little energy at each of them. A ball was off by up to four times what is promised, and by 2 to 4 times less at half the
step. So once they have slowed down to half of the greatest speed, the change counts ROLLING times as much [measured,
not derived].

Trees in space that fly free and that nothing drives topple over as they come to rest, and multiply what steps have left
by then: three of sixty random ones were off by 1.3 to 1.9 times what is promised. They are solved as if a TOPPLING-th
of the accuracy were asked [measured, not derived].

Vibration that moves nothing visibly does not count: of a flexible link velocities are the means over its nodes.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.scene.signal_tables import corners, shortest_period
from granular_contact.scene.signals import Signal
from granular_contact.scene.types import Scene, Vector

END = 1e-10  # s, within which the engine takes an end for reached
NO_TABLE = np.array([0.0, 1.0]), np.zeros((0, 1, 6))
MOST_STEPS = 20  # times the steps of the run, and some: with so many it does not get on
MOST_CHOSEN = 200_000  # steps more, where they are chosen
LONGEST = 0.05  # of the run, and of the swing of a pendulum as long as the mechanism, over 2 pi
OF_A_PERIOD = 8  # steps at least in the shortest period of a drive's signal, which others may pass by
FINE, LONGER = 1e-2, 2.0  # accuracy up to which that holds, and how much longer a step may be at a coarser one
# Estimates hold for small steps: how much more an error may be, over the accuracy; of a free body that nothing drives,
# which may tumble on after its impact, and in space; and of all else.
COARSE_TUMBLING, COARSE = 100.0, 5.0
TOPPLING = 2.5  # share of the accuracy that is taken of such trees
SLOWEST = 0.02  # of the speed that such a swing has; below it what starts from rest counts as moving so fast


class Choice(NamedTuple):
    """What chooses the steps of a scene, as `kernels.step_choice` takes it.

    record (1,): of CHOICE; speed (m/s): the least that counts as the greatest so far; bends (s): of all signals;
    followed, arms: see there, of `signals_of`.
    """

    record: NDArray[np.void]
    speed: float
    bends: Vector
    followed: NDArray[np.int64]
    arms: Vector


def choice(scene: Scene, accuracy: float) -> Choice:
    """What chooses the steps of a scene for an accuracy; `learn` completes it."""
    from granular_contact.mechanics.kernels.step_choice import CHOICE  # here, as fixed steps without sand need no numba

    record, size = np.zeros(1, CHOICE), max(scene.length, 1e-3)
    record["accuracy"] = accuracy / TOPPLING if _topples(scene) else accuracy
    record["size"], record["longest"] = size, longest_step(scene, accuracy)
    record["rolls"] = scene.in_space and not scene.drives
    ways = {joint.name: 1.0 if joint.kind == "slider" else arm(scene, joint) for joint in scene.joints}
    arms: dict[Signal, float] = {}  # a signal that several follow is looked at once, by the longest arm
    for drive in scene.drives:
        if drive.kind == "motion":
            arms[drive.signal] = max(ways[drive.joint], arms.get(drive.signal, 0.0))
    places = [signals_of(scene).index(signal) for signal in arms]
    bent = np.array(corners(drive.signal for drive in scene.drives))
    speed = max(scene.speed, SLOWEST * size / _swing(scene))
    return Choice(record, speed, bent, np.array(places, np.int64), np.array([*arms.values()]))


def _topples(scene: Scene) -> bool:
    """Whether a scene is a tree of several bodies in space that flies free, and that nothing drives."""
    moving = sum(joint.kind != "weld" for joint in scene.joints)
    return scene.in_space and scene.floating is not None and not scene.drives and moving > 1


def arm(scene: Scene, joint: Any) -> float:
    """How far (m) what a hinge turns reaches from it at the start: the lesser of its two sides, which moves more."""
    size = max(scene.length, 1e-3)
    if scene.bends or any(one.closes for one in scene.joints):
        return size
    carried, reaches = scene.carried(joint), {True: 0.0, False: 0.0}
    at = scene.body(joint.child).motion.world(joint.child_point)
    for body in scene.rigid:
        far = float(np.linalg.norm(body.motion.position - at)) + scene.radius(body)
        reaches[body.name in carried] = max(reaches[body.name in carried], far)
    return min(size, reaches[True], reaches[False] or size)


def longest_step(scene: Scene, accuracy: float) -> float:
    """Longest step (s) that is chosen for an accuracy."""
    longer = min(LONGER, math.sqrt(max(1.0, accuracy / FINE)))
    longest = LONGEST * longer * min(scene.solver.end_time_s, _swing(scene))
    if scene.rest_time is not None:
        longest = min(longest, 0.5 * scene.rest_time)
    return min(longest, _within_periods(scene, accuracy))


def usual_step(scene: Scene) -> float:
    """Step (s) of which the shortest one is a share: that of the config, or less where a drive's signal asks for it."""
    step, accuracy = scene.solver.step_s, scene.solver.accuracy
    return step if accuracy is None else min(step, _within_periods(scene, accuracy))


def _within_periods(scene: Scene, accuracy: float) -> float:
    """Longest step (s) by the shortest period of the signals of drives.

    A step adds up forces by the trapezoidal rule, which with n steps a period leaves the impulse of half a sine wrong
    by (2 pi / n)^2 / 12 of it; a body at rest keeps that as a speed. Prescribed motions add up nothing.
    """
    end, fine = scene.solver.end_time_s, max(OF_A_PERIOD, math.pi / math.sqrt(3.0 * accuracy))
    each = (
        shortest_period(drive.signal, end) / (OF_A_PERIOD if drive.kind == "motion" else fine) for drive in scene.drives
    )
    return min(each, default=math.inf)


def _swing(scene: Scene) -> float:
    """Time (s) over 2 pi of a swing of a pendulum as long as the mechanism."""
    return math.sqrt(max(scene.length, 1e-3) / max(abs(scene.gravity), 0.1))


def learn(record: NDArray[np.void], scene: Scene, beta: float, least: float) -> None:
    """Complete the choice of steps of a scene by the coefficient beta of its scheme, and the shortest step (s)."""
    tumbles = scene.floating is not None and not scene.drives
    coarse = COARSE_TUMBLING if tumbles or (scene.in_space and not scene.drives) else COARSE
    record["least"], record["excess"] = least, abs(beta - 1.0 / 6.0)
    record["both"] = (1.0 + coarse * record["accuracy"]) * (record["excess"] + 1.0 / 12.0)


def signals_of(scene: Scene) -> list[Signal]:
    """Signals of drives, each once."""
    return list(dict.fromkeys(drive.signal for drive in scene.drives if not drive.sets))


def most_steps(scene: Scene) -> int:
    """Steps after which a run is given up."""
    end, accuracy = scene.solver.end_time_s, scene.solver.accuracy
    if accuracy is None:
        return MOST_STEPS * math.ceil(end / scene.solver.step_s) + 1000
    return MOST_CHOSEN + MOST_STEPS * math.ceil(end / longest_step(scene, accuracy))
