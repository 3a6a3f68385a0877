"""Integrate an assembled system in time and keep every accepted step."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.errors import SolveError
from granular_contact.multibody.ending import status
from granular_contact.multibody.mass_and_gravity import mass_matrix
from granular_contact.multibody.recorder import Recorder
from granular_contact.multibody.settings import control_steps, settings
from granular_contact.multibody.settle import settle
from granular_contact.multibody.stepping import StepControl
from granular_contact.multibody.system import System, Trajectory
from granular_contact.results import Cost, Progress
from granular_contact.scene.types import FASTEST


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
    """Run the scene to its end time, to rest, to a limit, to a failure or to Ctrl-C; what was reached by then is kept.

    simulation: Exudyn's settings, those of `settings` unless given.
    """
    mbs, scene = system.mbs, system.scene
    if simulation is None:
        simulation = settings(scene)
    recorder = Recorder(system, progress)
    solver = exu.MainSolverImplicitSecondOrder()
    problem, success = "", False
    with _on_interrupt(recorder.interrupt), _silent():
        if scene.settle:
            settle(system, recorder)
        if scene.solver.accuracy is not None:
            recorder.control = StepControl(system, solver, recorder.lever, scene.solver.accuracy)
            mbs.SetPostNewtonUserFunction(recorder.control)
            control_steps(simulation, recorder.control)
        mbs.SetPostStepUserFunction(recorder)
        if system.bed is not None:
            system.bed.accept()  # loads its kernels, which is no part of the solve
        began = time.perf_counter()
        try:
            success = solver.SolveSystem(mbs, simulation)
        except (exu.ExudynError, RuntimeError) as error:
            problem = str(error).strip().splitlines()[0]
        seconds = time.perf_counter() - began
    if recorder.rows == 0:
        fast = (
            f"a speed at the start is not below {FASTEST:g} m/s (or rad/s): give a slower one"
            if recorder.reason == "away"
            else ""
        )
        raise SolveError(f"the engine could not begin: {problem or fast or 'it gave no reason'}")
    states, count = recorder.states[: recorder.rows], recorder.size
    return Trajectory(
        status=status(recorder, success, problem, solver.it.currentStepSize),
        cost=Cost(
            solve_s=seconds,
            steps=recorder.rows - 1,
            newton_iterations=solver.it.newtonStepsCount,
            jacobians=solver.it.newtonJacobiCount,
            load_calls=0 if system.bed is None else system.bed.load_calls,
            full_newton=solver.it.rejectedModifiedNewtonSteps,
            shortened_steps=recorder.shortened,
            refused_steps=0 if recorder.control is None else recorder.control.refused,
        ),
        time=states[:, 0],
        q=states[:, 1 : 1 + count] + mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference),
        v=states[:, 1 + count :],
        load=None if system.bed is None else system.bed.load.history.since(0.0),
        mass=mass_matrix(system),
        # A multiplier pulls the constraint back; the drive pushes along the coordinate.
        reactions={
            name: -values for name, values in zip(system.motions, np.transpose(recorder.reactions), strict=True)
        },
    )
