"""Step-size control by an error estimate, in a solve by the engine: how it is made to refuse steps and to set them.

The choice itself: `mechanics.stepping`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.views import Views
from granular_contact.mechanics.stepping import END, NO_TABLE, choice, learn, signals_of
from granular_contact.mechanics.system import System
from granular_contact.scene.signal_tables import tabulate
from granular_contact.scene.types import Vector

# What of a control its future depends on, and arrays of it.
KEPT = ("speed", "next", "last", "chosen", "begun", "now", "refused")
OF_STEP = "start", "change", "slope"
NO_ERROR = [0.0, -1.0]  # as the engine takes a step for good
REFUSED = 2.0  # what the engine takes for a step to be repeated: above its tolerance of 1


class StepControl:
    """Post-Newton function that refuses steps, and the choice of the next one; `refused` counts.

    lever (m,): factors from coordinate rates to speeds (m/s). sets: whether it can set steps; else it refuses those
    whose error is too large, and the engine lengthens them.
    """

    def __init__(self, system: System, solver: Any, lever: Vector, accuracy: float, *, sets: bool = True) -> None:
        from granular_contact.jit.compiled import ready
        from granular_contact.mechanics.kernels import step_choice, step_error  # here, as fixed steps need no numba
        from granular_contact.mechanics.kernels.signal_tables import SIGNAL

        scene = system.scene
        self.system, self.solver, self.lever, self.sets = system, solver, lever, sets
        self._record, self.speed, bends, followed, arms = choice(scene, accuracy)
        self.longest = float(self._record["longest"][0])
        self.next = min(scene.solver.step_s, self.longest)
        self.group, means = _groups(system, len(lever))
        # Accelerations at the start of the step, how they have changed, and by the time in the step before.
        self.start, self.change, self.slope = np.zeros((3, len(lever)))
        of_step = {
            "start": self.start,
            "change": self.change,
            "slope": self.slope,
            "means": np.zeros(means, step_error.MEAN),
        }
        self._arrays = {"lever": self.lever, "group": self.group} | of_step
        self._addresses, self._addresses_of = np.zeros(0, np.int64), step_error.CHANGES.addresses
        signals = signals_of(scene) if len(followed) else []
        tables = tabulate(signals, scene.solver.end_time_s) if signals else NO_TABLE
        (knots, pieces), values = tables, np.zeros(len(signals), SIGNAL)
        self._prescribed = step_choice.Prescribed(bends, followed, arms, knots, pieces, values)
        self._judge = ready(step_choice.judge, self._addresses, 1.0, self._record, 1.0, 1.0)
        self._choose = ready(step_choice.choose, 1.0, 1.0, 1.0, self._record, 1.0, 1.0, self._prescribed)
        self._start = ready(step_error.begin, self._addresses, 1.0)
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
        need, factor = self._judge(self._addresses, step, self._record, self.speed, self.now)
        in_vain = self._in_vain(step, need)
        if need > 1.0 and step > self.least and not in_vain:
            self.refused += 1
            self.tried = step, need
            self.solver.conv.jacobianUpdateRequested = True
            return [REFUSED, factor * step]
        if need <= 1.0 or self.tried is None:
            self.next = min(factor * step, self.longest)
        else:
            self.next = self.tried[0] if in_vain else step
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
        self.now = self._start(self._addresses, self.last)
        self.begun = True
        self.speed = max(self.speed, self.now)
        bed, speeds = self.system.bed, (self.speed, self.now)
        soonest = math.inf if bed is None else bed.load.soonest()
        self.chosen = self._choose(t, self.next, soonest, self._record, *speeds, self._prescribed)
        self._take(t)

    def bind(self, views: Views) -> None:
        """Learn where the engine keeps its vectors in the part of the solve that begins."""
        self._views, self._own = views, (views.a, views.v)
        self._addresses = self._addresses_of({"a": self._own[0], "v": self._own[1]} | self._arrays)

    def _read(self) -> None:
        """Read accelerations and rates anew where they do not stay in one place."""
        if not self._views.live:
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

    def resume(self, t: float) -> None:
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
    from granular_contact.mechanics.kernels import step_error

    coordinates = system.coordinates
    links = [np.array([coordinates.places(node)[:2] for node in link.nodes]) for link in system.links.values()]
    group = np.full(size, step_error.NONE if links else step_error.EACH, np.int64)
    for rigid in system.rigid.values():
        group[coordinates.places(rigid.node)] = step_error.EACH
    means = [places[:, axis] for places in links for axis in (0, 1)]
    for number, nodes in enumerate(means):
        group[nodes] = number
    return group, len(means)
