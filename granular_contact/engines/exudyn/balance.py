"""Forces of an assembled system at rest, their tangent, and the constraint residuals of its joints, from the engine.

At rest all rates are zero: drag and dampers have no force; bristles and springs have their full force. An evaluation
does not change the state of the system; `accept` lets bristles yield at a state.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import exudyn as exu
import numpy as np

from granular_contact.mechanics.mass_and_gravity import gravity_loads
from granular_contact.mechanics.system import System
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.joint_loads import JointLoad

DIFFERENCE_STEP = 1e-5  # step of finite differences (m or rad)


class Balance:
    """Balance of forces of a system with a share of its weight and of the torques and forces of drives.

    size: number of coordinates. constraints: number of constraint equations of joints. The engine's time is a
    pseudo-time below zero, where signals of drives are constant; each accepted state has its own. most_states: upper
    bound of the number of accepted states.
    """

    def __init__(self, system: System, most_states: int) -> None:
        self.system, self.mbs, self.data = system, system.mbs, system.mbs.systemData
        self._solver, self._settings = exu.MainSolverStatic(), exu.SimulationSettings()
        self._settings.solution.file.write = False
        self._settings.staticSolver.verboseMode = 0
        self._time = -1.0 - most_states
        self._solver.InitializeSolver(self.mbs, self._settings)
        self.size, self.constraints = self._solver.GetODE2size(), self._solver.GetAEsize()
        self._zero_rates = np.zeros(self.size)
        self._weight = np.zeros(self.size)
        for node, force in gravity_loads(system).items():
            self._weight[self.data.GetNodeLTGODE2(node)] += force
        self._driven = [load for load in system.loads.values() if load.drive is not None and load.drive.kind == "load"]
        self.accept(self.data.GetODE2Coordinates(exu.ConfigurationType.Initial))

    def at(self, q: Vector, share: float) -> tuple[Vector, Vector]:
        """Generalised forces (size,) without those of constraints, and constraint residuals (constraints,), at q.

        share: share of the weight and of the drives' forces that acts. Residuals are in m or rad.
        """
        self.data.SetODE2Coordinates(q)
        self._solver.ComputeODE2RHS(self.mbs)
        self._solver.ComputeAlgebraicEquations(self.mbs, False)
        residual = np.array(self._solver.GetSystemResidual())
        return residual[: self.size] - (1.0 - share) * self.rising(q), residual[self.size :]

    def rising(self, q: Vector) -> Vector:
        """Generalised forces (size,) that rise with the share: the full weight, and the full forces of drives, at q."""
        return sum((self._drive_force(load, q) for load in self._driven), self._weight)

    def tangent(self) -> Vector:
        """Derivatives of forces and residuals at the last call of `at`, by coordinates and multipliers of joints.

        Square, with size + constraints rows; the columns of multipliers are the generalised forces of unit multipliers.
        """
        self._solver.ComputeJacobianODE2RHS(self.mbs, 1.0, 0.0, 1.0)
        self._solver.ComputeJacobianAE(self.mbs, 1.0, 0.0, 1.0, False)
        return np.array(self._solver.GetSystemJacobian())

    def turning(self, q: Vector, multipliers: Vector) -> Vector:
        """Geometric stiffness (size, size): derivatives of the forces of joints, which turn with the bodies, by q.

        The engine leaves them out of its tangent. They are found by finite differences, with a relative error of some
        1e-5, which is enough for Newton's method.
        """
        n, derivatives = self.size, np.zeros((self.size,) * 2)
        if not multipliers.any():
            return derivatives
        self._solver.SetSystemJacobian(np.zeros((n + self.constraints,) * 2))
        force, total = self._joint_forces(q, multipliers, np.zeros(n))
        for i in range(n):
            shifted = q.copy()
            shifted[i] += DIFFERENCE_STEP
            shifted_force, total = self._joint_forces(shifted, multipliers, total)
            derivatives[:, i] = (shifted_force - force) / DIFFERENCE_STEP
        self.data.SetODE2Coordinates(q)
        return derivatives

    def _joint_forces(self, q: Vector, multipliers: Vector, total_before: Vector) -> tuple[Vector, Vector]:
        """Generalised forces of joints at q, and the total of all calls so far.

        The engine adds the gradients of each evaluation to its matrix; total_before: the total of the last call.
        """
        self.data.SetODE2Coordinates(q)
        self._solver.ComputeJacobianAE(self.mbs, 1.0, 0.0, 1.0, False)
        total = multipliers @ self._solver.GetSystemJacobian()[self.size :, : self.size]
        return total - total_before, total

    def accept(self, q: Vector) -> None:
        """Accept a state at rest as the end of a step: bristles yield, and the next step starts from q."""
        q = np.ascontiguousarray(q)
        self._time += 1.0
        self._set_start(q)
        if self.system.joints is not None:
            self.system.joints.accept(q, self._zero_rates)
        if self.system.bed is not None:
            self.system.bed.accept_state(self._time, q, self._zero_rates)
        self.data.SetTime(self._time + 1.0)

    def _set_start(self, q: Vector) -> None:
        """Give the engine the initial state of a step, at rest."""
        for configuration in (exu.ConfigurationType.Current, exu.ConfigurationType.StartOfStep):
            self.data.SetODE2Coordinates(q, configuration=configuration)
            self.data.SetODE2Coordinates_t(np.zeros_like(q), configuration=configuration)
            self.data.SetTime(self._time, configuration)

    def _drive_force(self, load: JointLoad, q: Vector) -> Vector:
        """Generalised forces (size,) of the torque or force of a drive, with its signal at t = 0."""
        assert load.drive is not None  # `_driven` has drives alone
        force = np.zeros(self.size)
        np.add.at(force, load.where, load.drive.signal.value(0.0) * load.slope(q))
        return force
