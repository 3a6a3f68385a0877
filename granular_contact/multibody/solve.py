"""Integrate an assembled system in time and keep every accepted step."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.errors import SolveError
from granular_contact.multibody.history import LoadHistory
from granular_contact.multibody.settle import settle
from granular_contact.multibody.system import System
from granular_contact.multibody.weights import mass_matrix
from granular_contact.results import Cost, Progress, Status
from granular_contact.scene.types import Scene, Vector


@dataclass(frozen=True)
class Trajectory:
    """Accepted steps of a solve, the start included.

    time (n,) s; q, v (n, m) coordinates (reference values included) and rates of the whole system; load: what the bed
    did, None without one; mass (m, m), sparse, constant for the bodies used here. reactions: torque (N m) or force (N)
    of prescribed motions, (n,) each, by joint.
    """

    status: Status
    cost: Cost
    time: Vector
    q: Vector
    v: Vector
    load: LoadHistory | None
    mass: Any
    reactions: dict[str, Vector]


def force_scale(scene: Scene) -> float:
    """Force (N) against which residuals are measured: weight, at least at 1 g, and the momentum of the impact.

    A link of mass m that enters at tip speed v and stops over a depth of the order of its length L needs m v^2 / L.
    """
    return scene.mass * (max(abs(scene.gravity), 9.81) + scene.speed**2 / max(scene.length, 1e-3))


def settings(scene: Scene) -> Any:
    """Exudyn's settings for a scene.

    Exudyn measures a residual against the first one of its step or against an absolute force. Stiff beams cannot get
    below their own round-off, about the axial stiffness times machine precision, so neither may be asked for less.
    """
    s = exu.SimulationSettings()
    t = s.timeIntegration
    t.endTime = scene.solver.end_time
    t.numberOfSteps = max(1, int(np.ceil(scene.solver.end_time / scene.solver.step - 1e-9)))
    t.minimumStepSize = 1e-4 * scene.solver.step
    t.generalizedAlpha.spectralRadius = scene.solver.spectral_radius
    t.verboseMode = 0
    round_off = 100.0 * np.finfo(float).eps * max((link.axial_stiffness for link in scene.links), default=0.0)
    t.newton.absoluteTolerance = max(scene.solver.tolerance * force_scale(scene), round_off)
    t.newton.relativeTolerance = 1e-8
    t.newton.useModifiedNewton = True
    s.solution.file.write = False
    s.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return s


class _Recorder:
    """Post-step function: keeps the accepted states, tells when to stop."""

    def __init__(self, system: System, progress: Progress | None) -> None:
        self.system = system
        self.solver = system.scene.solver
        self.progress = progress
        data = system.mbs.systemData
        self.size = data.ODE2Size()
        self.rows = 0
        self.states = np.empty((512, 1 + 2 * self.size))
        self.lever = _levers(system)
        self.multipliers = [data.GetObjectLTGAE(item)[0] for item in system.motions.values()]
        self.reactions: list[Vector] = []
        self.resting_since: float | None = None
        self.at_rest = False
        self.interrupted = False

    def __call__(self, mbs: Any, t: float) -> bool:
        data = mbs.systemData
        v = data.GetODE2Coordinates_t(copy=False)
        if self.rows == len(self.states):
            self.states = np.concatenate([self.states, np.empty_like(self.states)])
        row = self.states[self.rows]
        row[0] = t
        row[1 : 1 + self.size] = data.GetODE2Coordinates(copy=False)
        row[1 + self.size :] = v
        self.rows += 1
        if self.multipliers:
            self.reactions.append(data.GetAECoordinates()[self.multipliers])
        for load in self.system.loads.values():
            load.accept(row[1 : 1 + self.size], v)
        if self.system.bed is not None:
            self.system.bed.accept()
        if self.progress is not None and self.rows % 64 == 0:
            self.progress(t, self.solver.end_time)
        return not self._rests(t, v) and not self.interrupted

    def interrupt(self, _signal: int, _frame: FrameType | None) -> None:
        """Signal handler: stop after the step under way; asked again, at once."""
        if self.interrupted:
            raise KeyboardInterrupt
        self.interrupted = True

    def _rests(self, t: float, v: Vector) -> bool:
        if self.solver.rest_time is None or self.system.scene.drives:
            return False
        if np.abs(self.lever * v).max() > self.solver.rest_speed:
            self.resting_since = None
            return False
        if self.resting_since is None:
            self.resting_since = t
        self.at_rest = t - self.resting_since >= self.solver.rest_time
        return self.at_rest


def _levers(system: System) -> Vector:
    """Factors (m,) from coordinate rates to speeds of points (m/s): 1 for positions, a body's radius for its angle."""
    data = system.mbs.systemData
    lever = np.zeros(data.ODE2Size())
    for rigid in system.rigid.values():
        radius = max((float(np.linalg.norm(p)) for shape in rigid.body.shapes for p in shape.points), default=0.0)
        lever[data.GetNodeLTGODE2(rigid.node)] = 1.0, 1.0, radius
    for link in system.links.values():
        for node in link.nodes:
            lever[data.GetNodeLTGODE2(node)] = 1.0, 1.0, 0.0, 0.0
    return lever


