"""Post-step function of a solve: it records the accepted states and decides when to stop."""

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

SAVED = "rows", "resting_since", "reason", "shortened"  # attributes that belong to a saved state, beside the rows


class Recorder:
    """Post-step function of the engine: records each accepted state and stops the run.

    states (rows, 1 + 2 m): time (s), coordinates without their reference values, and rates; only the first `rows` rows
    are filled. reason: code of what stopped the run, "" while nothing did. lever (m,): factors from rates of
    coordinates to speeds (m/s). multipliers, accelerations: of systems with prescribed motions, one entry per row.
    set_to: values of the drives that are set from outside, one entry per row. shortened: number of fixed steps that the
    engine shortened. time: of the last row (s).
    """

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
        self.multiplier_places = [data.GetObjectLTGAE(item)[0] for item in system.motions.values()]
        self.multipliers: list[Vector] = []
        self.accelerations: list[Vector] = []
        set_from_outside = {drive.joint for drive in system.scene.drives if drive.sets}
        self.external_loads = {name: load for name, load in system.loads.items() if name in set_from_outside}
        self.set_to: list[list[float]] = []
        self.resting_since: float | None = None
        self.reason = ""
        self.control: StepControl | None = None
        self.shortened = 0
        self.fixed_step = self.solver.step_s  # s: fixed steps divide the time to the next pause evenly
        self._rest_time = system.scene.rest_time
        self._rest_speeds_squared = self.size * self.solver.rest_speed_m_s**2  # m2/s2, see `_rests`
        self.most_rows = most_steps(system.scene)
        self.deadline = math.inf
        self.time = 0.0
        self._resumes, self._jacobian_outdated = False, False

    def __call__(self, _mbs: Any, t: float) -> bool:
        """Record the state of a step accepted at t (s); returns whether the solve goes on."""
        if self._resumes:
            self._resume_engine(t)
            return True
        q, v = self.views.q, self.views.v
        # Comparisons with NaN are false, so that NaN stops the run, too.
        if not v.dot(v) < FASTEST**2 and not np.abs(v).max(initial=0.0) < FASTEST:
            self.reason = "away"
            return False
        if self.rows == len(self.states):
            self.states = np.concatenate([self.states, np.empty_like(self.states)])
        row, size = self.states[self.rows], self.size
        row[0], row[1 : 1 + size], row[1 + size :] = t, q, v
        self._count_shortened(t)
        self.time = t
        self.rows += 1
        if self.multiplier_places:
            self.multipliers.append(self.views.multipliers[self.multiplier_places])
            self.accelerations.append(self.views.a.copy())
        if self.external_loads:
            self.set_to.append([load.set_to for load in self.external_loads.values()])
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
        """Prepare to continue from the last recorded state; spent: wall time (s) of the solve so far.

        The engine starts each part of a solve as if it were the first: it reports the present state once more. In that
        call the recorder sets what the engine has lost: the next step, and whether its Jacobian is still valid.
        """
        if self.solver.max_wall_s is not None:
            self.deadline = time.perf_counter() + self.solver.max_wall_s - spent
        self._resumes, self._conv, self._jacobian_outdated = True, conv, conv.jacobianUpdateRequested

    def _resume_engine(self, t: float) -> None:
        """Set step and Jacobian as they were before the pause at t (s)."""
        self._resumes = False
        if not self._jacobian_outdated:  # the engine has set the request at the start of this part
            self._conv.jacobianUpdateRequested = False
        if self.control is not None:
            self.control.resume(t)

    def clear(self) -> None:
        """Remove the initial state, which a restarted engine reports once more."""
        self.rows = 0
        for values in self._lists().values():
            values.clear()

    def _lists(self) -> dict[str, list[Any]]:
        """Lists with one entry per row."""
        return {name: getattr(self, name) for name in ("multipliers", "accelerations", "set_to")}

    def kept(self) -> dict[str, Any]:
        """Copy of all that was recorded so far."""
        record: dict[str, Any] = {name: getattr(self, name) for name in SAVED}
        lists = {name: list(values) for name, values in self._lists().items()}
        return record | lists | {"states": self.states[: self.rows].copy()}

    def restore(self, kept: dict[str, Any]) -> None:
        """Return to a record that `kept` gave."""
        rows = kept["rows"]
        vars(self).update({name: value for name, value in kept.items() if name != "states"})
        self.time = float(kept["states"][-1, 0])
        vars(self).update({name: list(values) for name, values in self._lists().items()})
        if rows > len(self.states):
            self.states = np.empty((2 * rows, 1 + 2 * self.size))
        self.states[:rows] = kept["states"]

    def interrupt(self, _signal: int, _frame: FrameType | None) -> None:
        """Signal handler of Ctrl-C: stop after the present step; a second Ctrl-C stops at once."""
        if self.reason == "interrupted":
            raise KeyboardInterrupt
        self.reason = "interrupted"

    def _count_shortened(self, t: float) -> None:
        """Count a step to t (s) that the engine made shorter than set; the last step of the run may be shorter."""
        if self.control is None and self.rows > 0 and t < self.solver.end_time_s * (1.0 - 1e-9):
            self.shortened += t - self.time < 0.99 * self.fixed_step

    def _is_over(self, t: float, v: Vector) -> bool:
        """Whether the run stops after the step to t (s) with the rates v (m,); sets `reason`."""
        if self.reason == "":
            if self._rests(t, v):
                self.reason = "rest"
            elif self.deadline < math.inf and time.perf_counter() > self.deadline and not self.at_end(t):
                self.reason = "time_limit"
            elif self.rows > self.most_rows:
                self.reason = "crowd"
        return self.reason != ""

    def at_end(self, t: float) -> bool:
        """Whether a time (s) is the end time of the run."""
        return t >= self.solver.end_time_s - END

    def _rests(self, t: float, v: Vector) -> bool:
        """Whether all speeds have been below the rest speed for the rest time."""
        if self._rest_time is None:
            return False
        speeds = self.lever * v
        # The sum of squares is tested first: it decides in most steps, at a fifth of the cost of the greatest speed.
        if speeds.dot(speeds) > self._rest_speeds_squared or np.abs(speeds).max() > self.solver.rest_speed_m_s:
            self.resting_since = None
            return False
        if self.resting_since is None:
            self.resting_since = t
        return t - self.resting_since >= self._rest_time


def status(recorder: Recorder, success: bool, problem: str, step: float) -> Status:
    """Status of a solve.

    success: whether the engine solved all steps. problem: its error message, or "". step: the last step tried (s).
    """
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
