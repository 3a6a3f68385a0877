"""Time integration of an assembled Exudyn system; every accepted step is kept."""

from __future__ import annotations

import math
import signal
import threading
import time
from collections.abc import Callable
from contextlib import nullcontext
from types import FrameType
from typing import TYPE_CHECKING, Any

import exudyn as exu
import numpy as np

from granular_contact.engines.exudyn.engine_checks import abilities, notices, refusal
from granular_contact.engines.exudyn.predictor import Predictor
from granular_contact.engines.exudyn.recorder import Recorder, status
from granular_contact.engines.exudyn.settings import allowed_in_space, control_steps, settings, unresolved
from granular_contact.engines.exudyn.settle import settle
from granular_contact.engines.exudyn.step_control import StepControl
from granular_contact.engines.exudyn.views import Views, reference
from granular_contact.errors import SolveError
from granular_contact.mechanics.mass_and_gravity import mass_matrix
from granular_contact.mechanics.system import System, Trajectory, at_one
from granular_contact.results import Cost, Outline, Progress, Status
from granular_contact.results.observed import Observations
from granular_contact.scene.types import FASTEST

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.state import Keeper, SolveState
    from granular_contact.mechanics.sensors import Sensors

SAVED = "seconds", "_success", "_problem", "_restarts"  # attributes of a solve that belong to its state


class _Guard:
    """Context in which a handler receives Ctrl-C and the engine does not print.

    Python allows handlers of signals in the main thread alone; in other threads Ctrl-C is left as it is.
    """

    def __init__(self, handler: Callable[[int, FrameType | None], None]) -> None:
        self._handler, self._main_thread = handler, threading.main_thread().ident

    def __enter__(self) -> None:
        self._printed, self._is_main = exu.config.printToConsole, threading.get_ident() == self._main_thread
        if self._printed:  # the status reports how a run ended
            exu.config.printToConsole = False
        if self._is_main:
            self._old_handler = signal.signal(signal.SIGINT, self._handler)

    def __exit__(self, *_: object) -> None:
        if self._is_main:
            signal.signal(signal.SIGINT, self._old_handler)
        if self._printed:
            exu.config.printToConsole = True


