"""Steps of MuJoCo that are taken back, and how their ends depend on forces: what Newton's method needs of an engine.

All by MuJoCo's public functions, on the data that is stepped; the model is read alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.engine import mujoco
from granular_contact.engines.mujoco.kernels.added_mass import add_damping
from granular_contact.jit.compiled import bound

Vector = NDArray[np.float64]
_IMPLICIT = (int(mujoco.mjtIntegrator.mjINT_IMPLICIT), int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST))
_DISCRETE = int(getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", -1))  # from 3.13 on
_UNDAMPED = int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
_QUADRATIC = int(mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC)
MASS_OF_DATA = tuple(int(part) for part in mujoco.__version__.split(".")[:2]) >= (3, 10)
STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS | mujoco.mjtState.mjSTATE_WARMSTART)


class Trial:
    """Steps of one MjData from its present state, whose positions have to be up to date.

    state: what is kept of it; matrix (nv, nv): of `resistance`, to which damp() adds by the shares of
    `kernels.added_mass.add_damping`.
    """

    def __init__(self, model: Any, data: Any) -> None:
        self._model, self._option = model, model.opt
        self.state = np.zeros(mujoco.mj_stateSize(model, STATE))
        self.matrix = np.zeros((model.nv, model.nv))
        of = model if hasattr(model, "D_rowadr") else data  # the data's up to 3.2
        self.shares = np.zeros(2)
        pattern = of.D_rowadr, of.D_rownnz, of.D_colind
        self.damp = bound(add_damping, *pattern, data.qDeriv, model.dof_damping, self.shares, self.matrix)

    def keep(self, data: Any) -> None:
        """Remember the state, and find what the steps from it have in common."""
        mujoco.mj_getState(self._model, data, self.state, STATE)
        mujoco.mj_fwdVelocity(self._model, data)

    def make(self, data: Any) -> None:
        """Make a step with the forces that are applied to data."""
        mujoco.mj_step2(self._model, data)

    def take_back(self, data: Any) -> None:
        """Go back to the state that is kept."""
        mujoco.mj_setState(self._model, data, self.state, STATE)

    def resistance(self, data: Any, step: float) -> bool:
        """Fill matrix with how forces along degrees of freedom grow with the accelerations in the step (s) just made.

        That is M + h D + J^T W J, with the damping D that the integrator takes as implicit, and the weights W of the
        constraints that pushed. Returns whether it is all there is, so that Newton's method ends after one correction.
        """
        _full_mass(self._model, data, self.matrix)
        option, exact = self._option, data.nefc == 0
        integrator = int(option.integrator)
        euler = integrator not in _IMPLICIT and not int(option.disableflags) & _UNDAMPED
        self.shares[:] = -step if integrator in _IMPLICIT else 0.0, step if euler else 0.0
        self.damp()
        if data.nefc:
            rows = _rows(self._model, data)
            weights = np.where(data.efc_state == _QUADRATIC, data.efc_D, 0.0)
            self.matrix += (rows.T * weights) @ rows
        return exact and integrator != _DISCRETE  # whose metric has more, of actuators and tendons


def _rows(model: Any, data: Any) -> Vector:
    """Jacobian (nefc, nv) of the constraints."""
    count = data.nefc
    if not mujoco.mj_isSparse(model):
        rows: Vector = data.efc_J.reshape(count, model.nv)
        return rows
    rows = np.zeros((count, model.nv))
    for i, (first, n) in enumerate(zip(data.efc_J_rowadr, data.efc_J_rownnz, strict=True)):
        rows[i, data.efc_J_colind[first : first + n]] = data.efc_J.ravel()[first : first + n]
    return rows


def _full_mass(model: Any, data: Any, matrix: Vector) -> None:
    if MASS_OF_DATA:
        mujoco.mj_fullM(model, data, matrix)
    else:
        mujoco.mj_fullM(model, matrix, data.qM)
