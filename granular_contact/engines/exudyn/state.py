"""State of a solve between two steps: all that its future and its results depend on, to go back to it later.

The future is the same bit for bit: beside the motion there are the friction state of bed and joints, the algorithmic
acceleration of the scheme, the choice of steps, and the Jacobian that Newton's method goes on with (see `tangent`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.engine_checks import restore_notice
from granular_contact.engines.exudyn.predictor import Predictor
from granular_contact.engines.exudyn.recorder import Recorder
from granular_contact.engines.exudyn.tangent import Place, Tangent
from granular_contact.mechanics.system import System
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.coupling import CouplingState

COUNTS = ("newtonStepsCount", "newtonJacobiCount", "rejectedModifiedNewtonSteps")


@dataclass(frozen=True)
class SolveState:
    """Of the engine, of what follows its steps, and of the granular load.

    time (s); q, v, a, algorithmic (m,): coordinates, rates, accelerations and those of the scheme; multipliers: of
    constraints. outdated, place: whether the Jacobian no longer serves, and where it was computed. joints: as
    `System.held`. recorded, control: fields of the recorder and of the choice of steps. iterations: of `predictor`.
    bed: None without one. solve: fields of the solve itself.
    """

    time: float
    q: Vector
    v: Vector
    a: Vector
    algorithmic: Vector
    multipliers: Vector
    step: float
    outdated: bool
    place: Place | None
    counts: tuple[int, ...]
    joints: tuple[Vector, ...]
    first_anchors: tuple[float, ...]
    recorded: dict[str, Any]
    control: dict[str, Any] | None
    iterations: tuple[NDArray[Any], ...]
    bed: CouplingState | None
    solve: dict[str, Any]


class Keeper:
    """Takes states of a solve, and goes back to them; made before its first step."""

    def __init__(
        self, system: System, solver: Any, recorder: Recorder, simulation: Any, predictor: Predictor | None
    ) -> None:
        self.predictor = predictor
        self.system, self.solver, self.recorder, self.simulation = system, solver, recorder, simulation
        self.tangent = Tangent(system, solver, simulation)
        self.tangent.before = predictor
        self._anew = False  # whether the engine once did not go back to a Jacobian or to accelerations

    def notices(self) -> list[str]:
        """Of states that it went back to, a sentence where what followed is not the same bit for bit."""
        return [restore_notice()] if self._anew else []

    def state(self, solve: dict[str, Any]) -> SolveState:
        """The present state; solve: fields of the solve itself."""
        system, solver, data = self.system, self.solver, self.system.mbs.systemData
        control = self.recorder.control
        return SolveState(
            time=data.GetTime(),
            q=data.GetODE2Coordinates(),
            v=data.GetODE2Coordinates_t(),
            a=data.GetODE2Coordinates_tt(),
            algorithmic=solver.GetAAlgorithmic(),
            multipliers=data.GetAECoordinates(),
            step=solver.it.currentStepSize,
            outdated=solver.conv.jacobianUpdateRequested,
            place=self.tangent.place,
            counts=tuple(getattr(solver.it, name) for name in COUNTS),
            joints=tuple(array.copy() for array in system.held),
            first_anchors=tuple(load.first_anchor for load in system.loads.values()),
            recorded=self.recorder.kept(),
            control=None if control is None else control.kept(),
            iterations=() if self.predictor is None else self.predictor.kept,
            bed=None if system.bed is None else system.bed.kept,
            solve=solve,
        )

    def restore(self, kept: SolveState) -> None:
        """Go back to a state of a solve of the same scene."""
        system, solver, recorder, data = self.system, self.solver, self.recorder, self.system.mbs.systemData
        system.mbs.SetRenderEngineStopFlag(False)  # what a finished solve left
        outdated = kept.outdated
        if kept.place is not None and not outdated:
            outdated = not self.tangent.recompute(kept.place)
            self._anew |= outdated
        self.tangent.place = kept.place
        self._set_engine(kept, data)
        solver.conv.jacobianUpdateRequested = outdated
        self._anew |= not np.array_equal(solver.GetAAlgorithmic(), kept.algorithmic)
        for name, count in zip(COUNTS, kept.counts, strict=True):
            setattr(solver.it, name, count)
        for array, old in zip(system.held, kept.joints, strict=True):
            array[:] = old
        if system.joints is not None:
            system.joints.time = math.nan  # what drives want is asked for anew
        for load, anchor in zip(system.loads.values(), kept.first_anchors, strict=True):
            load.first_anchor = anchor
        recorder.restore(kept.recorded)
        if recorder.control is not None and kept.control is not None:
            recorder.control.restore(kept.control)
        if self.predictor is not None:
            self.predictor.restore(kept.iterations)
        if system.bed is not None and kept.bed is not None:
            system.bed.restore(kept.bed)

    def _set_engine(self, kept: SolveState, data: Any) -> None:
        """Bring the engine's own state back; its scheme takes the accelerations of an initial state for its own."""
        start, scheme = exu.ConfigurationType.Initial, self.simulation.timeIntegration.generalizedAlpha
        data.SetODE2Coordinates(kept.q, start)
        data.SetODE2Coordinates_t(kept.v, start)
        data.SetODE2Coordinates_tt(kept.algorithmic, start)
        computes, resets = scheme.computeInitialAccelerations, scheme.resetAccelerations
        scheme.computeInitialAccelerations = scheme.resetAccelerations = False
        self.solver.InitializeSolverInitialConditions(self.system.mbs, self.simulation)
        scheme.computeInitialAccelerations, scheme.resetAccelerations = computes, resets
        data.SetODE2Coordinates_tt(kept.a)
        data.SetAECoordinates(kept.multipliers)
        data.SetTime(kept.time)
        it = self.solver.it
        it.currentTime, it.currentStepSize = kept.time, kept.step