class Solve:
    """Solve of a system by Exudyn's generalised-alpha method; implements `run.Solving`.

    A solve in one call of `advance` and a solve with pauses make the same steps of the engine.
    """

    def __init__(
        self, system: System, progress: Progress | None = None, simulation: Any = None, *, pauses: bool = False
    ) -> None:
        """Find static equilibrium if the scene asks for it, and record the initial state.

        simulation: Exudyn's settings, those of `settings.settings` unless given. pauses: whether `observe`, `state` and
        `restore` will be called. Errors: those of `settle`, and SolveError if the engine cannot start.
        """
        self.system, mbs, scene = system, system.mbs, system.scene
        self.simulation = settings(scene) if simulation is None else simulation
        self.recorder = Recorder(system, progress)
        self._abilities = abilities(mbs)
        if (why := refusal(self._abilities, pauses=pauses, turns=bool(system.turning))) is not None:
            raise SolveError(why)
        self.solver = exu.MainSolverImplicitSecondOrder()
        self._it, self._conv = self.solver.it, self.solver.conv  # handles of the solver's own numbers, no copies
        self.seconds, self._problem, self._success = 0.0, "", True  # wall time, the engine's error, whether it goes on
        self._restarts = False  # whether drives were set at the start, which changes the initial accelerations
        self._end = scene.solver.end_time_s
        self._reference = reference(mbs, system.nodes, system.origin)
        self._views: Views | None = None
        self._sensors: Sensors | None = None
        self._keeper: Keeper | None = None
        self._guard = _Guard(self.recorder.interrupt)
        with self._guard:
            if scene.settle:
                settle(system, self.recorder)
            if scene.solver.accuracy is not None:
                self._choose_steps(scene.solver.accuracy)
            mbs.SetPostStepUserFunction(self.recorder)
            self._predictor = self._make_predictor()
            mbs.SetPreNewtonResidualUserFunction(self._predictor or 0)
            # Kernels are loaded here, so that the wall time of the solve does not include loading.
            if system.bed is not None:
                system.bed.accept()
            if self._predictor is not None:
                self._predictor.load(Views(mbs))
            if pauses:
                from granular_contact.engines.exudyn.state import Keeper

                self._sensors = system.sensors()
                self._keeper = Keeper(system, self.solver, self.recorder, self.simulation, self._predictor)
            self._run(self._start)
        if self.recorder.rows == 0:
            raise SolveError(f"the engine could not begin: {self._problem or self._start_fault()}")

    def _choose_steps(self, accuracy: float) -> None:
        """Let a step control choose the steps by their error."""
        sets_steps = self._abilities.controls
        control = StepControl(self.system, self.solver, self.recorder.lever, accuracy, sets_steps=sets_steps)
        self.recorder.control = control
        self.system.mbs.SetPostNewtonUserFunction(control)
        control_steps(self.simulation, control)

    def _make_predictor(self) -> Predictor | None:
        """Predictor of Newton's method.

        None if the accelerations are mere round-off, or if the engine does not let us change its solver and its
        vectors.
        """
        if unresolved(self.system.scene) or not (self._abilities.controls and self._abilities.views):
            return None
        bed = self.system.bed
        lever = self.recorder.lever if bed is not None or self.system.loads else None
        allowed = allowed_in_space(self.system.scene) if self.system.scene.in_space else None
        return Predictor(self.solver, lever, None if bed is None else bed.apply, allowed)

    def _run(self, part: Callable[[], bool]) -> None:
        """Run a part of the solve; record its success or error, and add its wall time."""
        start = time.perf_counter()
        try:
            self._success = part()
        except (exu.ExudynError, RuntimeError) as error:
            self._success, self._problem = False, str(error).strip().splitlines()[0]
        self.seconds += time.perf_counter() - start

    def _start(self) -> bool:
        """Initialise the engine's solver and record the initial state; returns whether the engine succeeded."""
        it, mbs, self._restarts = self.solver.it, self.system.mbs, False
        if not self.solver.InitializeSolver(mbs, self.simulation):
            return False
        it.currentStepSize = it.maxStepSize  # the engine's own start does the same
        self.solver.conv.jacobianUpdateRequested = True
        self._views = None
        self._bind_views()
        self.recorder(mbs, mbs.systemData.GetTime())
        return True

    def _bind_views(self) -> None:
        """Pass views of the engine's vectors to all objects that steps call, if the vectors have moved."""
        views = Views(self.system.mbs)
        if self._views is not None and views.memory == self._views.memory:
            return
        self._views = self.recorder.views = views
        if self._predictor is not None:
            self._predictor.views = views
        if self.recorder.control is not None:
            self.recorder.control.bind(views)
        if self.system.bed is not None:
            self.system.bed.views = views
        if self._keeper is not None:
            self._keeper.tangent.views = views

    def advance(self, until: float = math.inf) -> None:
        """Integrate to a time (s), at most to the scene's end time; do nothing if the solve is over.

        Fixed steps divide the time to integrate evenly; they are not longer than the step of the scene.
        """
        if self.over:
            return
        with self._guard:
            if self._restarts:
                self.recorder.clear()
                self._run(self._start)
            self._plan(min(until, self._end))
            before = self.recorder.rows
            self._run(self._steps)
        if self._sensors is not None and self._sensors.follows:
            rows = self.recorder.states[before : self.recorder.rows, 1 : 1 + self.recorder.size]
            self._sensors.follow(rows + self._reference)

    def _steps(self) -> bool:
        bed = self.system.bed
        with nullcontext() if bed is None or self._predictor is None else bed.overlay.untriggered():
            return bool(self.solver.SolveSteps(self.system.mbs, self.simulation))

    def _plan(self, until: float) -> None:
        """Set the engine's end time and step for the part of the solve from the present time to `until` (s)."""
        it, recorder, time_reached = self._it, self.recorder, self.recorder.time
        self._bind_views()
        it.endTime = until
        if recorder.control is not None:
            is_whole_run = time_reached == 0.0 and until == self._end
            recorder.control.until = math.inf if is_whole_run else until
        else:
            count = max(1, math.ceil((until - time_reached) / self.system.scene.solver.step_s - 1e-9))
            it.maxStepSize = recorder.fixed_step = (until - time_reached) / count
        recorder.resume(self._conv, self.spent)

    def _start_fault(self) -> str:
        """Reason why the initial state was not recorded."""
        if self.recorder.reason == "away":
            return f"a speed at the start is not below {FASTEST:g} m/s (or rad/s): give a slower one"
        return "it gave no reason"

    @property
    def time(self) -> float:
        """Time (s) of the present state."""
        return self.recorder.time

    @property
    def spent(self) -> float:
        """Wall time (s) spent so far: of the solve, and of making the shapes that the medium acts on."""
        return self.seconds + self.system.building_s

    @property
    def over(self) -> bool:
        """Whether the solve has ended: at the end time, at rest, by a limit, by Ctrl-C or by a failure."""
        return not self._success or self.recorder.reason != "" or self.recorder.at_end(self.recorder.time)

    # ---- solves with pauses ----

    def observe(self) -> Observations:
        """Observed quantities at the present state, by name, in SI units."""
        assert self._sensors is not None  # the solve was made with `pauses`
        recorder, bed = self.recorder, self.system.bed
        row, count = recorder.states[recorder.rows - 1], recorder.size
        q = row[1 : 1 + count] + self._reference
        return self._sensors.read(recorder.time, q, row[1 + count :], None if bed is None else bed.load.table.row)

    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of the mechanism at the present state, for drawings."""
        recorder = self.recorder
        row, count = recorder.states[recorder.rows - 1 : recorder.rows], recorder.size
        q, v = row[:, 1 : 1 + count] + self._reference, row[:, 1 + count :]
        return self.system.kinematics(at_one(self.system, row[:, 0], q, v)).outlines(0)

    def set_to(self, joint: str, value: float) -> None:
        """Set the drive of a joint (SI units) from the present time on; at t = 0 the initial accelerations follow."""
        load = self.recorder.external_loads[joint]
        self._restarts |= self.recorder.rows == 1 and load.set_to != value
        load.set_to = value

    def state(self) -> SolveState:
        """Copy of the present state: all that later steps and the results depend on."""
        assert self._keeper is not None  # the solve was made with `pauses`
        return self._keeper.state({name: getattr(self, name) for name in SAVED})

    def restore(self, kept: SolveState) -> None:
        """Return to a state that `state` gave, in this solve or in another one of the same scene."""
        assert self._keeper is not None  # the solve was made with `pauses`
        with self._guard:
            self._keeper.restore(kept)
        vars(self).update(kept.solve)

    def close(self) -> None:
        """Release the engine's system.

        The system holds user functions that hold this solve, and the solve holds the system; Python cannot collect such
        a cycle through the engine.
        """
        self.system.container.Reset()

    def status(self) -> Status:
        """How the solve ended, or that it pauses."""
        return status(self.recorder, self._success, self._problem, self.solver.it.currentStepSize)

    def trajectory(self) -> Trajectory:
        """All accepted steps so far, in the engine's coordinates; positions are in the world frame."""
        system, recorder, it = self.system, self.recorder, self.solver.it
        states, count = recorder.states[: recorder.rows], recorder.size
        return Trajectory(
            status=self.status(),
            cost=Cost(
                solve_s=self.seconds,
                steps=recorder.rows - 1,
                newton_iterations=it.newtonStepsCount,
                jacobians=it.newtonJacobiCount,
                load_calls=0 if system.bed is None else system.bed.load_calls,
                full_newton=it.rejectedModifiedNewtonSteps,
                shortened_steps=recorder.shortened,
                refused_steps=0 if recorder.control is None else recorder.control.refused,
            ),
            time=states[:, 0],
            q=states[:, 1 : 1 + count] + self._reference,
            v=states[:, 1 + count :],
            load=None if system.bed is None else system.bed.load.history.since(0.0),
            mass=mass_matrix(system),
            multipliers=dict(zip(system.motions, np.transpose(recorder.multipliers), strict=True)),
            a=np.array(recorder.accelerations) if system.motions else None,
            set_to=dict(zip(recorder.external_loads, np.transpose(recorder.set_to), strict=True)),
            notices=(*notices(self._abilities), *(() if self._keeper is None else self._keeper.notices())),
        )


def solve(system: System, progress: Progress | None = None, simulation: Any = None) -> Trajectory:
    """Trajectory of a system to its end time, to rest, to a limit, to a failure or to Ctrl-C.

    simulation: Exudyn's settings, those of `settings.settings` unless given.
    """
    solving = Solve(system, progress, simulation)
    solving.advance()
    return solving.trajectory()
