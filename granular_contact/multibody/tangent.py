"""Where the engine's Jacobian was computed last, so that it can be computed there again.

Modified Newton keeps a factorised Jacobian over many steps, and what an iteration leaves below its tolerance depends on
it. The engine hands no factors out. So the place where it was computed is kept, and an iteration is led back to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np

from granular_contact.multibody.system import System
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.multibody.coupling import Acting


@dataclass(frozen=True)
class Place:
    """All that a Jacobian depends on.

    time, step (s); q, v (m,), multipliers: of the engine; joints: anchor and what a drive is set to, by the order of
    the system's loads; turns: of its ends; bed: of its granular load, None without one.
    """

    time: float
    step: float
    q: Vector
    v: Vector
    multipliers: Vector
    joints: tuple[tuple[float, float | None], ...]
    turns: tuple[float, ...]
    bed: Acting | None


class Tangent:
    """Watches where a solver computes its Jacobian; `place`: the last one, None before the first."""

    def __init__(self, system: System, solver: Any, simulation: Any) -> None:
        self.system, self.solver, self.simulation = system, solver, simulation
        self.place: Place | None = None
        self.before: Callable[..., None] | None = None  # what the engine calls before residuals of the solve
        self._nothing = exu.MatrixContainer()
        size = system.mbs.systemData.ODE2Size()
        self._nothing.SetWithSparseMatrix(np.zeros((0, 3)), size, size)
        # Full Newton computes it anew for each iteration, and keeps none.
        if simulation.timeIntegration.newton.useModifiedNewton:
            system.mbs.SetSystemJacobianUserFunction(self._watch)

    def _watch(self, mbs: Any, t: float, *_: float) -> Any:
        """Called by the engine with each Jacobian; adds nothing to it."""
        data, bed = mbs.systemData, self.system.bed
        self.place = Place(
            time=t,
            step=self.solver.it.currentStepSize,
            q=data.GetODE2Coordinates(),
            v=data.GetODE2Coordinates_t(),
            multipliers=data.GetAECoordinates(),
            joints=joint_states(self.system),
            turns=turns(self.system),
            bed=None if bed is None else bed.acting,
        )
        return self._nothing

    def again(self, place: Place) -> None:
        """Compute the Jacobian of another time. Leaves state and bed of the system where it was computed."""
        mbs, solver, bed = self.system.mbs, self.solver, self.system.bed
        set_joints(self.system, place.joints)
        set_turns(self.system, place.turns)
        if bed is not None and place.bed is not None:
            bed.act(place.time, place.bed)
        mbs.systemData.SetTime(place.time)
        solver.it.currentTime, solver.it.currentStepSize = place.time, place.step
        iterations, solver.newton.maxIterations = solver.newton.maxIterations, 1
        solver.conv.jacobianUpdateRequested = True
        mbs.SetPreNewtonResidualUserFunction(_leading_to(place))
        solver.Newton(mbs, self.simulation)
        mbs.SetPreNewtonResidualUserFunction(self.before or 0)
        solver.newton.maxIterations = iterations


def _leading_to(place: Place) -> Callable[..., None]:
    """Function that the engine calls before each residual of an iteration, the first of which it makes at a place."""

    def lead(mbs: Any, t: float, iteration: int, discontinuous: int) -> None:  # noqa: ARG001
        if iteration == 0:
            mbs.systemData.SetODE2Coordinates(place.q)
            mbs.systemData.SetODE2Coordinates_t(place.v)
            mbs.systemData.SetAECoordinates(place.multipliers)

    return lead


# ---- what Python keeps of joints ----


def joint_states(system: System) -> tuple[tuple[float, float | None], ...]:
    """Anchor of each joint's friction, and what its drive is set to from outside."""
    return tuple((load.anchor, load.set_to) for load in system.loads.values())


def set_joints(system: System, states: tuple[tuple[float, float | None], ...]) -> None:
    """Bring joints to such states."""
    for load, (anchor, set_to) in zip(system.loads.values(), states, strict=True):
        load.anchor, load.set_to = anchor, set_to


def turns(system: System) -> tuple[float, ...]:
    """Angles (rad) by which the ends of joints count the turns of flexible links."""
    return tuple(float(angle) for one in system.turning_ends for angle in one.turns)


def set_turns(system: System, angles: tuple[float, ...]) -> None:
    """Bring ends to such angles."""
    left = iter(angles)
    for one in system.turning_ends:
        one.turns[:] = [next(left) for _ in one.turns]
