"""What a bed keeps for one MjData: friction state, the wrenches that act, work; one call a step.

Order in a step of h, from the time t with the state q, v:

1. if time has moved since the last call, that step is accepted: anchors follow to q, its work is added
2. forces where the step would end if v changed as in the step before, and the added masses (`kernels.added_mass`)
3. a trial step of MuJoCo with both gives v_1 (`trial`); the forces less what the added masses take up of v_1 and what
   was foreseen of it are those of the step

They are held in `xfrc_applied` of the bodies during the step that follows. What of a step is exact: its impulse on each
body is the wrench times h, its work that of the wrench on the mean of the twists at its ends.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error
from granular_contact.kernels import added_mass as kernels
from granular_contact.kernels.entry import entry
from granular_contact.mujoco.engine import mujoco
from granular_contact.mujoco.sand import State
from granular_contact.mujoco.trial import Trial

if TYPE_CHECKING:
    from granular_contact.mujoco.bed import Shared

Vector = NDArray[np.float64]
DEPTH, SPEED, LOWEST = 0, 1, 2
RK4 = int(mujoco.mjtIntegrator.mjINT_RK4)
SLOW = 0.05  # m/s, below which a step is not foreseen by the one before
SKIPPED = 1.5  # steps between two calls, from which on one was left out


@dataclass(frozen=True)
class BedState:
    """All that the future of a bed with one MjData depends on beside MuJoCo's own state, see `BedData.state`."""

    time: float | None
    accepted: int
    anchors: tuple[tuple[Vector, NDArray[np.bool_]], ...]
    loads: Vector
    base: Vector
    twists: Vector
    gained: Vector
    seen: Vector
    works: Vector
    rows: Vector


@dataclass(frozen=True)
class History:
    """One entry a step (`MujocoBed(..., record=True)`).

    time (n,) s of its start; work (n,) J done on all bodies before it; depth (n,) m of the deepest point then; bodies
    (n, bodies, 6): force (N) and moment about the world origin (N m) during the step, for each of `body_names`.
    """

    time: Vector
    work: Vector
    depth: Vector
    bodies: Vector
    body_names: tuple[str, ...]


