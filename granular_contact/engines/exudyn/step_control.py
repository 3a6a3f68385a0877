"""Step-size control by an error estimate in solves by Exudyn: refusing steps, and setting the length of the next one.

`mechanics.stepping` derives the estimate and the choice of the length.
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

# Attributes on which later steps depend: numbers, and arrays.
SAVED = ("top_speed", "next_step", "last_step", "chosen_step", "started", "speed", "refused")
SAVED_ARRAYS = "start", "change", "slope"
NO_ERROR = [0.0, -1.0]  # value with which the engine accepts a step
REFUSED = 2.0  # error with which the engine repeats a step: above its tolerance of 1
# Excess above which an error is of the motion, see `StepControl._is_in_vain`; round-off caused 15, a kilometre away.
LARGE = 100.0


class StepControl:
    """Post-Newton function that refuses steps by their error, and the choice of the next step.

    lever (m,): factors from rates of coordinates to speeds (m/s). sets_steps: whether it may set the engine's steps;
    otherwise it refuses steps whose error is too large, and the engine itself lengthens later steps. refused: number of
    refused steps. start, change, slope (m,): see `mechanics.kernels.step_error`.
    """

    def __init__(self, system: System, solver: Any, lever: Vector, accuracy: float, *, sets_steps: bool = True) -> None:
        from granular_contact.jit.compiled import ready
        from granular_contact.mechanics.kernels import step_choice, step_error  # here, as fixed steps need no numba
        from granular_contact.mechanics.kernels.signal_tables import SIGNAL

        scene = system.scene
        self.system, self.solver, self.lever, self.sets_steps = system, solver, lever, sets_steps
        self._record, self.top_speed, bends, followed, arms = choice(scene, accuracy)
        self.longest = float(self._record["longest"][0])
        self.next_step = min(scene.solver.step_s, self.longest)  # s
        self.group, means = _groups(system, len(lever))
        self.start, self.change, self.slope = np.zeros((3, len(lever)))
        arrays = {
            "start": self.start,
            "change": self.change,
            "slope": self.slope,
            "means": np.zeros(means, step_error.MEAN),
        }
        self._arrays = {"lever": self.lever, "group": self.group} | arrays
        self._addresses, self._addresses_of = np.zeros(0, np.int64), step_error.CHANGES.addresses
        signals = signals_of(scene) if len(followed) else []
        tables = tabulate(signals, scene.solver.end_time_s) if signals else NO_TABLE
        (knots, pieces), values = tables, np.zeros(len(signals), SIGNAL)
        self._prescribed = step_choice.Prescribed(bends, followed, arms, knots, pieces, values)
        self._judge = ready(step_choice.judge, self._addresses, 1.0, self._record, 1.0, 1.0)
        self._choose = ready(step_choice.choose, 1.0, 1.0, 1.0, self._record, 1.0, 1.0, self._prescribed)
        self._start = ready(step_error.begin, self._addresses, 1.0)
        self._same_jacobian = step_choice.SHORTER, step_choice.LONGER  # factors of the step with which it stays valid
        self.until = math.inf  # time (s) at which a step has to end
        self.last_step = self.next_step  # s
        self.chosen_step = self.next_step  # next step (s) before it is fitted to `until`
        self.started = False  # whether the initial state was accepted
        self.speed = 0.0  # m/s, greatest speed at the start of the step; top_speed: in all steps so far
        self.refused = 0
        self.shortest = 0.0  # s, see `_begin`
        self.refused_attempt: tuple[float, float] | None = None  # its length (s) and excess, from the same state

    def __call__(self, mbs: Any, t: float) -> list[float]:  # noqa: ARG002
        """Judge the step just solved: the engine's error value, and the step (s) with which to repeat it."""
        if not self.started:
            return NO_ERROR
        step = self._it.currentStepSize
        self._read_vectors()
        # excess: length of the step over the length that the accuracy allows.
        excess, factor = self._judge(self._addresses, step, self._record, self.top_speed, self.speed)
        is_in_vain = self._is_in_vain(step, excess)
        if excess > 1.0 and step > self.shortest and not is_in_vain:
            self.refused += 1
            self.refused_attempt = step, excess
            self.solver.conv.jacobianUpdateRequested = True
            return [REFUSED, factor * step]
        if excess <= 1.0 or self.refused_attempt is None:
            self.next_step = min(factor * step, self.longest)
        else:
            self.next_step = self.refused_attempt[0] if is_in_vain else step
        return NO_ERROR

    def _is_in_vain(self, step: float, excess: float) -> bool:
        """Whether shortening the step has hardly reduced the estimate; in space alone.

        Round-off and the residual of Newton's method leave errors in the positions of constrained bodies. The next step
        corrects them by a force that grows as the step shrinks. The estimate of such an error hardly falls with the
        step. It would lead to the shortest step, in which nothing but that force is left. The estimate of an error of
        the motion falls in proportion to the step if this is short; if it is much longer than a vibration or its decay,
        the estimate is LARGE.
        """
        if self.refused_attempt is None or not self.system.scene.in_space or excess > LARGE:
            return False
        return excess > self.refused_attempt[1] * math.sqrt(step / self.refused_attempt[0])

    def _begin(self) -> None:
        """Take over from the engine's initialised solver what is constant in all steps: shortest step and scheme."""
        self.shortest = self._it.minStepSize
        learn(self._record, self.system.scene, float(self.solver.newmarkBeta), self.shortest)

    def accept(self, t: float) -> None:
        """Choose and set the next step, after a step was accepted at t (s)."""
        if not self.started:
            self._begin()
        self.refused_attempt = None
        self.last_step = self._it.currentStepSize or self.last_step  # the engine's is 0 before the first step
        self._read_vectors()
        self.speed = self._start(self._addresses, self.last_step)
        self.started = True
        self.top_speed = max(self.top_speed, self.speed)
        bed, speeds = self.system.bed, (self.top_speed, self.speed)
        soonest = math.inf if bed is None else bed.load.soonest()
        self.chosen_step = self._choose(t, self.next_step, soonest, self._record, *speeds, self._prescribed)
        self._set_step(t)

    def bind(self, views: Views) -> None:
        """Take the engine's vectors for the part of the solve that starts."""
        self._views, self._vectors = views, (views.a, views.v)
        self._addresses = self._addresses_of({"a": self._vectors[0], "v": self._vectors[1]} | self._arrays)

    def _read_vectors(self) -> None:
        """Copy accelerations and rates anew if they are not views of the engine's memory."""
        if not self._views.live:
            for array, values in zip(self._vectors, (self._views.a, self._views.v), strict=True):
                array[:] = values

    @property
    def _it(self) -> Any:
        """The solver's numbers of steps and iterations; fetched at each use, as the engine may return a copy."""
        return self.solver.it

    def kept(self) -> dict[str, Any]:
        """Copy of all that later steps depend on."""
        arrays = {name: getattr(self, name).copy() for name in SAVED_ARRAYS}
        return {name: getattr(self, name) for name in SAVED} | arrays

    def restore(self, kept: dict[str, Any]) -> None:
        """Return to what `kept` gave."""
        for name, value in kept.items():
            if name in SAVED_ARRAYS:
                getattr(self, name)[:] = value
            else:
                setattr(self, name, value)

    def resume(self, t: float) -> None:
        """Set the next step where a solve continues from t (s) after a pause."""
        self._it.currentStepSize = self.last_step
        if self.started:
            self._set_step(t)

    def _set_step(self, t: float) -> None:
        """Set the chosen step, shortened so that a whole number of equal steps ends at `until`."""
        if not self.sets_steps:
            return
        it, step = self._it, self.chosen_step
        is_fitted = math.isfinite(self.until)
        if is_fitted:
            left = self.until - t
            if left < END:  # the solve pauses here
                return
            step = left / math.ceil(left / step - 1e-9)
        factor = step / self.last_step
        shorter, longer = self._same_jacobian
        if is_fitted or factor < 1.0 or factor > longer or step == self.longest:
            it.currentStepSize = step
        if not shorter < factor < longer:
            self.solver.conv.jacobianUpdateRequested = True


def _groups(system: System, size: int) -> tuple[NDArray[np.int64], int]:
    """Group (size,) of each coordinate, see `step_error`, and the number of means: two for each link."""
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
