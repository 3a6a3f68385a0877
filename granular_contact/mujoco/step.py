"""Forces of one step of one MjData, implicit in it: what is computed, and in which order.

From the time t with the state q, v, in a step of h:

1. if a step ended here, it is accepted: anchors follow to q, its work is added
2. forces where the step would end if v changed as in the step before, and the added masses (`kernels.added_mass`)
3. a trial step of MuJoCo with both gives v_1 (`trial`); the forces less what the added masses take up of v_1 and what
   was foreseen of it are those of the step

They are held in `xfrc_applied` of the bodies during the step that follows. What of a step is exact: its impulse on each
body is the wrench times h, its work that of the wrench on the mean of the twists at its ends.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import held_step
from granular_contact.kernels.added_mass import BEGINS, PASSED, STEP, write_loads
from granular_contact.kernels.entry import bound
from granular_contact.mujoco.sand import State
from granular_contact.mujoco.trial import Trial

if TYPE_CHECKING:
    from granular_contact.mujoco.shared import Shared

Vector = NDArray[np.float64]
SLOW = 0.05  # m/s, below which a step is not foreseen by the one before


class Step:
    """Arrays of the steps of one MjData, and the calls that fill them; bodies are those of `Shared`.

    sand: friction state; loads (bodies, 6): force (N) and moment (N m) about centres of mass in the step; base: what
    others apply; written, brought: what stood in `xfrc_applied` last, and what MuJoCo's own state may bring back of it;
    twists: at the begin of the step, gained: their change in the step before; works (bodies,) J; seen (bodies, 3): see
    `kernels.space_law.DEPTH`.
    """

    def __init__(self, shared: Shared, model: Any, data: Any) -> None:
        n = len(shared.numbers)
        self.sand: State = shared.sand.state()
        self.loads, self.base, self.written, self.brought = (np.zeros((n, 6)) for _ in range(4))
        self.twists, self.gained = np.zeros((n, 6)), np.zeros((n, 6))
        self.seen, self.works = np.zeros((n, 3)), np.zeros(n)
        # What a state of the bed is, beside how far it got: arrays that steps change.
        motion = self.loads, self.base, self.twists, self.gained, self.seen, self.works
        self.kept: tuple[NDArray[Any], ...] = (*(array for of_batch in self.sand for array in of_batch), *motion)
        self.centres, self._model = data.xipos, model
        self._trial = Trial(model, data, shared.last, shared.general)
        if not shared.checked:
            self._trial.check(data)
            shared.checked = True
        self._clock = np.zeros(3)
        self._compile(shared, model, data)

    def _compile(self, shared: Shared, model: Any, data: Any) -> None:
        """Kernels with the arrays that they take; views of MuJoCo's memory, which whoever has data keeps alive."""
        n = len(shared.numbers)
        later, past, wrench = (np.zeros((n, 6)) for _ in range(3))
        arms, poses, then = np.zeros((n, 3)), np.zeros((n, 6, 3)), np.zeros((n, 6, 3))
        added, clock = np.zeros((n, 6, 6)), self._clock
        tree, at = (shared.last, model.dof_parentid, data.cdof), (shared.numbers, shared.tops)
        middle, applied, turn = (data.xipos, data.subtree_com), data.xfrc_applied, shared.turn
        rows, kept = (applied, self.base, self.written), self._trial.arrays
        self._begin = bound(
            held_step.begin, *tree, data.qvel, *at, data.xpos, data.xmat, *middle, turn, applied, self.written,
            self.brought, self.base, shared.sand.sizes, SLOW, clock, self.loads, self.works, self.gained, self.seen,
            self.twists, later, past, arms, poses, then, wrench, added,
        )  # fmt: skip
        self._acts = shared.sand.calls(self.sand, clock, poses, then, self.seen, turn, arms, wrench, added)
        self._burden = bound(
            held_step.burden, turn, *at, *middle, wrench, arms, added, past, clock, self.loads, *rows, *tree[:2],
            model.dof_Madr, tree[2], *kept,
        )  # fmt: skip
        self._relieve = bound(
            held_step.relieve, *tree, *at, *middle, added, self.twists, later, clock, self.loads, *rows, *kept
        )
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
        if self._burden():
            self._trial.make(data, self._relieve)

    def write(self) -> None:
        """Put the loads into `xfrc_applied` again, after they were restored."""
        self._write()
        self.brought[:] = self.written
