"""Forces of an assembled system at rest, their tangent and the constraint residuals of its joints, from the engine.

At rest means that all rates are zero: drag and dampers have no force, bristles and springs their full force. Nothing of
the system is advanced by asking; `accept` drags the bristles to where it is.
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

DIFFERENCE_STEP = 1e-5  # m, or rad, of differences


class Balance:
    """Balance of a system with a fraction, 0 to 1, of its weight and of torques and forces of drives.

    size: number of coordinates; joined: of equations of joints. Times are pseudo-times below zero, where signals of
    drives are constant: one for each accepted state.
    """

    def __init__(self, system: System, places: int) -> None:
        self.system, self.mbs, self.data = system, system.mbs, system.mbs.systemData
        self._solver, self._settings = exu.MainSolverStatic(), exu.SimulationSettings()
        self._settings.solution.file.write = False
        self._settings.staticSolver.verboseMode = 0
        self._time = -1.0 - places
        self._solver.InitializeSolver(self.mbs, self._settings)
        self.size, self.joined = self._solver.GetODE2size(), self._solver.GetAEsize()
        self._rest = np.zeros(self.size)
        self._weight = np.zeros(self.size)
        for node, force in gravity_loads(system).items():
            self._weight[self.data.GetNodeLTGODE2(node)] += force
        self._driven = [load for load in system.loads.values() if load.drive is not None and load.drive.kind == "load"]
        self.accept(self.data.GetODE2Coordinates(exu.ConfigurationType.Initial))

    def at(self, q: Vector, share: float) -> tuple[Vector, Vector]:
        """Generalised forces (size,) without those of joints, and constraint residuals (joined,) m or rad, at q."""
        self.data.SetODE2Coordinates(q)
        self._solver.ComputeODE2RHS(self.mbs)
        self._solver.ComputeAlgebraicEquations(self.mbs, False)
        found = np.array(self._solver.GetSystemResidual())
        return found[: self.size] - (1.0 - share) * self.rising(q), found[self.size :]

    def rising(self, q: Vector) -> Vector:
        """Full generalised forces (size,) of weight and drives, of which a fraction acts."""
        return sum((self._of_drive(load, q) for load in self._driven), self._weight)

    def tangent(self) -> Vector:
        """Derivatives of forces and residuals at the last call of `at`, by coordinates and multipliers of joints.

        Square, (size + joined,); the multipliers' columns are generalised forces of joints.
        """
        self._solver.ComputeJacobianODE2RHS(self.mbs, 1.0, 0.0, 1.0)
        self._solver.ComputeJacobianAE(self.mbs, 1.0, 0.0, 1.0, False)
        return np.array(self._solver.GetSystemJacobian())

    def turning(self, q: Vector, multipliers: Vector) -> Vector:
        """Derivatives (size, size) of the generalised forces of joints, which turn with the bodies.

        The engine leaves them out of its tangent. By finite differences with a relative error of some 1e-5, which is
        enough for Newton's method.
        """
        n, found = self.size, np.zeros((self.size,) * 2)
        if not multipliers.any():
            return found
        self._solver.SetSystemJacobian(np.zeros((n + self.joined,) * 2))
        here, total = self._added(q, multipliers, np.zeros(n))
        for i in range(n):
            moved = q.copy()
            moved[i] += DIFFERENCE_STEP
            there, total = self._added(moved, multipliers, total)
            found[:, i] = (there - here) / DIFFERENCE_STEP
        self.data.SetODE2Coordinates(q)
        return found

    def _added(self, q: Vector, multipliers: Vector, before: Vector) -> tuple[Vector, Vector]:
        """Generalised forces of joints at q, and the sum of all that the engine has added up so far."""
        self.data.SetODE2Coordinates(q)
        self._solver.ComputeJacobianAE(self.mbs, 1.0, 0.0, 1.0, False)
        total = multipliers @ self._solver.GetSystemJacobian()[self.size :, : self.size]
        return total - before, total

    def accept(self, q: Vector) -> None:
        """Accept a state: bristles yield, and the next step starts from there."""
        q = np.ascontiguousarray(q)
        self._time += 1.0
        self._pass_on(q)
        if self.system.joints is not None:
            self.system.joints.accept(q, self._rest)
        if self.system.bed is not None:
            self.system.bed.accept_state(self._time, q, self._rest)
        self.data.SetTime(self._time + 1.0)

    def _pass_on(self, q: Vector) -> None:
        """Give the engine the start of a step, at rest."""
        for configuration in (exu.ConfigurationType.Current, exu.ConfigurationType.StartOfStep):
            self.data.SetODE2Coordinates(q, configuration=configuration)
            self.data.SetODE2Coordinates_t(np.zeros_like(q), configuration=configuration)
            self.data.SetTime(self._time, configuration)

    def _of_drive(self, load: JointLoad, q: Vector) -> Vector:
        """Generalised forces (size,) of the torque or force of a drive at its current time."""
        assert load.drive is not None  # of those that have one
        force = np.zeros(self.size)
        np.add.at(force, load.where, load.drive.signal.value(0.0) * load.slope(q))
        return force
