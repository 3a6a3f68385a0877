"""Jacobian of modified Newton in a saved state: the place where it was computed last, so that it can be recomputed.

Modified Newton keeps a factorised Jacobian over many steps, and what an iteration leaves below its tolerance depends on
it. The engine hands no factors out. So the place where it was computed is kept, and an iteration is led back to it.
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
class Place:
    """All that a Jacobian depends on.

    time, step (s); q, v (m,), multipliers: of the engine; held: what Python keeps of joints and of the granular load;
    active: whether anything may touch the medium.
    """

    time: float
    step: float
    q: Vector
    v: Vector
    multipliers: Vector
    held: Arrays
    active: bool


class Tangent:
    """Watches where a solver computes its Jacobian, every few iterations; so the arrays of one place are written over.

    views: where the engine keeps its vectors, None where that is not known.
    """

    def __init__(self, system: System, solver: Any, simulation: Any) -> None:
        self.system, self.solver, self.simulation = system, solver, simulation
        self.views: Views | None = None
        self.before: Callable[..., None] | None = None  # what the engine calls before residuals of the solve
        self._it = solver.it
        batches = () if system.bed is None else system.bed.load.batches
        self._held = [*system.held, *(array for batch in batches for array in batch.state())]
        data = system.mbs.systemData
        size, multipliers = data.ODE2Size(), len(data.GetAECoordinates())
        self._time, self._step, self._active = math.nan, 0.0, False
        self._at = np.zeros(size), np.zeros(size), np.zeros(multipliers)
        self._pairs = [(array.copy(), array) for array in self._held]
        self._nothing = exu.MatrixContainer()
        self._nothing.SetWithSparseMatrix(np.zeros((0, 3)), size, size)
        # Full Newton computes it anew for each iteration, and keeps none.
        if simulation.timeIntegration.newton.useModifiedNewton:
            system.mbs.SetSystemJacobianUserFunction(self._watch)

    @property
    def place(self) -> Place | None:
        """The last one, None before the first."""
        if math.isnan(self._time):
            return None
        (q, v, multipliers), held = self._at, tuple(kept.copy() for kept, _ in self._pairs)
        return Place(self._time, self._step, q.copy(), v.copy(), multipliers.copy(), held, self._active)

    @place.setter
    def place(self, place: Place | None) -> None:
        self._time = math.nan
        if place is not None:
            self._time, self._step, self._active = place.time, place.step, place.active
            for array, kept in zip(self._at, (place.q, place.v, place.multipliers), strict=True):
                array[:] = kept
            for (array, _), kept in zip(self._pairs, place.held, strict=True):
                array[:] = kept

    def _watch(self, mbs: Any, t: float, *_: float) -> Any:
        """Called by the engine with each Jacobian; adds nothing to it."""
        views, (q, v, multipliers), bed = self.views or Views(mbs), self._at, self.system.bed
        self._time, self._step = t, self._it.currentStepSize
        q[:], v[:], multipliers[:] = views.q, views.v, views.multipliers
        for kept, now in self._pairs:
            kept[:] = now
        self._active = bed is not None and bed.load.active
        return self._nothing

    def recompute(self, place: Place) -> bool:
        """Compute the Jacobian of another time. Leaves state and bed of the system where it was computed.

        Returns whether the engine has computed it there, last.
        """
        mbs, solver, bed = self.system.mbs, self.solver, self.system.bed
        for now, kept in zip(self._held, place.held, strict=True):
            now[:] = kept
        if bed is not None:
            bed.evaluate_again(place.time, place.active)
        mbs.systemData.SetTime(place.time)
        solver.it.currentTime, solver.it.currentStepSize = place.time, place.step
        iterations, solver.newton.maxIterations = solver.newton.maxIterations, 1
        solver.conv.jacobianUpdateRequested = True
        mbs.SetPreNewtonResidualUserFunction(_leading_to(place))
        self._time = math.nan
        solver.Newton(mbs, self.simulation)
        mbs.SetPreNewtonResidualUserFunction(self.before or 0)
        solver.newton.maxIterations = iterations
        there = zip(self._at, (place.q, place.v, place.multipliers), strict=True)
        at_its_time = (self._time, self._step) == (place.time, place.step)
        return at_its_time and all(np.array_equal(now, kept) for now, kept in there)


def _leading_to(place: Place) -> Callable[..., None]:
    """Function that the engine calls before each residual of an iteration, the first of which it makes at a place."""

    def lead(mbs: Any, t: float, iteration: int, discontinuous: int) -> None:  # noqa: ARG001
        if iteration == 0:
            mbs.systemData.SetODE2Coordinates(place.q)
            mbs.systemData.SetODE2Coordinates_t(place.v)
            mbs.systemData.SetAECoordinates(place.multipliers)

    return lead