class BedData:
    """What a bed keeps for one MjData; made and found by `MujocoBed.of`."""

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        self._shared, self._model, self._option = shared, model, model.opt
        count = len(shared.numbers)
        self.time: float | None = None
        self.accepted = 0
        self._home: BedState | None = None  # to which it goes back with MuJoCo's time
        self._state: State = shared.sand.state()
        self._loads, self._base = np.zeros((count, 6)), np.zeros((count, 6))
        self._written = np.zeros((count, 6))
        self._brought = np.zeros((count, 6))  # what MuJoCo's own state may bring back of them
        self._seen, self._works = np.zeros((count, 3)), np.zeros(count)
        self._poses, self._then = np.zeros((count, 6, 3)), np.zeros((count, 6, 3))
        self._twists, self._later, self._past, self._gained = (np.zeros((count, 6)) for _ in range(4))
        self._wrench, self._arms, self._added = np.zeros((count, 6)), np.zeros((count, 3)), np.zeros((count, 6, 6))
        self._rows = np.zeros((256, 3 + 6 * count)) if shared.record else np.zeros((0, 0))
        self._stages = 0  # of a step of RK4, that are still to come
        self.busy = False  # whether MuJoCo is asked by ourselves
        # Views of MuJoCo's memory; they do not keep it alive, whoever has data does.
        self._applied, self._axes, self._v = data.xfrc_applied, data.cdof, data.qvel
        self._places = (data.xpos, data.xmat, data.subtree_com)
        self._inertial = data.xipos
        self._trial = Trial(model, data, shared.last, shared.general)
        if not shared.checked:
            self._trial.check(data)
            shared.checked = True
        self._compiled = _Compiled(self, shared, model)
        rows = (self._applied, shared.numbers, self._written)
        self._blank = entry(kernels.blank, self._seen)
        self._base_of = entry(kernels.find_base, *rows, self._brought, self._base)
        self._write = entry(kernels.write_loads, *rows[:2], self._base, self._loads, self._written)

    # ---- a step ----

    def apply(self, data: Any) -> None:
        """Forces for the step from here, with MuJoCo's own positions and velocities found for them."""
        self.busy = True
        try:
            mujoco.mj_fwdPosition(self._model, data)
            self._act(data)
        finally:
            self.busy = False

    def evaluate(self, data: Any) -> None:
        """The same from within MuJoCo's passive forces, which it asks for at each stage of an RK4 step."""
        if self._is_stage(data.time):
            return
        self.busy = True
        try:
            self._act(data)
        finally:
            self.busy = False

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
        step, time, call = self._option.timestep, data.time, self._compiled
        call.twists(self._v, self._later)
        call.place(self._later, self._poses, self._arms)
        self._accept(time, step)
        self._base_of(self._applied, self._shared.numbers, self._written, self._brought, self._base)
        self._find(data, step, call)
        self._write(self._applied, self._shared.numbers, self._base, self._loads, self._written)
        if len(self._rows):
            self._record(time)

    def _accept(self, time: float, step: float) -> None:
        """Advance the friction state and the work, or begin, or begin again where a state was restored."""
        home = self._home
        back = self.time is not None and time < self.time
        if back and home is not None and home.time is not None and 0.0 <= time - home.time <= SKIPPED * step:
            self.take(home)
        sand, before = self._shared.sand, self.time
        if before is not None and time > before:
            passed = time - before
            if passed > SKIPPED * step and not self._shared.lenient:
                what = f"{passed / step:.3g} steps were made since the last call"
                raise scene_error("bed", f"{what}: call apply before each mj_step, or install() the bed")
            self._compiled.end(self._loads, self._twists, self._later, passed, self._works, self._gained)
            self.accepted += 1
        elif before == time and self.accepted:
            return
        begins = before is None or time <= before
        if begins:
            self._works[:], self._loads[:], self._gained[:] = 0.0, 0.0, 0.0
            self.accepted = 0
        self._blank(self._seen)
        sand.follow(self._state, self._poses, step, self._seen, begins)
        self.time = time

    def _find(self, data: Any, step: float, call: _Compiled) -> None:
        """Find the loads of the step."""
        motion = (self._twists, self._gained, self._past, self._later)
        call.foresee(self._poses, self._shared.sand.sizes, SLOW, *motion, self._wrench, self._added)
        call.place(self._later, self._then, self._arms)
        found = (self._shared.turn, self._arms, self._wrench, self._added)
        self._shared.sand.resist(self._state, self._poses, self._then, step, *found)
        if not call.load(self._wrench, self._arms, self._added, self._past, step, self._loads):
            return
        mujoco.mj_fwdVelocity(self._model, data)
        self._write(self._applied, self._shared.numbers, self._base, self._loads, self._written)
        call.twists(self._trial.step(data, self._added), self._later)
        self._later -= self._twists
        call.settle(self._added, self._later, step, self._loads)

    def _record(self, time: float) -> None:
        if self.accepted >= len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        row = self._rows[self.accepted]
        row[:3] = time, self._works.sum(), self.depth
        row[3:] = self._about_origin().ravel()

    # ---- what is read ----

    @property
    def work(self) -> float:
        """Work (J) that the sand has done on all bodies up to the last call; its negative is lost in the sand."""
        return float(self._works.sum())

    @property
    def works(self) -> dict[str, float]:
        """The same of each body."""
        return dict(zip(self._shared.names, self._works.tolist(), strict=True))

    @property
    def depth(self) -> float:
        """Depth (m) of the deepest point at the last call, negative above the surface: far above it a bound."""
        return float(self._seen[:, DEPTH].max())

    @property
    def depths(self) -> dict[str, float]:
        """The same of each body."""
        return dict(zip(self._shared.names, self._seen[:, DEPTH].tolist(), strict=True))

    @property
    def wrenches(self) -> dict[str, Vector]:
        """Force (N) and moment about the world origin (N m) of the sand on each body in the step, (6,), world frame."""
        return dict(zip(self._shared.names, self._about_origin(), strict=True))

    @property
    def force(self) -> Vector:
        """Resultant (3,) N of the sand on all bodies in the step, world frame."""
        total: Vector = self._loads[:, :3].sum(axis=0)
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
        arms = self._inertial[self._shared.numbers]
        return np.hstack([self._loads[:, :3], self._loads[:, 3:] + np.cross(arms, self._loads[:, :3])])

    # ---- to go back ----

    @property
    def state(self) -> BedState:
        """A copy of all that an accepted step changes; MuJoCo's own state is saved beside it (`mj_getState`)."""
        anchors = tuple((a.copy(), b.copy()) for a, b in self._state)
        rows = self._rows[: self.accepted + 1].copy()
        loads, base, twists = self._loads.copy(), self._base.copy(), self._twists.copy()
        motion = twists, self._gained.copy(), self._seen.copy(), self._works.copy()
        return BedState(self.time, self.accepted, anchors, loads, base, *motion, rows)

    def restore(self, state: BedState) -> None:
        """Go back to a state of this bed, of this or another MjData; set MuJoCo's own state beside it.

        When `data.time` goes back to the time of this state later on, as `rollout` has it, the bed goes back to it too.
        """
        self.take(state)
        self._home = state
        self._write(self._applied, self._shared.numbers, self._base, self._loads, self._written)
        self._brought[:] = self._written

    def take(self, state: BedState) -> None:
        """Take a state on, without any trace in MuJoCo's memory."""
        self.time, self.accepted, self._stages = state.time, state.accepted, 0
        for (anchors, active), (a, b) in zip(self._state, state.anchors, strict=True):
            anchors[:], active[:] = a, b
        for own, kept in (
            (self._loads, state.loads),
            (self._base, state.base),
            (self._twists, state.twists),
            (self._gained, state.gained),
            (self._seen, state.seen),
            (self._works, state.works),
        ):
            own[:] = kept
        if len(self._rows):
            while len(self._rows) <= state.accepted:
                self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
            self._rows[: state.accepted + 1] = state.rows

    def restart(self) -> None:
        """Forget the friction state and the work: the next call begins anew where the bodies are."""
        self.time = self._home = None

    def wrote(self, rows: Vector) -> bool:
        """Whether rows of `xfrc_applied` (bodies, 6) are those that were written here last."""
        return bool(self._written.any() and np.array_equal(rows, self._written))

    def adopt(self, other: BedData) -> None:
        """Take rows that another one wrote for one's own: this data is a copy of its."""
        self._written[:], self._base[:] = other._written, other._base


