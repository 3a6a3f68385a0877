"""Jacobian of the modified Newton method in a saved state: the state at which it was computed, to recompute it there.

Modified Newton reuses a factorised Jacobian over many steps, and the residual that it leaves within its tolerance
depends on that Jacobian. The engine does not give access to the factors. So the state of the last factorisation is
saved, and an iteration of Newton's method is started at that state again.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.views import Views
from granular_contact.mechanics.system import System
from granular_contact.scene.types import Vector

Arrays = tuple[NDArray[Any], ...]


@dataclass(frozen=True)
class LinearisationPoint:
    """State at which a Jacobian was computed: all that the Jacobian depends on.

    time, step (s). q, v (m,), multipliers: of the engine. held: arrays of the joints and of the granular load. active:
    whether anything could touch the medium in that step.
    """

    time: float
    step: float
    q: Vector
    v: Vector
    multipliers: Vector
    held: Arrays
    active: bool


class Tangent:
    """Keeps the state at which a solver computed its Jacobian last, and recomputes it there.

    The engine computes a Jacobian every few iterations; so one set of arrays is overwritten each time. views: the
    engine's vectors in the present part of the solve. pre_residual: function that the engine calls before residuals of
    the solve.
    """

    def __init__(self, system: System, solver: Any, simulation: Any) -> None:
        self.system, self.solver, self.simulation = system, solver, simulation
        self.views: Views | None = None
        self.pre_residual: Callable[..., None] | None = None
        self._it = solver.it
        batches = () if system.bed is None else system.bed.load.batches
        self._held = [*system.held, *(array for batch in batches for array in batch.state())]
        data = system.mbs.systemData
        size, multipliers = data.ODE2Size(), len(data.GetAECoordinates())
        self._time, self._step, self._active = math.nan, 0.0, False
        self._vectors = np.zeros(size), np.zeros(size), np.zeros(multipliers)  # q, v and multipliers
        self._copies = [(array.copy(), array) for array in self._held]  # each copy with its original
        self._zero_matrix = exu.MatrixContainer()
        self._zero_matrix.SetWithSparseMatrix(np.zeros((0, 3)), size, size)
        # Full Newton computes a Jacobian in each iteration and reuses none.
        if simulation.timeIntegration.newton.useModifiedNewton:
            system.mbs.SetSystemJacobianUserFunction(self._note_state)

    @property
    def point(self) -> LinearisationPoint | None:
        """State of the last Jacobian (a copy), None before the first Jacobian."""
        if math.isnan(self._time):
            return None
        (q, v, multipliers), held = self._vectors, tuple(copy.copy() for copy, _ in self._copies)
        return LinearisationPoint(self._time, self._step, q.copy(), v.copy(), multipliers.copy(), held, self._active)

    @point.setter
    def point(self, point: LinearisationPoint | None) -> None:
        self._time = math.nan
        if point is not None:
            self._time, self._step, self._active = point.time, point.step, point.active
            for array, values in zip(self._vectors, (point.q, point.v, point.multipliers), strict=True):
                array[:] = values
            for (copy, _), values in zip(self._copies, point.held, strict=True):
                copy[:] = values

    def _note_state(self, mbs: Any, t: float, *_: float) -> Any:
        """Jacobian function of the engine: note the present state, and add nothing to the Jacobian."""
        views, (q, v, multipliers), bed = self.views or Views(mbs), self._vectors, self.system.bed
        self._time, self._step = t, self._it.currentStepSize
        q[:], v[:], multipliers[:] = views.q, views.v, views.multipliers
        for copy, array in self._copies:
            copy[:] = array
        self._active = bed is not None and bed.load.active
        return self._zero_matrix

    def recompute(self, point: LinearisationPoint) -> bool:
        """Let the engine compute the Jacobian at a point; state and bed of the system stay there.

        Returns whether the last Jacobian that the engine computed is the one at that point.
        """
        mbs, solver, bed = self.system.mbs, self.solver, self.system.bed
        for array, values in zip(self._held, point.held, strict=True):
            array[:] = values
        if bed is not None:
            bed.evaluate_again(point.time, point.active)
        mbs.systemData.SetTime(point.time)
        solver.it.currentTime, solver.it.currentStepSize = point.time, point.step
        iterations, solver.newton.maxIterations = solver.newton.maxIterations, 1
        solver.conv.jacobianUpdateRequested = True
        mbs.SetPreNewtonResidualUserFunction(_starting_at(point))
        self._time = math.nan
        solver.Newton(mbs, self.simulation)
        mbs.SetPreNewtonResidualUserFunction(self.pre_residual or 0)
        solver.newton.maxIterations = iterations
        same_time = (self._time, self._step) == (point.time, point.step)
        vectors = zip(self._vectors, (point.q, point.v, point.multipliers), strict=True)
        return same_time and all(np.array_equal(noted, saved) for noted, saved in vectors)


def _starting_at(point: LinearisationPoint) -> Callable[..., None]:
    """Function for the engine to call before residuals: it starts Newton's method at a point."""

    def pre_residual(mbs: Any, t: float, iteration: int, discontinuous: int) -> None:  # noqa: ARG001
        if iteration == 0:
            mbs.systemData.SetODE2Coordinates(point.q)
            mbs.systemData.SetODE2Coordinates_t(point.v)
            mbs.systemData.SetAECoordinates(point.multipliers)

    return pre_residual
