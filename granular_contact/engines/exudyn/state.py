"""Saved state of a solve between two steps: all that later steps and the results depend on.

A restored solve continues bit for bit as the first time. So the state has, beside the motion, the friction state of bed
and joints, the algorithmic accelerations of the time scheme, the choice of steps, and the Jacobian that Newton's method
reuses (see `tangent`).
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
from granular_contact.engines.exudyn.tangent import LinearisationPoint, Tangent
from granular_contact.mechanics.system import System
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.coupling import CouplingState

COUNTS = ("newtonStepsCount", "newtonJacobiCount", "rejectedModifiedNewtonSteps")


@dataclass(frozen=True)
class SolveState:
    """State of the engine, of the objects that its steps call, and of the granular load.

    time (s). q, v, a (m,): coordinates, rates and accelerations; algorithmic (m,): accelerations of the time scheme.
    multipliers: Lagrange multipliers of the constraints. step: next step (s). jacobian_outdated: whether the Jacobian
    has to be computed anew. linearised_at: state at which the Jacobian was computed, None if none was. counts: COUNTS
    of the solver. joints: `System.held`. first_anchors: initial anchors of the friction in joints. recorded, control:
    attributes of the recorder and of the step control, which is None with fixed steps. iterations: arrays of the
    predictor. bed: None without a bed. solve: attributes of the solve itself.
    """

    time: float
    q: Vector
    v: Vector
    a: Vector
    algorithmic: Vector
    multipliers: Vector
    step: float
    jacobian_outdated: bool
    linearised_at: LinearisationPoint | None
    counts: tuple[int, ...]
    joints: tuple[Vector, ...]
    first_anchors: tuple[float, ...]
    recorded: dict[str, Any]
    control: dict[str, Any] | None
    iterations: tuple[NDArray[Any], ...]
    bed: CouplingState | None
    solve: dict[str, Any]


class Keeper:
    """Saves and restores states of a solve; made before the first step of the solve."""

    def __init__(
        self, system: System, solver: Any, recorder: Recorder, simulation: Any, predictor: Predictor | None
    ) -> None:
        self.predictor = predictor
        self.system, self.solver, self.recorder, self.simulation = system, solver, recorder, simulation
        self.tangent = Tangent(system, solver, simulation)
        self.tangent.pre_residual = predictor
        self._inexact = False  # whether the engine once failed to restore a Jacobian or accelerations

    def notices(self) -> list[str]:
        """Notice for the results if the steps after a restored state differ from the first time; else empty."""
        return [restore_notice()] if self._inexact else []

    def state(self, solve: dict[str, Any]) -> SolveState:
        """Copy of the present state; solve: attributes of the solve itself."""
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
            jacobian_outdated=solver.conv.jacobianUpdateRequested,
            linearised_at=self.tangent.point,
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
        """Return to a state of this solve, or of another solve of the same scene."""
        system, solver, recorder, data = self.system, self.solver, self.recorder, self.system.mbs.systemData
        system.mbs.SetRenderEngineStopFlag(False)  # a finished solve leaves it set
        outdated = kept.jacobian_outdated
        if kept.linearised_at is not None and not outdated:
            outdated = not self.tangent.recompute(kept.linearised_at)
            self._inexact |= outdated
        self.tangent.point = kept.linearised_at
        self._set_engine(kept, data)
        solver.conv.jacobianUpdateRequested = outdated
        self._inexact |= not np.array_equal(solver.GetAAlgorithmic(), kept.algorithmic)
        for name, count in zip(COUNTS, kept.counts, strict=True):
            setattr(solver.it, name, count)
        for array, saved in zip(system.held, kept.joints, strict=True):
            array[:] = saved
        if system.joints is not None:
            system.joints.time = math.nan  # so that the setpoints of drives are evaluated anew
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
        """Restore the engine's own state.

        The engine has no function that sets the algorithmic accelerations. But its initialisation copies the
        accelerations of the initial state to them, if it neither computes nor resets accelerations.
        """
        initial, scheme = exu.ConfigurationType.Initial, self.simulation.timeIntegration.generalizedAlpha
        data.SetODE2Coordinates(kept.q, initial)
        data.SetODE2Coordinates_t(kept.v, initial)
        data.SetODE2Coordinates_tt(kept.algorithmic, initial)
        computes, resets = scheme.computeInitialAccelerations, scheme.resetAccelerations
        scheme.computeInitialAccelerations = scheme.resetAccelerations = False
        self.solver.InitializeSolverInitialConditions(self.system.mbs, self.simulation)
        scheme.computeInitialAccelerations, scheme.resetAccelerations = computes, resets
        data.SetODE2Coordinates_tt(kept.a)
        data.SetAECoordinates(kept.multipliers)
        data.SetTime(kept.time)
        it = self.solver.it
        it.currentTime, it.currentStepSize = kept.time, kept.step
