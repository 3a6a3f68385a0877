"""Forces of one step of one MjData, implicit in it: what is computed, and in which order.

From the time t with the state q, v, in a step of h:

1. if a step ended here, it is accepted: anchors follow to q, its work is added
2. forces where the step would end if v changed as in the step before, and the added masses (`kernels.added_mass`), so
   forces F as a function of the v_1 with which the step ends
3. MuJoCo makes the step with the forces of the step before, and goes back (`trial`); its v_1, and how v_1 grows with
   forces, give Newton's correction of the forces. Once, where MuJoCo is linear in forces; with constraints until a
   correction changes v_1 by less than CLOSE h
4. where a body that touches came farther from where it was foreseen than FAR times the yield displacement: again from
   2, with that end foreseen, at most LOOKS times. Where nothing led by what was foreseen there is no slope to follow:
   a light body under a heavy one, foreseen to rise a little, would fall freely for a step

They are held in `xfrc_applied` of the bodies during the step that follows. What of a step is exact: its impulse on each
body is the wrench times h, its work that of the wrench on the mean of the twists at its ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.kernels import held_step
from granular_contact.engines.mujoco.kernels.added_mass import BEGINS, PASSED, STEP, write_loads
from granular_contact.engines.mujoco.sand import State
from granular_contact.engines.mujoco.trial import Trial
from granular_contact.jit.compiled import bound
from granular_contact.sand.kernels.space_law import DEPTH

if TYPE_CHECKING:
    from granular_contact.engines.mujoco.shared import Shared

Vector = NDArray[np.float64]
SLOW = 0.05  # m/s, below which a step is not foreseen by the one before
CLOSE, MOST = 1e-4, 12  # m/s2 and rad/s2, see above; corrections of a step
LOOKS, FAR = 8, 1.0  # see above; of the displacement at which bristles yield


class Step:
    """Arrays of the steps of one MjData, and the calls that fill them; bodies are those of `Shared`.

    sand: friction state; loads (bodies, 6): force (N) and moment (N m) about centres of mass in the step, start: those
    of the step before; base: what others apply; written, brought: what stood in `xfrc_applied` last, and what MuJoCo's
    own state may bring back of it; twists: at the begin of the step, gained: their change in the step before; works
    (bodies,) J; slopes (bodies, 6): see `kernels.added_mass.extrapolated`, drifts (bodies,) J: their work; seen
    (bodies, 3): see `sand.kernels.space_law.DEPTH`.
    """

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        n = len(shared.numbers)
        self.sand: State = shared.sand.state()
        self.loads, self.start, self.base = (np.zeros((n, 6)) for _ in range(3))
        self.written, self.brought = np.zeros((n, 6)), np.zeros((n, 6))
        self.twists, self.gained = np.zeros((n, 6)), np.zeros((n, 6))
        self.seen, self.works = np.zeros((n, 3)), np.zeros(n)
        self.slopes, self.drifts = np.zeros((n, 6)), np.zeros(n)
        # What a state of the bed is, beside how far it got: arrays that steps change.
        rates, sums = (self.twists, self.gained), (self.seen, self.works, self.drifts)
        motion = self.loads, self.start, self.slopes, self.base, *rates, *sums
        self.kept: tuple[NDArray[Any], ...] = (*(array for of_batch in self.sand for array in of_batch), *motion)
        self.centres, self._model = data.xipos, model
        self._trial = Trial(model, data)
        self._clock = np.zeros(3)
        self._compile(shared, model, data)

    def _compile(self, shared: Shared, model: Any, data: Any) -> None:
        """Kernels with the arrays that they take; views of MuJoCo's memory, which whoever has data keeps alive."""
        n = len(shared.numbers)
        later, past, wrench, foreseen, error, ends = (np.zeros((n, 6)) for _ in range(6))
        arms, poses, then = np.zeros((n, 3)), np.zeros((n, 6, 3)), np.zeros((n, 6, 3))
        added, clock, self._change = np.zeros((n, 6, 6)), self._clock, later
        tree, at = (shared.last, model.dof_parentid, data.cdof), (shared.numbers, shared.tops)
        middle, applied, turn = (data.xipos, data.subtree_com), data.xfrc_applied, shared.turn
        rows = applied, self.base, self.written
        self._begin = bound(
            held_step.begin, *tree, data.qvel, *at, data.xpos, data.xmat, *middle, turn, applied, self.written,
            self.brought, self.base, shared.sand.sizes, SLOW, clock, self.loads, self.start, self.slopes, self.works,
            self.drifts, self.gained,
            self.seen, self.twists, later, past, arms, poses, then, wrench, added,
        )  # fmt: skip
        self._acts = shared.sand.calls(self.sand, clock, poses, then, self.seen, turn, arms, wrench, added)
        self._guess = bound(
            held_step.guess, turn, at[0], wrench, arms, added, past, clock, foreseen, self.loads, self.slopes, *rows
        )
        self._correct = bound(
            held_step.correct, *tree, data.qvel, *at, *middle, added, self.twists, past, later, ends, clock, foreseen,
            error, self.loads, *rows, self._trial.matrix, np.zeros(model.nv), self.slopes,
        )  # fmt: skip
        self._again = bound(
            held_step.again, *at, data.xpos, data.xmat, data.subtree_com, turn, shared.sand.sizes,
            FAR * shared.sand.yields, clock, self.twists, ends, past, later, then, arms, wrench, added,
        )  # fmt: skip
        self._write = bound(write_loads, applied, at[0], self.base, self.loads, self.written)

    def make(self, data: Any, step: float, passed: float, begins: bool) -> None:
        """Find the loads of a step (s) and write them; positions of data are up to date.

        passed (s): how long the step took that ended here, 0 if none did; begins: a motion begins here.
        """
        clock = self._clock
        clock[STEP], clock[PASSED], clock[BEGINS] = step, passed, begins
        self._begin()
        for act in self._acts:
            act()
        if self._guess() or self.seen[:, DEPTH].max() > 0.0:
            self._solve(data, step)
            self._look_again(data, step)

    def _look_again(self, data: Any, step: float) -> None:
        """Take the forces where the step ended, if that is far from where it was foreseen to."""
        self._clock[PASSED] = self._clock[BEGINS] = 0.0
        for _ in range(LOOKS - 1):
            if not self._again():
                break
            before = self.loads.copy(), self.slopes.copy()
            for act in self._acts:
                act()
            if not self._guess():  # it ended where nothing acts: what was found is at its end
                self.loads[:], self.slopes[:] = before
                self._write()
                break
            self._solve(data, step)

    def _solve(self, data: Any, step: float) -> None:
        """Correct the loads until they are those at the end of the step that MuJoCo makes with them."""
        trial, change = self._trial, self._change
        trial.keep(data)
        for _ in range(MOST):
            trial.make(data)
            exact = trial.resistance(data, step)
            self._correct()
            trial.take_back(data)
            if exact or np.abs(change).max() < CLOSE * step:
                break

    def write(self) -> None:
        """Put the loads into `xfrc_applied` again, after they were restored."""
        self._write()
        self.brought[:] = self.written
