"""Steps chosen by an estimate of their error, for a generalised-alpha solve under way.

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

Vibration that moves nothing visibly does not count: of a flexible link velocities are the means over its nodes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.multibody.system import System
from granular_contact.scene.signal_tables import tabulate
from granular_contact.scene.signals import Signal, corners, shortest_period
from granular_contact.scene.types import Scene, Vector

if TYPE_CHECKING:
    from granular_contact.multibody.views import Views

# What of a control its future depends on, and arrays of it.
KEPT = ("speed", "next", "last", "chosen", "begun", "now", "refused")
OF_STEP = "start", "change", "slope"
END = 1e-10  # s, within which the engine takes an end for reached
NO_TABLE = np.array([0.0, 1.0]), np.zeros((0, 1, 6))
NO_ERROR = [0.0, -1.0]  # as the engine takes a step for good
REFUSED = 2.0  # what the engine takes for a step to be repeated: above its tolerance of 1
# The shortest step that a failing Newton iteration or the control of the error may come down to, of step_s.
SHORTEST = 1e-4
SHORT = 2e-4  # s, of fixed steps; longer ones leave more of the motion, and Newton's method may do so too
LONGEST = 0.05  # of the run, and of the swing of a pendulum as long as the mechanism, over 2 pi
OF_A_PERIOD = 8  # steps at least in the shortest period of a drive's signal, which others may pass by
FINE, LONGER = 1e-2, 2.0  # accuracy up to which that holds, and how much longer a step may be at a coarser one
# Estimates hold for small steps: how much more an error may be, over the accuracy; of a free body that nothing drives,
# which may tumble on after its impact, and in space; and of all else.
COARSE_TUMBLING, COARSE = 100.0, 5.0
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
    from granular_contact.kernels.step_choice import CHOICE  # here, as fixed steps without sand need no numba

    record, size = np.zeros(1, CHOICE), max(scene.length, 1e-3)
    record["accuracy"], record["size"], record["longest"] = accuracy, size, longest_step(scene, accuracy)
    record["rolls"] = scene.in_space and not scene.drives
    ways = {joint.name: 1.0 if joint.kind == "slider" else size for joint in scene.joints}
    arms: dict[Signal, float] = {}  # a signal that several follow is looked at once, by the longest arm
    for drive in scene.drives:
        if drive.kind == "motion":
            arms[drive.signal] = max(ways[drive.joint], arms.get(drive.signal, 0.0))
    places = [signals_of(scene).index(signal) for signal in arms]
    bent = np.array(corners(drive.signal for drive in scene.drives))
    speed = max(scene.speed, SLOWEST * size / _swing(scene))
    return Choice(record, speed, bent, np.array(places, np.int64), np.array([*arms.values()]))


def longest_step(scene: Scene, accuracy: float) -> float:
    """Longest step (s) that is chosen for an accuracy."""
    solver = scene.solver
    longer = min(LONGER, math.sqrt(max(1.0, accuracy / FINE)))
    longest = LONGEST * longer * min(solver.end_time_s, _swing(scene))
    if solver.rest_time_s is not None:
        longest = min(longest, 0.5 * solver.rest_time_s)
    return min(longest, _shortest_period(scene) / OF_A_PERIOD)


def usual_step(scene: Scene) -> float:
    """Step (s) of which the shortest one is a share: that of the config, or less where a drive's signal asks for it."""
    step = scene.solver.step_s
    return step if scene.solver.accuracy is None else min(step, _shortest_period(scene) / OF_A_PERIOD)


def _shortest_period(scene: Scene) -> float:
    """Shortest period (s) of the signals of drives."""
    end = scene.solver.end_time_s
    return min((shortest_period(drive.signal, end) for drive in scene.drives), default=math.inf)


def _swing(scene: Scene) -> float:
    """Time (s) over 2 pi of a swing of a pendulum as long as the mechanism."""
    return math.sqrt(max(scene.length, 1e-3) / max(abs(scene.gravity), 0.1))


def learn(record: NDArray[np.void], scene: Scene, beta: float, least: float) -> None:
    """Complete the choice of steps of a scene by the coefficient beta of its scheme, and the shortest step (s)."""
    tumbles = scene.floating is not None and not scene.drives
    coarse = COARSE_TUMBLING if tumbles or scene.in_space else COARSE
    record["least"], record["excess"] = least, abs(beta - 1.0 / 6.0)
    record["both"] = (1.0 + coarse * record["accuracy"]) * (record["excess"] + 1.0 / 12.0)


def signals_of(scene: Scene) -> list[Signal]:
    """Signals of drives, each once."""
    return list(dict.fromkeys(drive.signal for drive in scene.drives if not drive.sets))