class _Compiled:
    """Kernels with the arrays of a BedData that they always take."""

    def __init__(self, kept: BedData, shared: Shared, model: Any) -> None:
        n, t = shared.numbers, shared.tops
        x, R, c = kept._places
        tree = (shared.last, model.dof_parentid, kept._axes)
        at = (n, t, kept._inertial, c)
        twists, added, loads = kept._twists, kept._added, kept._loads
        works = kept._works
        self._twists = entry(kernels.gather_twists, *tree, kept._v, twists), tree
        self._place = (
            entry(kernels.place_bodies, n, t, x, R, c, twists, shared.turn, kept._poses, kept._arms),
            (n, t, x, R, c),
        )
        load = (shared.turn, *at)
        self._load = entry(kernels.load_trial, *load, loads, kept._arms, added, twists, 1.0, loads), load
        self._settle = entry(kernels.settle, *at, added, twists, 1.0, loads), at
        self._end = entry(kernels.end_step, *at, loads, twists, twists, 1.0, works, twists), at
        self._turn = shared.turn
        self.foresee = entry(kernels.foresee, kept._poses, shared.sand.sizes, 1.0, *[twists] * 4, kept._wrench, added)

    def twists(self, rates: Vector, out: Vector) -> None:
        call, first = self._twists
        call(*first, rates, out)

    def place(self, twists: Vector, out: Vector, arms: Vector) -> None:
        call, first = self._place
        call(*first, twists, self._turn, out, arms)

    def load(self, wrench: Vector, arms: Vector, added: Vector, past: Vector, step: float, loads: Vector) -> bool:
        call, first = self._load
        return bool(call(*first, wrench, arms, added, past, step, loads))

    def settle(self, added: Vector, gained: Vector, step: float, loads: Vector) -> None:
        call, first = self._settle
        call(*first, added, gained, step, loads)

    def end(self, loads: Vector, twists: Vector, now: Vector, passed: float, works: Vector, gained: Vector) -> None:
        call, first = self._end
        call(*first, loads, twists, now, passed, works, gained)
