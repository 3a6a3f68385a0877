"""Forces of one step of one MjData, implicit in the step: the order of the computation.

From the time t with the state q, v, in a step of h:

1. If a step ended at t, it is accepted: anchors follow to q, and its work is added.
2. The end of the step is predicted with the change of v in the last step. Forces there and the added masses
   (`kernels.added_mass`) give the forces F as a linear function of the velocity v_1 at the end of the step.
3. MuJoCo makes a trial step with the loads of the last step, and is set back (`trial`). Its v_1, and the derivative of
   v_1 by the forces, give Newton's correction of the loads. Without constraints MuJoCo is linear in the forces, and one
   correction suffices; with constraints step 3 is repeated until a correction changes v_1 by less than CLOSE h.
4. If a body that touches deviates from its predicted end by more than FAR times the yield displacement, steps 2 and 3
   are repeated with the end reached as prediction; at most LOOKS predictions are made. If a prediction has no contact,
   there is no stiffness to linearise: a light body under a heavy one that is predicted to rise a little would fall
   freely for a step.

The loads stay in `xfrc_applied` of the bodies during the following step. Exact for a step are the impulse on each body,
which is the load times h, and the work, which is that of the load on the mean of the twists at the two ends of the
step.
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
SLOW = 0.05  # m/s: below it the last step hardly predicts the next one, see `held_bodies.predict`
CLOSE, MOST = 1e-4, 12  # change of v_1 over h (m/s2, rad/s2) that ends the iteration; most corrections
LOOKS, FAR = 8, 0.1  # most predictions of a step; deviation from a prediction over the yield displacement


class Step:
    """Records of the steps of one MjData, and the compiled functions that fill them.

    sand: friction state. held (bodies,), bed (1,): records of `kernels.held_bodies`. kept: arrays that belong to a
    state of the bed. centres (all, 3) m: centres of mass of all bodies, world frame, in MuJoCo's memory.
    """

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        self.sand: State = shared.sand.state()
        self.held, self.bed = np.zeros(len(shared.numbers), HELD), np.zeros(1, BED)
        self.held["number"], self.held["root"], self.held["last_dof"] = shared.numbers, shared.roots, shared.last_dofs
        self.held["radius"], self.held["facing"] = shared.sand.sizes, shared.sand.facings
        self.bed["turn"], self.bed["slow_speed"] = shared.turn, SLOW
        self.bed["tolerance"] = FAR * shared.sand.yield_displacement
        self.kept: tuple[NDArray[Any], ...] = (
            *(array for batch_state in self.sand for array in batch_state),
            *(self.held[name] for name in STATE),
        )
        self.centres = data.xipos
        self._trial = Trial(model, data)
        self._compile(shared, model, data)

    def _compile(self, shared: Shared, model: Any, data: Any) -> None:
        """Bind kernels to their arrays: records, and views of data's memory, which the caller must keep alive."""
        records, tree, applied = (self.held, self.bed), (model.dof_parentid, data.cdof, data.qvel), data.xfrc_applied
        centres, frames = (data.xipos, data.subtree_com), (data.xpos, data.xmat)
        self._begin = bound(held_step.begin, *records, *tree, *frames, *centres, applied)
        self._force_calls = shared.sand.calls(self.sand, *records)
        self._guess = bound(held_step.guess, *records, applied)
        work_space = np.zeros(model.nv)
        self._correct = bound(held_step.correct, *records, *tree, *centres, applied, self._trial.matrix, work_space)
        self._predict_again = bound(held_step.predict_again, *records, *frames, data.subtree_com)
        self._write = bound(write_loads, self.held, applied)

    def make(self, data: Any, step: float, elapsed: float, starts: bool) -> None:
        """Compute the loads of a step (s) and write them; the positions of data must be up to date.

        elapsed (s): length of the step that ended here, 0 if none did. starts: whether a motion starts here.
        """
        self.bed["step"], self.bed["elapsed"], self.bed["starts"] = step, elapsed, starts
        self._begin()
        for compute_forces in self._force_calls:
            compute_forces()
        if self._guess() or self.held["immersion"][:, DEPTH].max() > 0.0:
            self._solve(data, step)
            self._improve_prediction(data, step)

    def _improve_prediction(self, data: Any, step: float) -> None:
        """Repeat the step with the end reached as prediction, while the two are far apart."""
        self.bed["elapsed"], self.bed["starts"] = 0.0, False
        for _ in range(LOOKS - 1):
            if not self._predict_again():
                break
            saved = self.held["load"].copy(), self.held["extrapolated"].copy()
            for compute_forces in self._force_calls:
                compute_forces()
            if not self._guess():  # nothing acts at the new prediction: the loads found before are kept
                self.held["load"], self.held["extrapolated"] = saved
                self._write()
                break
            self._solve(data, step)

    def _solve(self, data: Any, step: float) -> None:
        """Iterate Newton's method until the loads are those at the end of the step that MuJoCo makes with them."""
        trial, correction = self._trial, self.held["correction"]
        trial.save(data)
        for _ in range(MOST):
            trial.make(data)
            exact = trial.fill_matrix(data, step)
            self._correct()
            trial.restore(data)
            if exact or np.abs(correction).max() < CLOSE * step:
                break

    def write(self) -> None:
        """Write the loads to `xfrc_applied` again, after a state was restored."""
        self._write()
        self.held["restored_row"] = self.held["written_row"]
