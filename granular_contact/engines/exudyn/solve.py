"""Integrate an assembled system in time and keep every accepted step."""

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

KEPT = "seconds", "_success", "_problem", "_restarts"  # fields of a solve that a state has


class _Guarded:
    """Within it a handler takes Ctrl-C, which only the main thread may, and the engine does not print.

    Every pause of a solve leaves and enters it: so by the function below `signal.signal`, which makes an enum of all
    that it is given and gives, ten times slower.
    """

    def __init__(self, handler: Callable[[int, FrameType | None], None]) -> None:
        self._handler, self._main = handler, threading.main_thread().ident

    def __enter__(self) -> None:
        self._prints, self._takes = exu.config.printToConsole, threading.get_ident() == self._main
        if self._prints:  # how a run ended is reported by its status
            exu.config.printToConsole = False
        if self._takes:
            self._before = signal.signal(signal.SIGINT, self._handler)

    def __exit__(self, *_: object) -> None:
        if self._takes:
            signal.signal(signal.SIGINT, self._before)
        if self._prints:
            exu.config.printToConsole = True


class Solve:
    """A solve under way, in one go or from pause to pause, by the same steps of the engine.

    time (s): what it has reached; over: whether there is nothing to come, as it is at rest, at its end or has failed.
    """

    def __init__(
        self, system: System, progress: Progress | None = None, simulation: Any = None, *, pauses: bool = False
    ) -> None:
        """Find rest, if the scene is to, and record the state at the start; raises as `settle` does.

        simulation: Exudyn's settings, those of `settings` unless given. pauses: whether it may be looked at and brought
        back to its states on the way.
        """
        self.system, mbs, scene = system, system.mbs, system.scene
        self.simulation = settings(scene) if simulation is None else simulation
        self.recorder = Recorder(system, progress)
        self._able = abilities(mbs)
        if (why := refusal(self._able, pauses=pauses, turns=bool(system.turning))) is not None:
            raise SolveError(why)
        self.solver = exu.MainSolverImplicitSecondOrder()
        self._it, self._conv = self.solver.it, self.solver.conv  # the solver's own, no copies
        self.seconds, self._problem, self._success = 0.0, "", True
        self._restarts = False  # with other accelerations
        self._end = scene.solver.end_time_s
        self._reference = reference(mbs, system.nodes, system.origin)
        self._views: Views | None = None
        self._sensors: Sensors | None = None
        self._keeper: Keeper | None = None
        self._guarded = _Guarded(self.recorder.interrupt)
        with self._guarded:
            if scene.settle:
                settle(system, self.recorder)
            if scene.solver.accuracy is not None:
                self._choose_steps(scene.solver.accuracy)
            mbs.SetPostStepUserFunction(self.recorder)
            self._predictor = self._make_predictor()
            mbs.SetPreNewtonResidualUserFunction(self._predictor or 0)
            # Kernels are loaded here, which is no part of the solve.
            if system.bed is not None:
                system.bed.accept()
            if self._predictor is not None:
                self._predictor.load(Views(mbs))
            if pauses:
                from granular_contact.engines.exudyn.state import Keeper

                self._sensors = system.sensors()
                self._keeper = Keeper(system, self.solver, self.recorder, self.simulation, self._predictor)
            self._run(self._begin)
        if self.recorder.rows == 0:
            raise SolveError(f"the engine could not begin: {self._problem or self._too_fast()}")

    def _choose_steps(self, accuracy: float) -> None:
        """Let a step control choose the steps."""
        sets = self._able.controls
        control = StepControl(self.system, self.solver, self.recorder.lever, accuracy, sets=sets)
        self.recorder.control = control
        self.system.mbs.SetPostNewtonUserFunction(control)
        control_steps(self.simulation, control)

    def _make_predictor(self) -> Predictor | None:
        """What Newton's method begins with; None where accelerations are nothing but round-off.

        None, too, where the engine takes no changes of its solver or its vectors.
        """
        if unresolved(self.system.scene) or not (self._able.controls and self._able.views):
            return None
        bed = self.system.bed
        lever = self.recorder.lever if bed is not None or self.system.loads else None
        allowed = allowed_in_space(self.system.scene) if self.system.scene.in_space else None
        return Predictor(self.solver, lever, None if bed is None else bed.apply, allowed)

    def _run(self, part: Callable[[], bool]) -> None:
        """Do a part of the solve and keep how it ended, with the time that it took."""
        start = time.perf_counter()
        try:
            self._success = part()
        except (exu.ExudynError, RuntimeError) as error:
            self._success, self._problem = False, str(error).strip().splitlines()[0]
        self.seconds += time.perf_counter() - start

    def _begin(self) -> bool:
        it, mbs, self._restarts = self.solver.it, self.system.mbs, False
        if not self.solver.InitializeSolver(mbs, self.simulation):
            return False
        it.currentStepSize = it.maxStepSize  # as the engine begins
        self.solver.conv.jacobianUpdateRequested = True
        self._views = None
        self._look()
        self.recorder(mbs, mbs.systemData.GetTime())
        return True

    def _look(self) -> None:
        """Tell all that is called in steps where the engine keeps its vectors, if that is not where they were."""
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
        """Go on to a time (s), the scene's end at the latest; does nothing when it is over.

        Where steps are fixed they divide the time to go evenly, none longer than the scene's.
        """
        if self.over:
            return
        with self._guarded:
            if self._restarts:
                self.recorder.clear()
                self._run(self._begin)
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
        """Tell the engine where to stop next, and how to go on to there from where it is."""
        it, recorder, now = self._it, self.recorder, self.recorder.time
        self._look()
        it.endTime = until
        if recorder.control is not None:
            whole = now == 0.0 and until == self._end
            recorder.control.until = math.inf if whole else until
        else:
            count = max(1, math.ceil((until - now) / self.system.scene.solver.step_s - 1e-9))
            it.maxStepSize = recorder.asked = (until - now) / count
        recorder.resume(self._conv, self.spent)

    def _too_fast(self) -> str:
        if self.recorder.reason == "away":
            return f"a speed at the start is not below {FASTEST:g} m/s (or rad/s): give a slower one"
        return "it gave no reason"

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return self.recorder.time

    @property
    def spent(self) -> float:
        """Wall time (s) so far: of the solve, and of making what the medium meets."""
        return self.seconds + self.system.building_s

    @property
    def over(self) -> bool:
        """Whether there is nothing to come."""
        return not self._success or self.recorder.reason != "" or self.recorder.at_end(self.recorder.time)

    # ---- of a solve that pauses ----

    def observe(self) -> Observations:
        """What is seen of the present state."""
        assert self._sensors is not None  # of one that pauses
        recorder, bed = self.recorder, self.system.bed
        row, count = recorder.states[recorder.rows - 1], recorder.size
        q = row[1 : 1 + count] + self._reference
        return self._sensors.read(recorder.time, q, row[1 + count :], None if bed is None else bed.load.table.row)

    def outlines(self) -> tuple[Outline, ...]:
        """The mechanism as it is drawn, at the present state."""
        recorder = self.recorder
        row, count = recorder.states[recorder.rows - 1 : recorder.rows], recorder.size
        q, v = row[:, 1 : 1 + count] + self._reference, row[:, 1 + count :]
        return self.system.kinematics(at_one(self.system, row[:, 0], q, v)).outlines(0)

    def set_to(self, joint: str, value: float) -> None:
        """Set the drive of a joint, in SI units, from now on; at the start the accelerations follow."""
        load = self.recorder.external[joint]
        self._restarts |= self.recorder.rows == 1 and load.set_to != value
        load.set_to = value

    def state(self) -> SolveState:
        """The present state."""
        assert self._keeper is not None  # of one that pauses
        return self._keeper.state({name: getattr(self, name) for name in KEPT})

    def restore(self, kept: SolveState) -> None:
        """Go back to a state of this solve or another one of the same scene."""
        assert self._keeper is not None  # of one that pauses
        with self._guarded:
            self._keeper.restore(kept)
        vars(self).update(kept.solve)

    def close(self) -> None:
        """Let go of the engine's system. Its functions hold this solve and are held by it, so Python never would."""
        self.system.container.Reset()

    def status(self) -> Status:
        """How it ended."""
        return status(self.recorder, self._success, self._problem, self.solver.it.currentStepSize)

    def trajectory(self) -> Trajectory:
        """All steps so far."""
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
            set_to=dict(zip(recorder.external, np.transpose(recorder.set_to), strict=True)),
            notices=(*notices(self._able), *(() if self._keeper is None else self._keeper.notices())),
        )


def solve(system: System, progress: Progress | None = None, simulation: Any = None) -> Trajectory:
    """Run the scene to its end time, to rest, to a limit, to a failure or to Ctrl-C; what was reached by then is kept.

    simulation: Exudyn's settings, those of `settings` unless given.
    """
    under_way = Solve(system, progress, simulation)
    under_way.advance()
    return under_way.trajectory()