@contextmanager
def _on_interrupt(handler: Callable[[int, FrameType | None], None]) -> Iterator[None]:
    """Let a handler take Ctrl-C; only the main thread may."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextmanager
def _silent() -> Iterator[None]:
    """Keep the engine from printing; how a run ended is told by its status."""
    before = exu.config.printToConsole
    exu.config.printToConsole = False
    try:
        yield
    finally:
        exu.config.printToConsole = before


def solve(system: System, progress: Progress | None = None, simulation: Any = None) -> Trajectory:
    """Run the scene to its end time, to rest, to a failure or to Ctrl-C; what was reached by then is kept.

    simulation: Exudyn's settings, those of `settings` unless given.
    """
    mbs, scene = system.mbs, system.scene
    if simulation is None:
        simulation = settings(scene)
    recorder = _Recorder(system, progress)
    solver = exu.MainSolverImplicitSecondOrder()
    problem, success = "", False
    with _on_interrupt(recorder.interrupt), _silent():
        if scene.settle:
            settle(system, simulation, recorder.lever)
        mbs.SetPostStepUserFunction(recorder)
        began = time.perf_counter()
        try:
            success = solver.SolveSystem(mbs, simulation)
        except (exu.ExudynError, RuntimeError) as error:
            problem = str(error).strip().splitlines()[0]
        seconds = time.perf_counter() - began
    if recorder.rows == 0:
        raise SolveError(f"the engine could not begin: {problem or 'it gave no reason'}")
    states, count = recorder.states[: recorder.rows], recorder.size
    return Trajectory(
        status=_status(scene, recorder, success, problem, solver),
        cost=Cost(
            solve_s=seconds,
            steps=recorder.rows - 1,
            newton_iterations=solver.it.newtonStepsCount,
            jacobians=solver.it.newtonJacobiCount,
            load_calls=0 if system.bed is None else system.bed.load_calls,
        ),
        time=states[:, 0],
        q=states[:, 1 : 1 + count] + mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference),
        v=states[:, 1 + count :],
        load=None if system.bed is None else system.bed.accepted.since(0.0),
        mass=mass_matrix(system),
        # A multiplier pulls the constraint back; the drive pushes along the coordinate.
        reactions={
            name: -values for name, values in zip(system.motions, np.transpose(recorder.reactions), strict=True)
        },
    )


def _status(scene: Scene, recorder: _Recorder, success: bool, problem: str, solver: Any) -> Status:
    t = recorder.states[recorder.rows - 1, 0]
    if recorder.interrupted:
        return Status("interrupted", f"interrupted at {t:.6g} s; the results up to there were kept")
    if not success:
        reason = problem or "Newton's method did not converge"
        step = solver.it.currentStepSize
        return Status(
            "failed",
            f"{reason} at {t:.6g} s, with the step reduced to {step:.2g} s; take a smaller solver.step_s "
            f"(now {scene.solver.step:g}) or, for a very soft or very stiff link, more elements",
        )
    if recorder.at_rest:
        return Status(
            "rest", f"at rest: slower than {scene.solver.rest_speed:g} m/s everywhere for {scene.solver.rest_time:g} s"
        )
    return Status("end_time", f"end time {scene.solver.end_time:g} s reached")
