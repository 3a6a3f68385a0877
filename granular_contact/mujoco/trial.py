"""A step of MuJoCo that is taken back: the rates at its end if some bodies had more inertia and were loaded.

MuJoCo itself solves for them, with its constraints, actuators, joint damping and implicit integrators; so the forces
that the added inertia takes up are those of the step that follows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import SolveError
from granular_contact.kernels import added_mass as kernels
from granular_contact.mujoco.engine import mujoco

_IMPLICIT = (int(mujoco.mjtIntegrator.mjINT_IMPLICIT), int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST))


class General:
    """Lets MuJoCo treat the mass matrix of free bodies as any other for as long as a trial lasts.

    Of a free body alone MuJoCo knows that its mass matrix is diagonal, which it is not with added inertia. The model
    says so; that is changed while at least one thread is in a trial.
    """

    def __init__(self, model: Any) -> None:
        self.any = bool(model.dof_simplenum.any())
        self._known, self._lock, self._inside = model.dof_simplenum.copy(), Lock(), 0
        self._numbers = model.dof_simplenum

    @contextmanager
    def within(self) -> Iterator[None]:
        """A trial."""
        with self._lock:
            self._inside += 1
            self._numbers[:] = 0
        try:
            yield
        finally:
            with self._lock:
                self._inside -= 1
                if self._inside == 0:
                    self._numbers[:] = self._known


class Trial:
    """Trial steps of one MjData, from the present state; positions of MuJoCo have to be up to date.

    last: as of `shared.Shared`; general: of the model. arrays: those of MuJoCo that a trial changes, and copies of
    them, as `kernels.held_step` takes them.
    """

    def __init__(self, model: Any, data: Any, last: NDArray[np.int64], general: General) -> None:
        if not hasattr(data, "qM"):
            raise _another_way()
        self._model, self._general, self._mass = model, general, data.qM
        changed = data.qpos, data.qvel, data.act, data.qacc_warmstart, data.qM
        self.arrays = *changed, *(array.copy() for array in changed)
        self._option, self._dual = model.opt, int(model.opt.solver) == int(mujoco.mjtSolver.mjSOL_PGS)
        self._tree = (last, model.dof_parentid, model.dof_Madr, data.cdof)

    def make(self, data: Any, taken_back: Callable[[], None]) -> None:
        """A step with the mass matrix and the loads that data has; `taken_back` reads its end and undoes it."""
        if not self._general.any:
            self._make(data, taken_back)
            return
        with self._general.within():
            self._make(data, taken_back)

    def _make(self, data: Any, taken_back: Callable[[], None]) -> None:
        model = self._model
        mujoco.mj_fwdVelocity(model, data)
        self._factor(data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        mujoco.mj_fwdConstraint(model, data)
        time = data.time
        if int(self._option.integrator) in _IMPLICIT:
            mujoco.mj_implicit(model, data)
        else:
            mujoco.mj_Euler(model, data)
        taken_back()
        data.time = time
        self._factor(data)

    def _factor(self, data: Any) -> None:
        """Factors of the mass matrix, and what the dual solver makes of them."""
        mujoco.mj_factorM(self._model, data)
        if self._dual:
            mujoco.mj_projectConstraint(self._model, data)

    def check(self, data: Any) -> None:
        """Look whether this MuJoCo keeps its mass matrix as it is known here.

        Raises
        ------
        SolveError
            It does not; the message is one line.
        """
        count, nv = len(self._tree[0]), self._model.nv
        added = np.repeat(np.eye(6)[None], count, axis=0)
        x, y, z = np.sin(1.0 + np.arange(nv)), np.zeros(nv), np.zeros((1, nv))
        twists = np.zeros((count, 6))
        mujoco.mj_fwdPosition(self._model, data)
        own = self._mass.copy()
        with self._general.within():
            mujoco.mj_mulM(self._model, data, y, x)
            kernels.gather_twists.py_func(self._tree[0], self._tree[1], self._tree[3], x, twists)
            kernels.add_to_mass.py_func(*self._tree, added, self._mass)
            mujoco.mj_factorM(self._model, data)
            more = np.zeros(nv)
            mujoco.mj_mulM(self._model, data, more, x)
            mujoco.mj_solveM(self._model, data, z, more[None])
        self._mass[:] = own
        self._factor(data)
        if not (np.allclose(z[0], x, rtol=1e-6) and np.isclose(x @ (more - y), np.sum(twists**2), rtol=1e-6)):
            raise _another_way()


def _another_way() -> SolveError:
    return SolveError(
        f"MuJoCo {mujoco.__version__} keeps its mass matrix in another way than 3.1 and 3.2: pip install 'mujoco<3.3'"
    )
