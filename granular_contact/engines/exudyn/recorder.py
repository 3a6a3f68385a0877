"""What is called after every accepted step: keeps the states, and decides when to stop."""

from __future__ import annotations

import math
import time
from types import FrameType
from typing import Any

import numpy as np

from granular_contact.engines.exudyn.step_control import StepControl
from granular_contact.engines.exudyn.views import Views
from granular_contact.mechanics.ending import crowded, diverged, late, unsolved
from granular_contact.mechanics.stepping import END, most_steps
from granular_contact.mechanics.system import System
from granular_contact.results import Progress, Status
from granular_contact.results.stopping import ended, paused
from granular_contact.scene.types import FASTEST, Vector


class Recorder:
    """Post-step function. `reason`: why it stopped the run, "" while it has not."""

    def __init__(self, system: System, progress: Progress | None) -> None:
        self.system = system
        self.solver = system.scene.solver
        self.views = Views(system.mbs)
        self.progress = progress
        data = system.mbs.systemData
        self.size = data.ODE2Size()
        self.rows = 0
        self.states = np.empty((512, 1 + 2 * self.size))
        self.lever = system.levers
        self.motions = [data.GetObjectLTGAE(item)[0] for item in system.motions.values()]
        self.multipliers: list[Vector] = []  # of prescribed motions
        self.accelerations: list[Vector] = []  # that belong to them
        set_from_outside = {drive.joint for drive in system.scene.drives if drive.sets}
        self.external = {name: load for name, load in system.loads.items() if name in set_from_outside}
        self.set_to: list[list[float]] = []
        self.resting_since: float | None = None
        self.reason = ""
        self.control: StepControl | None = None
        self.shortened = 0
        self.asked = self.solver.step_s  # s: fixed steps, which divide the way to the next pause evenly
        self._rest_time = system.scene.rest_time
        self._moving = self.size * self.solver.rest_speed_m_s**2  # m2/s2, see `_rests`
        self.most = most_steps(system.scene)
        self.deadline = math.inf
        self.time = 0.0  # of the last step recorded (s)
        self._paused, self._outdated = False, False

    def __call__(self, _mbs: Any, t: float) -> bool:
        """After a step accepted at t (s): whether to go on."""
        if self._paused:
            self._go_on(t)
            return True
        q, v = self.views.q, self.views.v
        if not v.dot(v) < FASTEST**2 and not np.abs(v).max(initial=0.0) < FASTEST:  # not a number, too
            self.reason = "away"
            return False
        if self.rows == len(self.states):
            self.states = np.concatenate([self.states, np.empty_like(self.states)])
        row, size = self.states[self.rows], self.size
        row[0], row[1 : 1 + size], row[1 + size :] = t, q, v
        self._count(t)
        self.time = t
        self.rows += 1
        if self.motions:
            self.multipliers.append(self.views.multipliers[self.motions])
            self.accelerations.append(self.views.a.copy())
        if self.external:
            self.set_to.append([load.set_to for load in self.external.values()])
        system = self.system
        if system.joints is not None:
            system.joints.accept(q, v)
        if system.bed is not None:
            system.bed.accept_state(t, q, v)
        if self.control is not None:
            self.control.accept(t)
        if self.progress is not None and self.rows % 64 == 0:
            self.progress(t, self.solver.end_time_s)
        return not self._is_over(t, v)

    def resume(self, conv: Any, spent: float) -> None:
        """Get ready to go on from the last state recorded, in a solve that has taken so many seconds.

        The engine begins as if for the first time: it reports that state once more, and then gets what it has
        forgotten, the step to come and whether its Jacobian serves.
        """
        if self.solver.max_wall_s is not None:
            self.deadline = time.perf_counter() + self.solver.max_wall_s - spent
        self._paused, self._conv, self._outdated = True, conv, conv.jacobianUpdateRequested

    def _go_on(self, t: float) -> None:
        self._paused = False
        if not self._outdated:  # as the engine takes it to be
            self._conv.jacobianUpdateRequested = False
        if self.control is not None:
            self.control.resume(t)

    def clear(self) -> None:
        """Forget the state at the start, which is reported once more."""
        self.rows = 0
        for kept in self._lists().values():
            kept.clear()

    def _lists(self) -> dict[str, list[Any]]:
        return {name: getattr(self, name) for name in ("multipliers", "accelerations", "set_to")}

    def kept(self) -> dict[str, Any]:
        """All that was recorded so far."""
        held: dict[str, Any] = {name: getattr(self, name) for name in ("rows", "resting_since", "reason", "shortened")}
        lists = {name: list(values) for name, values in self._lists().items()}
        return held | lists | {"states": self.states[: self.rows].copy()}

    def restore(self, kept: dict[str, Any]) -> None:
        """Go back to what was recorded by an earlier time."""
        rows = kept["rows"]
        vars(self).update({name: value for name, value in kept.items() if name != "states"})
        self.time = float(kept["states"][-1, 0])
        vars(self).update({name: list(values) for name, values in self._lists().items()})
        if rows > len(self.states):
            self.states = np.empty((2 * rows, 1 + 2 * self.size))
        self.states[:rows] = kept["states"]

    def interrupt(self, _signal: int, _frame: FrameType | None) -> None:
        """Signal handler: stop after the step under way; asked again, at once."""
        if self.reason == "interrupted":
            raise KeyboardInterrupt
        self.reason = "interrupted"

    def _count(self, t: float) -> None:
        """Count the steps that the engine made shorter than asked for; the last one only fills up the time."""
        if self.control is None and self.rows > 0 and t < self.solver.end_time_s * (1.0 - 1e-9):
            self.shortened += t - self.time < 0.99 * self.asked

    def _is_over(self, t: float, v: Vector) -> bool:
        if self.reason == "":
            if self._rests(t, v):
                self.reason = "rest"
            elif self.deadline < math.inf and time.perf_counter() > self.deadline and not self.at_end(t):
                self.reason = "time_limit"
            elif self.rows > self.most:
                self.reason = "crowd"
        return self.reason != ""

    def at_end(self, t: float) -> bool:
        """Whether a time (s) is the end of the run."""
        return t >= self.solver.end_time_s - END

    def _rests(self, t: float, v: Vector) -> bool:
        if self._rest_time is None:
            return False
        speeds = self.lever * v  # the mean square decides most of the time, at a fifth of the cost of the greatest
        if speeds.dot(speeds) > self._moving or np.abs(speeds).max() > self.solver.rest_speed_m_s:
            self.resting_since = None
            return False
        if self.resting_since is None:
            self.resting_since = t
        return t - self.resting_since >= self._rest_time


def status(recorder: Recorder, success: bool, problem: str, step: float) -> Status:
    """Status of a solve; problem: what the engine said, if anything; step (s): the last one tried."""
    scene, t = recorder.system.scene, float(recorder.states[recorder.rows - 1, 0])
    match recorder.reason:
        case "time_limit":
            return late(scene, t)
        case "interrupted" | "rest" as code:
            return ended(code, t, recorder.solver)
        case "away":
            return diverged(scene, t)
        case "crowd":
            return crowded(scene, t, recorder.rows - 1, step)
    if not success:
        return unsolved(scene, t, step, problem)
    return ended("end_time", t, recorder.solver) if recorder.at_end(t) else paused(t, recorder.solver)
