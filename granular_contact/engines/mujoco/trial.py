"""Trial steps of MuJoCo, which are taken back, and the matrix of their forces by accelerations, for Newton's method.

Only public functions of MuJoCo are used, on the data that is stepped; the model is only read.
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
# From MuJoCo 3.10 on `mj_fullM` takes data in place of the sparse mass matrix.
FULL_M_TAKES_DATA = tuple(int(part) for part in mujoco.__version__.split(".")[:2]) >= (3, 10)
STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS | mujoco.mjtState.mjSTATE_WARMSTART)


class Trial:
    """Trial steps of one MjData from its present state, whose positions must be up to date.

    state: MuJoCo's saved state. matrix (nv, nv): see `fill_matrix`. damp(): adds damping to matrix by `shares`, see
    `kernels.added_mass.add_damping`.
    """

    def __init__(self, model: Any, data: Any) -> None:
        self._model, self._option = model, model.opt
        self.state = np.zeros(mujoco.mj_stateSize(model, STATE))
        self.matrix = np.zeros((model.nv, model.nv))
        owner = model if hasattr(model, "D_rowadr") else data  # data has the sparsity pattern up to MuJoCo 3.2
        self.shares = np.zeros(2)
        pattern = owner.D_rowadr, owner.D_rownnz, owner.D_colind
        self.damp = bound(add_damping, *pattern, data.qDeriv, model.dof_damping, self.shares, self.matrix)

    def save(self, data: Any) -> None:
        """Save the state, and compute what all steps from it have in common."""
        mujoco.mj_getState(self._model, data, self.state, STATE)
        mujoco.mj_fwdVelocity(self._model, data)

    def make(self, data: Any) -> None:
        """Make a step with the forces in `xfrc_applied` of data."""
        mujoco.mj_step2(self._model, data)

    def restore(self, data: Any) -> None:
        """Return to the saved state."""
        mujoco.mj_setState(self._model, data, self.state, STATE)

    def fill_matrix(self, data: Any, step: float) -> bool:
        """Fill matrix with the derivative of generalised forces by accelerations in the step (s) just made.

        It is M + h D + J^T W J: mass matrix M, damping D that the integrator treats implicitly, Jacobian J of the
        constraints, and weights W of the active ones. Returns whether that is exact, so that Newton's method ends after
        one correction.
        """
        _fill_mass_matrix(self._model, data, self.matrix)
        option, exact = self._option, data.nefc == 0
        integrator = int(option.integrator)
        euler = integrator not in _IMPLICIT and not int(option.disableflags) & _UNDAMPED
        self.shares[:] = -step if integrator in _IMPLICIT else 0.0, step if euler else 0.0
        self.damp()
        if data.nefc:
            jacobian = _constraint_jacobian(self._model, data)
            weights = np.where(data.efc_state == _QUADRATIC, data.efc_D, 0.0)
            self.matrix += (jacobian.T * weights) @ jacobian
        return exact and integrator != _DISCRETE  # its matrix also has terms of actuators and tendons


def _constraint_jacobian(model: Any, data: Any) -> Vector:
    """Jacobian (nefc, nv) of the constraints, dense."""
    count = data.nefc
    if not mujoco.mj_isSparse(model):
        jacobian: Vector = data.efc_J.reshape(count, model.nv)
        return jacobian
    jacobian = np.zeros((count, model.nv))
    for i, (first, n) in enumerate(zip(data.efc_J_rowadr, data.efc_J_rownnz, strict=True)):
        jacobian[i, data.efc_J_colind[first : first + n]] = data.efc_J.ravel()[first : first + n]
    return jacobian


def _fill_mass_matrix(model: Any, data: Any, matrix: Vector) -> None:
    """Fill matrix (nv, nv) with the mass matrix."""
    if FULL_M_TAKES_DATA:
        mujoco.mj_fullM(model, data, matrix)
    else:
        mujoco.mj_fullM(model, matrix, data.qM)
