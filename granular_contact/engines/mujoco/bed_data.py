"""A bed with one MjData: the start and end of its steps, forces and work, saved states."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco
from granular_contact.engines.mujoco.facet_error import MotionSamples
from granular_contact.engines.mujoco.state import BedState, History
from granular_contact.engines.mujoco.step import Step
from granular_contact.errors import scene_error

if TYPE_CHECKING:
    from granular_contact.engines.mujoco.shared import Shared

Vector = NDArray[np.float64]
DEPTH = 0  # place of the depth in the immersion of a body
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)
SKIPPED = 1.5  # number of steps between two calls above which a call was left out


class BedData:
    """Forces, work and friction state of a bed with one MjData; `MujocoBed.of` makes it.

    Vectors are in the world frame of the model. Forces and moments are those of the sand on the bodies, during the step
    from the last call of `MujocoBed.apply`.

    Attributes
    ----------
    time : float or None
        Time (s) of the last call; None before the first.
    accepted : int
        Number of accepted steps.
    """

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        self._shared, self._model, self._option = shared, model, model.opt
        self.time: float | None = None
        self.accepted = 0
        self._restored: BedState | None = None  # the bed returns to it when MuJoCo's time returns to its time
        self._step = Step(shared, model, data)
        self._rows = np.zeros((256, 3 + 6 * len(shared.numbers))) if shared.record else np.zeros((0, 0))
        self._stages_left = 0  # of a step of RK4
        self._samples = MotionSamples()
        self.busy = False  # whether the bed itself calls MuJoCo at present

    # ---- a step ----

    def apply(self, data: Any) -> None:
        """Compute and write the forces of the next step; MuJoCo computes the present positions first.

        Parameters
        ----------
        data : MjData
            The data that this object belongs to.
        """
        mujoco.mj_fwdPosition(self._model, data)
        self._begin_step(data)

    def evaluate(self, data: Any) -> None:
        """Compute and write the forces of the next step within MuJoCo's passive callback; stages of RK4 are skipped.

        Parameters
        ----------
        data : MjData
            The data that this object belongs to.
        """
        if not self._is_stage(data.time):
            self._begin_step(data)

    def _is_stage(self, time: float) -> bool:
        """Whether a call of the callback belongs to a later stage of a step of RK4, not to the start of a step."""
        step, rk4 = self._option.timestep, int(self._option.integrator) == RK4
        if not rk4 or self.time is None or time <= self.time:
            self._stages_left = 3 if rk4 else 0
            return False
        if self._stages_left == 3 and time > self.time + 0.75 * step:  # the second stage is at half a step
            return False
        if self._stages_left == 0:
            self._stages_left = 3
            return False
        self._stages_left -= 1
        return True

    def _begin_step(self, data: Any) -> None:
        """Accept the step that ended here, if one did; compute and write the forces of the next step."""
        step, time = self._option.timestep, data.time
        elapsed, starts = self._elapsed(time, step)
        if starts:
            self.accepted = 0
        elif elapsed > 0.0:
            self.accepted += 1
        self.busy = True
        try:
            self._step.make(data, step, elapsed, starts)
        finally:
            self.busy = False
        self.time = time
        if starts:
            self._samples.clear()
        if self._shared.compared_loads is not None and self._samples.is_due() and self.depth > 0.0:
            self._samples.add(time, self._step.held, data)
        if len(self._rows):
            self._record(time)

    def _elapsed(self, time: float, step: float) -> tuple[float, bool]:
        """Length (s) of the step that ended at a time (s), and whether a motion starts there; see `Step.make`.

        If MuJoCo's time went back to that of the restored state, the bed returns to that state.
        """
        saved, went_back = self._restored, self.time is not None and time < self.time
        if went_back and saved is not None and saved.time is not None and 0.0 <= time - saved.time <= SKIPPED * step:
            self.take(saved)
        if self.time is None or time < self.time:
            return 0.0, True
        if time == self.time:
            return 0.0, self.accepted == 0
        elapsed = time - self.time
        if elapsed > SKIPPED * step and not self._shared.lenient:
            skipped = f"{elapsed / step:.3g} steps were made since the last call"
            raise scene_error("bed", f"{skipped}: call apply before each mj_step, or install() the bed")
        return elapsed, False

    def _record(self, time: float) -> None:
        """Write the row of the history for the step from a time (s)."""
        if self.accepted >= len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        row = self._rows[self.accepted]
        row[:3] = time, self._step.held["work"].sum(), self.depth
        row[3:] = self._wrenches_about_origin().ravel()

    # ---- results ----

    @property
    def work(self) -> float:
        """Work (J) of the sand on all bodies up to the last call; its negative is dissipated in the sand."""
        return float(self._step.held["work"].sum())

    @property
    def works(self) -> dict[str, float]:
        """Work (J) of the sand on each body up to the last call, by the name of the body."""
        return dict(zip(self._shared.names, self._step.held["work"].tolist(), strict=True))

    @property
    def error(self) -> float:
        """Estimate of the relative error in the work of the sand so far: `step_error` + `facet_error`."""
        return self.step_error + self.facet_error

    @property
    def step_error(self) -> float:
        """Estimate of the relative error in the work of the sand so far that the length of the steps makes.

        It is the share of the work that belongs to the extrapolated part of the forces: the part that was not computed
        at the predicted end of a step, but linearised there. It falls with the step. Bodies that stand do no work, and
        add nothing to it.
        """
        work = float(np.abs(self._step.held["work"]).sum())
        return float(np.abs(self._step.held["extrapolated_work"]).sum()) / work if work > 0.0 else 0.0

    @property
    def facet_error(self) -> float:
        """Estimate of the relative error in the work of the sand so far that the facets make; 0 with `plane`.

        It compares the power of the sand with these facets and with others along the motion (`facet_error`), when this
        property is read. It falls with `facet_size`.
        """
        compared = self._shared.compared_loads
        return 0.0 if compared is None else self._samples.error(compared)

    @property
    def depth(self) -> float:
        """Depth (m) of the deepest point at the last call; negative above the surface, and far above an upper bound."""
        return float(self._step.held["immersion"][:, DEPTH].max())

    @property
    def depths(self) -> dict[str, float]:
        """Depth (m) of the deepest point of each body at the last call, as `depth`, by the name of the body."""
        return dict(zip(self._shared.names, self._step.held["immersion"][:, DEPTH].tolist(), strict=True))

    @property
    def wrenches(self) -> dict[str, Vector]:
        """Force (N) and moment about the world origin (N m) on each body, (6,), by the name of the body."""
        return dict(zip(self._shared.names, self._wrenches_about_origin(), strict=True))

    @property
    def force(self) -> Vector:
        """Resultant force (3,) N on all bodies."""
        total: Vector = self._step.held["load"][:, :3].sum(axis=0)
        return total

    @property
    def history(self) -> History:
        """All steps so far; SceneError unless the bed was made with `record=True`."""
        if not len(self._rows):
            raise scene_error("bed.history", "nothing is recorded: give MujocoBed record=True")
        rows = self._rows[: 0 if self.time is None else self.accepted + 1].copy()
        bodies = rows[:, 3:].reshape(len(rows), -1, 6)
        return History(rows[:, 0], rows[:, 1], rows[:, 2], bodies, self._shared.names)

    def _wrenches_about_origin(self) -> Vector:
        """Forces (N) and moments about the world origin (N m) on all bodies, (bodies, 6)."""
        arms = self._step.centres[self._shared.numbers]
        force, moment = np.hsplit(self._step.held["load"], 2)
        return np.hstack([force, moment + np.cross(arms, force)])

    # ---- saved states ----

    @property
    def state(self) -> BedState:
        """Copy of all that an accepted step changes; save MuJoCo's own state beside it (`mj_getState`)."""
        arrays = tuple(array.copy() for array in self._step.kept)
        return BedState(self.time, self.accepted, arrays, self._rows[: self.accepted + 1].copy())

    def restore(self, state: BedState) -> None:
        """Return to a state of this bed, with this or another MjData; restore MuJoCo's own state beside it.

        If `data.time` returns to the time of this state later, as in MuJoCo's `rollout`, the bed returns to it, too.

        Parameters
        ----------
        state : BedState
            A value of `state`.
        """
        self.take(state)
        self._restored = state
        self._step.write()

    def take(self, state: BedState) -> None:
        """Take over a state without writing to MuJoCo's memory.

        Parameters
        ----------
        state : BedState
            A value of `state`.
        """
        self.time, self.accepted, self._stages_left = state.time, state.accepted, 0
        self._samples.drop_after(-np.inf if state.time is None else state.time)
        for array, saved in zip(self._step.kept, state.arrays, strict=True):
            array[:] = saved
        if len(self._rows):
            while len(self._rows) <= state.accepted:
                self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
            self._rows[: state.accepted + 1] = state.rows

    def restart(self) -> None:
        """Reset friction state and work: a new motion starts with the next call, where the bodies then are."""
        self.time = self._restored = None

    def wrote(self, rows: Vector) -> bool:
        """Whether this object wrote rows of `xfrc_applied` last.

        Parameters
        ----------
        rows : (bodies, 6) array
            Force (N) and moment about the centre of mass (N m), world frame, on each body of the bed, in the bed's
            order.

        Returns
        -------
        bool
            Whether they are equal to the last written ones; False if those are all 0.
        """
        written = self._step.held["written_row"]
        return bool(written.any() and np.array_equal(rows, written))

    def adopt(self, other: BedData) -> None:
        """Take the rows that another object wrote as written by this one; for data that are a copy of the other's.

        So the forces of the sand in the copied rows do not count as forces of others.

        Parameters
        ----------
        other : BedData
            Object of the same bed with the data that were copied.
        """
        for name in ("written_row", "other_load"):
            self._step.held[name] = other._step.held[name]
