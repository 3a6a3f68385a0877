"""What a bed keeps for one MjData: when its steps begin and end, what is read of them, state and restore."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco
from granular_contact.engines.mujoco.facet_error import Instants
from granular_contact.engines.mujoco.state import BedState, History
from granular_contact.engines.mujoco.step import Step
from granular_contact.errors import scene_error

if TYPE_CHECKING:
    from granular_contact.engines.mujoco.shared import Shared

Vector = NDArray[np.float64]
DEPTH = 0  # of what is seen of bodies
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)
SKIPPED = 1.5  # steps between two calls, from which on one was left out


class BedData:
    """What a bed keeps for one MjData; made and found by `MujocoBed.of`."""

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        self._shared, self._model, self._option = shared, model, model.opt
        self.time: float | None = None
        self.accepted = 0
        self._home: BedState | None = None  # to which it goes back with MuJoCo's time
        self._step = Step(shared, model, data)
        self._rows = np.zeros((256, 3 + 6 * len(shared.numbers))) if shared.record else np.zeros((0, 0))
        self._stages = 0  # of a step of RK4, that are still to come
        self._instants = Instants()
        self.busy = False  # whether MuJoCo is asked by ourselves

    # ---- a step ----

    def apply(self, data: Any) -> None:
        """Forces for the step from here, with MuJoCo's own positions and velocities found for them."""
        mujoco.mj_fwdPosition(self._model, data)
        self._act(data)

    def evaluate(self, data: Any) -> None:
        """The same from within MuJoCo's passive forces, which it asks for at each stage of an RK4 step."""
        if not self._is_stage(data.time):
            self._act(data)

    def _is_stage(self, time: float) -> bool:
        step, rk4 = self._option.timestep, int(self._option.integrator) == RK4
        if not rk4 or self.time is None or time <= self.time:
            self._stages = 3 if rk4 else 0
            return False
        if self._stages == 3 and time > self.time + 0.75 * step:  # no stage: they begin at half a step
            return False
        if self._stages == 0:
            self._stages = 3
            return False
        self._stages -= 1
        return True

    def _act(self, data: Any) -> None:
        """Accept the step that ended here, if one did, and find and set the forces of the next."""
        step, time = self._option.timestep, data.time
        passed, begins = self._passed(time, step)
        if begins:
            self.accepted = 0
        elif passed > 0.0:
            self.accepted += 1
        self.busy = True
        try:
            self._step.make(data, step, passed, begins)
        finally:
            self.busy = False
        self.time = time
        if begins:
            self._instants.clear()
        if self._shared.facets is not None and self._instants.due() and self.depth > 0.0:
            self._instants.note(time, self._step.held, data)
        if len(self._rows):
            self._record(time)

    def _passed(self, time: float, step: float) -> tuple[float, bool]:
        """How long the step took that ended here (s), and whether a motion begins here; as of `Step.make`.

        Where MuJoCo's time went back to that of a state which was restored, the bed goes back to it.
        """
        home = self._home
        back = self.time is not None and time < self.time
        if back and home is not None and home.time is not None and 0.0 <= time - home.time <= SKIPPED * step:
            self.take(home)
        if self.time is None or time < self.time:
            return 0.0, True
        if time == self.time:
            return 0.0, self.accepted == 0
        passed = time - self.time
        if passed > SKIPPED * step and not self._shared.lenient:
            what = f"{passed / step:.3g} steps were made since the last call"
            raise scene_error("bed", f"{what}: call apply before each mj_step, or install() the bed")
        return passed, False

    def _record(self, time: float) -> None:
        if self.accepted >= len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        row = self._rows[self.accepted]
        row[:3] = time, self._step.held["work"].sum(), self.depth
        row[3:] = self._about_origin().ravel()

    # ---- what is read ----

    @property
    def work(self) -> float:
        """Work (J) that the sand has done on all bodies up to the last call; its negative is lost in the sand."""
        return float(self._step.held["work"].sum())

    @property
    def works(self) -> dict[str, float]:
        """The same of each body."""
        return dict(zip(self._shared.names, self._step.held["work"].tolist(), strict=True))

    @property
    def error(self) -> float:
        """Estimate of the relative error in the work of the sand so far: that of the steps and that of the facets."""
        return self.step_error + self.facet_error

    @property
    def step_error(self) -> float:
        """Estimate of the relative error that steps of this length make in the work of the sand so far.

        The share of it that forces do which were not found where a step was foreseen to end, but along a slope from
        there. Shorter steps make it smaller; work that bodies do not do while they stand makes none.
        """
        whole = float(np.abs(self._step.held["work"]).sum())
        return float(np.abs(self._step.held["drift"]).sum()) / whole if whole > 0.0 else 0.0

    @property
    def facet_error(self) -> float:
        """Estimate of the relative error that facets of this size make in the work of the sand so far, 0 in the plane.

        Found by what other facets would do along the motion (`facet_error`), when it is asked for. A smaller
        `facet_size` makes it smaller.
        """
        return 0.0 if self._shared.facets is None else self._instants.error(self._shared.facets)

    @property
    def depth(self) -> float:
        """Depth (m) of the deepest point at the last call, negative above the surface: far above it a bound."""
        return float(self._step.held["seen"][:, DEPTH].max())

    @property
    def depths(self) -> dict[str, float]:
        """The same of each body."""
        return dict(zip(self._shared.names, self._step.held["seen"][:, DEPTH].tolist(), strict=True))

    @property
    def wrenches(self) -> dict[str, Vector]:
        """Force (N) and moment about the world origin (N m) of the sand on each body in the step, (6,), world frame."""
        return dict(zip(self._shared.names, self._about_origin(), strict=True))

    @property
    def force(self) -> Vector:
        """Resultant (3,) N of the sand on all bodies in the step, world frame."""
        total: Vector = self._step.held["load"][:, :3].sum(axis=0)
        return total

    @property
    def history(self) -> History:
        """All steps so far; it takes `record=True`."""
        if not len(self._rows):
            raise scene_error("bed.history", "nothing is recorded: give MujocoBed record=True")
        rows = self._rows[: 0 if self.time is None else self.accepted + 1].copy()
        bodies = rows[:, 3:].reshape(len(rows), -1, 6)
        return History(rows[:, 0], rows[:, 1], rows[:, 2], bodies, self._shared.names)

    def _about_origin(self) -> Vector:
        arms = self._step.centres[self._shared.numbers]
        force, moment = np.hsplit(self._step.held["load"], 2)
        return np.hstack([force, moment + np.cross(arms, force)])

    # ---- to go back ----

    @property
    def state(self) -> BedState:
        """A copy of all that an accepted step changes; MuJoCo's own state is saved beside it (`mj_getState`)."""
        arrays = tuple(array.copy() for array in self._step.kept)
        return BedState(self.time, self.accepted, arrays, self._rows[: self.accepted + 1].copy())

    def restore(self, state: BedState) -> None:
        """Go back to a state of this bed, of this or another MjData; set MuJoCo's own state beside it.

        When `data.time` goes back to the time of this state later on, as `rollout` has it, the bed goes back to it too.
        """
        self.take(state)
        self._home = state
        self._step.write()

    def take(self, state: BedState) -> None:
        """Take a state on, without any trace in MuJoCo's memory."""
        self.time, self.accepted, self._stages = state.time, state.accepted, 0
        self._instants.back_to(-np.inf if state.time is None else state.time)
        for array, kept in zip(self._step.kept, state.arrays, strict=True):
            array[:] = kept
        if len(self._rows):
            while len(self._rows) <= state.accepted:
                self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
            self._rows[: state.accepted + 1] = state.rows

    def restart(self) -> None:
        """Forget the friction state and the work: the next call begins anew where the bodies are."""
        self.time = self._home = None

    def wrote(self, rows: Vector) -> bool:
        """Whether rows of `xfrc_applied` (bodies, 6) are those that were written here last."""
        written = self._step.held["written"]
        return bool(written.any() and np.array_equal(rows, written))

    def adopt(self, other: BedData) -> None:
        """Take rows that another one wrote for one's own: this data is a copy of its."""
        for name in ("written", "base"):
            self._step.held[name] = other._step.held[name]
