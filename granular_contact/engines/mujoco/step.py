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
from granular_contact.engines.mujoco.kernels.held_bodies import BED, HELD, STATE, write_loads
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
    """Records of the steps of one MjData, and the calls that fill them.

    sand: friction state; held (bodies,) and bed (1,): records of `kernels.held_bodies`; kept: arrays that are a state
    of the bed, beside how far it got; centres (all, 3) m: centres of mass.
    """

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        self.sand: State = shared.sand.state()
        self.held, self.bed = np.zeros(len(shared.numbers), HELD), np.zeros(1, BED)
        self.held["number"], self.held["top"], self.held["last"] = shared.numbers, shared.tops, shared.last
        self.held["radius"], self.held["facing"] = shared.sand.sizes, shared.sand.facings
        self.bed["turn"], self.bed["slow"], self.bed["close"] = shared.turn, SLOW, FAR * shared.sand.yields
        self.kept: tuple[NDArray[Any], ...] = (
            *(array for of_batch in self.sand for array in of_batch),
            *(self.held[name] for name in STATE),
        )
        self.centres = data.xipos
        self._trial = Trial(model, data)
        self._compile(shared, model, data)

    def _compile(self, shared: Shared, model: Any, data: Any) -> None:
        """Kernels with the arrays that they take; views of MuJoCo's memory, which whoever has data keeps alive."""
        records, tree, applied = (self.held, self.bed), (model.dof_parentid, data.cdof, data.qvel), data.xfrc_applied
        middle, frames = (data.xipos, data.subtree_com), (data.xpos, data.xmat)
        self._begin = bound(held_step.begin, *records, *tree, *frames, *middle, applied)
        self._acts = shared.sand.calls(self.sand, *records)
        self._guess = bound(held_step.guess, *records, applied)
        room = np.zeros(model.nv)
        self._correct = bound(held_step.correct, *records, *tree, *middle, applied, self._trial.matrix, room)
        self._again = bound(held_step.again, *records, *frames, data.subtree_com)
        self._write = bound(write_loads, self.held, applied)

    def make(self, data: Any, step: float, passed: float, begins: bool) -> None:
        """Find the loads of a step (s) and write them; positions of data are up to date.

        passed (s): how long the step took that ended here, 0 if none did; begins: a motion begins here.
        """
        self.bed["step"], self.bed["passed"], self.bed["begins"] = step, passed, begins
        self._begin()
        for act in self._acts:
            act()
        if self._guess() or self.held["seen"][:, DEPTH].max() > 0.0:
            self._solve(data, step)
            self._look_again(data, step)

    def _look_again(self, data: Any, step: float) -> None:
        """Take the forces where the step ended, if that is far from where it was foreseen to."""
        self.bed["passed"], self.bed["begins"] = 0.0, False
        for _ in range(LOOKS - 1):
            if not self._again():
                break
            before = self.held["load"].copy(), self.held["slope"].copy()
            for act in self._acts:
                act()
            if not self._guess():  # it ended where nothing acts: what was found is at its end
                self.held["load"], self.held["slope"] = before
                self._write()
                break
            self._solve(data, step)

    def _solve(self, data: Any, step: float) -> None:
        """Correct the loads until they are those at the end of the step that MuJoCo makes with them."""
        trial, change = self._trial, self.held["change"]
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
        self.held["brought"] = self.held["written"]