class StepControl:
    """Post-Newton function that refuses steps, and the choice of the next one; `refused` counts.

    lever (m,): factors from coordinate rates to speeds (m/s). sets: whether it can set steps; else it refuses those
    whose error is too large, and the engine lengthens them.
    """

    def __init__(self, system: System, solver: Any, lever: Vector, accuracy: float, *, sets: bool = True) -> None:
        from granular_contact.kernels import step_choice, step_error  # here, see `choice`
        from granular_contact.kernels.compiled import ready
        from granular_contact.kernels.lending import places

        scene = system.scene
        self.system, self.solver, self.lever, self.sets = system, solver, lever, sets
        self._record, self.speed, *follows = choice(scene, accuracy)
        self.longest = float(self._record["longest"][0])
        self.next = min(scene.solver.step_s, self.longest)
        self.group, means = _groups(system, len(lever))
        # Accelerations at the start of the step, how they have changed, and by the time in the step before.
        self.start, self.change, self.slope = np.zeros((3, len(lever)))
        self._arrays = self.lever, self.group, self.start, self.change, self.slope, np.zeros((means, 3))
        self._words, self._places = np.zeros(0, np.int64), places
        signals = signals_of(scene) if len(follows[1]) else []
        tables = tabulate(signals, scene.solver.end_time_s) if signals else NO_TABLE
        self._follows = *follows, *tables, np.zeros((len(signals), 3))
        self._judge = ready(step_choice.judge, self._words, 1.0, self._record, 1.0, 1.0)
        self._choose = ready(step_choice.choose, 1.0, 1.0, 1.0, self._record, 1.0, 1.0, *self._follows)
        self._start = ready(step_error.begin, self._words, 1.0)
        self._kept = step_choice.SHORTER, step_choice.LONGER
        self.until = math.inf  # time (s) that a step has to end at
        self.last = self.next  # step taken last
        self.chosen = self.next  # step to come, but for where it has to end
        self.begun = False  # whether a step was accepted, or the start
        self.now = 0.0
        self.refused = 0
        self.least = 0.0  # s, see `_begin`
        self.tried: tuple[float, float] | None = None  # step and need of the attempt before, from the same start

    def __call__(self, mbs: Any, t: float) -> list[float]:  # noqa: ARG002
        """Error of the step just solved, as the engine wants it, and a step to take instead."""
        if not self.begun:
            return NO_ERROR
        step = self._it.currentStepSize
        self._read()
        need, factor = self._judge(self._words, step, self._record, self.speed, self.now)
        if need > 1.0 and step > self.least and not self._in_vain(step, need):
            self.refused += 1
            self.tried = step, need
            self.solver.conv.jacobianUpdateRequested = True
            return [REFUSED, factor * step]
        self.next = min(factor * step, self.longest) if need <= 1.0 or self.tried is None else step
        return NO_ERROR

    def _in_vain(self, step: float, need: float) -> bool:
        """Whether a shorter step was of no use, in space.

        What is wrong with the positions of constrained bodies, round-off or the rest that Newton's method leaves, is
        put right within one step by a force that grows as steps shrink: the estimate then hardly falls, and would lead
        to the shortest step there is, where that force is all that is left. An error of the motion falls as the step.
        """
        if self.tried is None or not self.system.scene.in_space:
            return False
        return need > self.tried[1] * math.sqrt(step / self.tried[0])

    def _begin(self) -> None:
        """Learn from the engine, once it has begun, what stays the same for all steps."""
        self.least = self._it.minStepSize
        learn(self._record, self.system.scene, float(self.solver.newmarkBeta), self.least)

    def accept(self, t: float) -> None:
        """Set the step to come; after the step accepted at t (s)."""
        if not self.begun:
            self._begin()
        self.tried = None
        self.last = self._it.currentStepSize or self.last  # 0 before the engine has chosen the first
        self._read()
        self.now = self._start(self._words, self.last)
        self.begun = True
        self.speed = max(self.speed, self.now)
        bed, speeds = self.system.bed, (self.speed, self.now)
        soonest = math.inf if bed is None else bed.load.soonest()
        self.chosen = self._choose(t, self.next, soonest, self._record, *speeds, *self._follows)
        self._take(t)

    def look(self, views: Views) -> None:
        """Learn where the engine keeps its vectors in the part of the solve that begins."""
        self._views, self._own = views, (views.a, views.v)
        self._words = self._places(*self._own, *self._arrays)

    def _read(self) -> None:
        """Read accelerations and rates anew where they do not stay in one place."""
        if not self._views.stay:
            for own, now in zip(self._own, (self._views.a, self._views.v), strict=True):
                own[:] = now

    @property
    def _it(self) -> Any:
        """What the solver tells of its steps, and may be told; asked for each time, as it may be a copy."""
        return self.solver.it

    def kept(self) -> dict[str, Any]:
        """All that its future depends on."""
        arrays = {name: getattr(self, name).copy() for name in OF_STEP}
        return {name: getattr(self, name) for name in KEPT} | arrays

    def restore(self, kept: dict[str, Any]) -> None:
        """Go back to what was kept."""
        for name, value in kept.items():
            if name in OF_STEP:
                getattr(self, name)[:] = value
            else:
                setattr(self, name, value)

    def go_on(self, t: float) -> None:
        """Set the step to come where a solve goes on from t (s) after a pause."""
        self._it.currentStepSize = self.last
        if self.begun:
            self._take(t)

    def _take(self, t: float) -> None:
        """Set the step chosen, shortened so that some of its like end where they have to."""
        if not self.sets:
            return
        it, step = self._it, self.chosen
        fitted = math.isfinite(self.until)
        if fitted:
            left = self.until - t
            if left < END:  # a pause comes first
                return
            step = left / math.ceil(left / step - 1e-9)
        factor = step / self.last
        shorter, longer = self._kept
        if fitted or factor < 1.0 or factor > longer or step == self.longest:
            it.currentStepSize = step
        if not shorter < factor < longer:
            self.solver.conv.jacobianUpdateRequested = True


def _groups(system: System, size: int) -> tuple[NDArray[np.int64], int]:
    """Group of each coordinate (size,) as of `step_error`, and how many means there are: two for each link."""
    from granular_contact.kernels import step_error

    data = system.mbs.systemData
    links = [np.array([data.GetNodeLTGODE2(node)[:2] for node in link.nodes]) for link in system.links.values()]
    group = np.full(size, step_error.NONE if links else step_error.EACH, np.int64)
    for rigid in system.rigid.values():
        group[data.GetNodeLTGODE2(rigid.node)] = step_error.EACH
    means = [places[:, axis] for places in links for axis in (0, 1)]
    for number, nodes in enumerate(means):
        group[nodes] = number
    return group, len(means)
