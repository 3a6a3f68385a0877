"""Step-size control of generalised-alpha by an estimate of the local error (after Zienkiewicz and Xie 1991).

Order 2 for smooth motion, 1 at jumps of the force; cost: one pass over the accelerations of a step. Limits: the
estimate holds for small steps (`COARSE`), and it sees a jump only after the step in which the jump occurred.

The estimate uses the accelerations a_0 and a_1 at the ends of a step h, and the greatest speed V since the start.

Smooth motion. The scheme's coefficient beta says how a varies over the step; beta = 1/6 would mean linearly. So
positions are off by |beta - 1/6| h^2 |a_1 - a_0| (Zienkiewicz and Xie, 1991). Velocities are off by h^3 a''/12, which
adds up over the steps to h^2 a'/12 = h |a_1 - a_0| / 12. The rate at which the two errors move positions is held below
accuracy v at the speed v, or below accuracy V / SLOWED where that is more. Positions are then off by at most about
`accuracy` times the path length. With V in place of v, the error of a body that turns or slides on slowly after its
impact would be small beside the speed of the impact, but not beside its own speed.

Jumps of the force (a flat touch, a bristle that is stretched in 5 us). The instant of a jump within the step is not
known, and the scheme lets it act for half of the step: velocities are off by up to h |J| / 2. J is the unexpected part
of the change a_1 - a_0: the change, or its difference from that of the step before, whichever is smaller. The error of
the velocity acts for as long as the motion lasts, about v / a; for a motion that comes to an end this is V / 2 v times
shorter than at the start. The error is held below accuracy V times this factor, so the step is proportional to the
accuracy.

Bodies in space without drives may roll on after their impact, from facet to facet. The force rises and falls with each
facet, and its errors do not cancel from facet to facet: the sand takes too little energy at each of them. A ball had up
to four times the promised error, and 2 to 4 times less at half the step. So once the speed is below half of the
greatest speed, the change counts ROLLING times [measured, not derived].

Free-flying trees in space without drives topple over as they come to rest, which amplifies the error up to then: three
of sixty random trees had 1.3 to 1.9 times the promised error. They are solved with the accuracy divided by TOPPLING
[measured, not derived].

Vibration without visible motion does not count: for a flexible link the means over its nodes are compared.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.scene.signal_tables import corners, shortest_period
from granular_contact.scene.signals import Signal
from granular_contact.scene.types import Scene, Vector

END = 1e-10  # s, within which an end of the engine counts as reached
NO_TABLE = np.array([0.0, 1.0]), np.zeros((0, 1, 6))
MOST_STEPS = 20  # times the expected number of steps, after which a run is given up
MOST_CHOSEN = 200_000  # steps allowed beyond that, with step-size control
LONGEST = 0.05  # step over the run, and over the period / 2 pi of a pendulum as long as the mechanism
PERIOD_STEPS = 8  # at least, in the shortest period of a drive's signal; longer steps would miss it
FINE, LONGER = 1e-2, 2.0  # accuracy up to which LONGEST holds, and factor of the longest step at coarser ones
# The estimate holds for small steps. The true error is assumed to be (1 + COARSE accuracy) times the estimate, with
# COARSE_TUMBLING for bodies without drives that fly free or are in space: they may tumble on after their impact.
COARSE_TUMBLING, COARSE = 100.0, 5.0
TOPPLING = 2.5  # divisor of the accuracy of free-flying trees in space without drives
SLOWEST = 0.02  # of the speed of such a pendulum: least value of V, for motions that start from rest


class Choice(NamedTuple):
    """Settings of step-size control for a scene, as `kernels.step_choice` takes them.

    record (1,): of CHOICE; speed (m/s): least value of the greatest speed; bends (s): of all signals; followed, arms:
    of `kernels.step_choice.Prescribed`, with the signals of `signals_of`.
    """

    record: NDArray[np.void]
    speed: float
    bends: Vector
    followed: NDArray[np.int64]
    arms: Vector


def choice(scene: Scene, accuracy: float) -> Choice:
    """Settings of step-size control for a scene and an accuracy; `learn` completes the record."""
    from granular_contact.mechanics.kernels.step_choice import CHOICE  # here, as fixed steps without sand need no numba

    record, size = np.zeros(1, CHOICE), max(scene.length, 1e-3)
    record["accuracy"] = accuracy / TOPPLING if _topples(scene) else accuracy
    record["size"], record["longest"] = size, longest_step(scene, accuracy)
    record["rolls"] = scene.in_space and not scene.drives
    lengths = {joint.name: 1.0 if joint.kind == "slider" else arm(scene, joint) for joint in scene.joints}
    arms: dict[Signal, float] = {}  # a signal that several joints follow is evaluated once, with the longest arm
    for drive in scene.drives:
        if drive.kind == "motion":
            arms[drive.signal] = max(lengths[drive.joint], arms.get(drive.signal, 0.0))
    followed = [signals_of(scene).index(signal) for signal in arms]
    bends = np.array(corners(drive.signal for drive in scene.drives))
    speed = max(scene.speed, SLOWEST * size / _pendulum_time(scene))
    return Choice(record, speed, bends, np.array(followed, np.int64), np.array([*arms.values()]))


def _topples(scene: Scene) -> bool:
    """Return whether a scene is a free-flying tree of several bodies in space without drives."""
    moving = sum(joint.kind != "weld" for joint in scene.joints)
    return scene.in_space and scene.floating is not None and not scene.drives and moving > 1


def arm(scene: Scene, joint: Any) -> float:
    """Lever arm (m) of a hinge at the start: greatest distance from it on its smaller side, which moves more."""
    size = max(scene.length, 1e-3)
    if scene.bends or any(other.closes for other in scene.joints):
        return size
    carried, reaches = scene.carried(joint), {True: 0.0, False: 0.0}
    hinge = scene.body(joint.child).motion.world(joint.child_point)
    for body in scene.rigid:
        reach = float(np.linalg.norm(body.motion.position - hinge)) + scene.radius(body)
        reaches[body.name in carried] = max(reaches[body.name in carried], reach)
    return min(size, reaches[True], reaches[False] or size)


def longest_step(scene: Scene, accuracy: float) -> float:
    """Longest step (s) of step-size control at an accuracy."""
    longer = min(LONGER, math.sqrt(max(1.0, accuracy / FINE)))
    longest = LONGEST * longer * min(scene.solver.end_time_s, _pendulum_time(scene))
    if scene.rest_time is not None:
        longest = min(longest, 0.5 * scene.rest_time)
    return min(longest, _within_periods(scene, accuracy))


def usual_step(scene: Scene) -> float:
    """Reference (s) of the shortest step: the config's step, or a shorter one that resolves the drives' signals."""
    step, accuracy = scene.solver.step_s, scene.solver.accuracy
    return step if accuracy is None else min(step, _within_periods(scene, accuracy))


def _within_periods(scene: Scene, accuracy: float) -> float:
    """Longest step (s) that resolves the shortest period of the drives' signals.

    Steps integrate forces by the trapezoidal rule. With n steps a period the relative error of the impulse of half a
    sine is (2 pi / n)^2 / 12; a body that was at rest keeps it as a speed. Prescribed motions are not integrated.
    """
    end, fine = scene.solver.end_time_s, max(PERIOD_STEPS, math.pi / math.sqrt(3.0 * accuracy))
    longest = (
        shortest_period(drive.signal, end) / (PERIOD_STEPS if drive.kind == "motion" else fine)
        for drive in scene.drives
    )
    return min(longest, default=math.inf)


def _pendulum_time(scene: Scene) -> float:
    """Period over 2 pi (s) of a pendulum as long as the mechanism."""
    return math.sqrt(max(scene.length, 1e-3) / max(abs(scene.gravity), 0.1))


def learn(record: NDArray[np.void], scene: Scene, beta: float, least: float) -> None:
    """Complete the settings of step-size control with the coefficient beta of the scheme and the shortest step (s)."""
    tumbles = scene.floating is not None and not scene.drives
    coarse = COARSE_TUMBLING if tumbles or (scene.in_space and not scene.drives) else COARSE
    record["least"], record["excess"] = least, abs(beta - 1.0 / 6.0)
    record["both"] = (1.0 + coarse * record["accuracy"]) * (record["excess"] + 1.0 / 12.0)


def signals_of(scene: Scene) -> list[Signal]:
    """Signals of drives, each once, without drives that are set from outside."""
    return list(dict.fromkeys(drive.signal for drive in scene.drives if not drive.sets))


def most_steps(scene: Scene) -> int:
    """Number of steps after which a run is given up."""
    end, accuracy = scene.solver.end_time_s, scene.solver.accuracy
    if accuracy is None:
        return MOST_STEPS * math.ceil(end / scene.solver.step_s) + 1000
    return MOST_CHOSEN + MOST_STEPS * math.ceil(end / longest_step(scene, accuracy))
