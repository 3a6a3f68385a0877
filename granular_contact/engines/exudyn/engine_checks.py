"""Test of undocumented behaviour of Exudyn that solves rely on, made once in a process.

A solve changes numbers of the solver while it runs (`solver.it`, `.conv`, `.newton`), reads and writes the vectors of
the system in the engine's own memory, and relies on the order in which the engine evaluates objects. Exudyn documents
none of that. So a trial system of two mass points and a constraint is solved before the first solve of a process: three
steps of 1 ms of simulated time, about 1 ms of wall time. A solve does not use what fails in the trial; `notices` says
what it does instead.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from itertools import pairwise
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

STEP, STEPS = 1e-3, 3  # length (s) and number of the trial's steps
MARK = 7  # value that is written through one handle and read through another
# Fields of `solver.it`, `.conv` and `.newton` that a solve sets.
CONTROLS = (
    *("currentStepSize", "maxStepSize", "endTime", "currentTime", "newtonStepsCount"),
    *("jacobianUpdateRequested", "absoluteTolerance", "maxIterations"),
)
GETTERS = "GetODE2Coordinates", "GetODE2Coordinates_t", "GetODE2Coordinates_tt", "GetAECoordinates"
# User functions of the trial, in the log of its calls.
RESIDUAL, TRIGGER, FORCE, CONSTRAINT = "residual", "trigger", "force", "constraint"


@dataclass(frozen=True)
class Abilities:
    """Undocumented behaviour that this version of Exudyn has.

    controls: `solver.it`, `.conv` and `.newton` are handles of the solver's own numbers, not copies. views: vectors
    that are fetched with `copy=False` are the engine's memory, and keep their addresses from step to step. order:
    objects are evaluated in the order in which they were added. constraints_last: forces are evaluated before
    constraints.
    """

    controls: bool = True
    views: bool = True
    order: bool = True
    constraints_last: bool = True


def abilities(mbs: Any = None) -> Abilities:
    """Abilities of the Exudyn of this process; mbs: the system that is about to be solved.

    The engine's window shows the container that was made last. After the trial the window is attached to the container
    of `mbs` again.
    """
    is_first = not trial_abilities.cache_info().currsize
    able = trial_abilities()
    if is_first and mbs is not None:
        mbs.GetSystemContainer().renderer.Attach()
    return able


@cache
def trial_abilities() -> Abilities:
    """Abilities as the trial shows them; the trial is made at the first call."""
    trial = _Trial()
    views = trial.views()
    trial.run()
    controls = trial.controls()
    trial.container.Reset()
    order, last = in_order(trial.calls, TRIGGER, FORCE), in_order(trial.calls, FORCE, CONSTRAINT)
    return Abilities(controls, views and len(set(trial.addresses)) == 1, order, last)


def in_order(calls: list[str], first: str, second: str) -> bool:
    """Whether in each residual of a log of calls, both functions are called, and `first` before `second`."""
    starts = [i for i, name in enumerate(calls) if name == RESIDUAL]
    residuals = [calls[start:end] for start, end in pairwise([*starts, len(calls)])]
    return bool(residuals) and all(
        first in names and second in names and names.index(first) < names.index(second) for names in residuals
    )


def _name() -> str:
    return f"Exudyn {metadata.version('exudyn')}"


def notices(able: Abilities) -> Iterator[str]:
    """Sentences for the results of a run: what the run does instead of each ability that is missing."""
    if not able.controls:
        yield (
            f"{_name()} hands out copies of solver.it, .conv and .newton: Newton's method and its steps are left to "
            "the engine, which takes longer; with solver.accuracy steps are still refused by their error"
        )
    yield from vector_notices(able)


def vector_notices(able: Abilities) -> Iterator[str]:
    """Those of `notices` that concern a bed in a system that the user solves."""
    if not able.views:
        yield (
            f"{_name()} hands out copies of its vectors of state: they are asked for each time, and Newton's method "
            "begins as the engine does, which takes longer"
        )
    if not able.order:
        yield f"{_name()} does not ask objects in the order in which they were added: forces go by lists: slower"


def restore_notice() -> str:
    """Sentence for the results of a run in which the engine did not restore a Jacobian or accelerations."""
    return (
        f"{_name()} did not go back to the Jacobian or the accelerations of a saved state: what follows it is the same "
        "within the error of a step, not to the last digit"
    )


def refusal(able: Abilities, *, pauses: bool, turns: bool) -> str | None:
    """Why a solve is impossible with these abilities; None if it is possible.

    pauses: whether the solve pauses. turns: whether the prescribed motion of a hinge is a constraint whose offset is
    set at each instant.
    """
    if pauses and not able.controls:
        return f"a run can't be stepped with {_name()}, which hands out copies of solver.it: `simulate` it as a whole"
    if turns and not able.constraints_last:
        return f"joints can't follow a prescribed motion with {_name()}: it asks constraints before it asks for forces"
    return None


class _Trial:
    """System of two mass points, with a constraint between ground and the second, and an overlay on both points.

    calls: log of the user functions, in the order of their calls. addresses: those of the vectors after each step.
    """

    def __init__(self) -> None:
        self.container = exu.SystemContainer()
        self.mbs, self.solver = self.container.AddSystem(), exu.MainSolverImplicitSecondOrder()
        self.handles = self.solver.it, self.solver.conv, self.solver.newton  # fetched before the start, as by a solve
        self.calls: list[str] = []
        self._step_refused = False
        self.addresses: list[tuple[int, ...]] = []
        mbs, starts = self.mbs, ([0.0, 0.0], [0.0, 1.0])  # m/s
        nodes = [mbs.AddNode(items.NodePoint2D(initialVelocities=velocity)) for velocity in starts]
        for node in nodes:
            mbs.AddObject(items.ObjectMassPoint2D(mass=1.0, nodeNumber=node))
        for name, object_nodes in ((TRIGGER, nodes[:1]), (FORCE, nodes)):
            force = self._logged(name, [0.0] * (2 * len(object_nodes)))
            mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=object_nodes, forceUserFunction=force))
        ends = [mbs.AddNode(items.NodePointGround()), nodes[1]]
        markers = [mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in ends]
        offset = self._logged(CONSTRAINT, 0.0)
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=markers, offsetUserFunction=offset))
        mbs.SetPreNewtonResidualUserFunction(self._logged(RESIDUAL, None))
        mbs.SetPostNewtonUserFunction(self._post_newton)
        mbs.SetPostStepUserFunction(self._post_step)
        mbs.Assemble()
        self.settings = settings = exu.SimulationSettings()
        time = settings.timeIntegration
        time.endTime, time.numberOfSteps, time.verboseMode = STEPS * STEP, STEPS, 0
        settings.solution.file.write = False
        self.solver.InitializeSolver(mbs, settings)
        self.calls.clear()  # initialisation evaluates the rates of constraints before forces

    def _logged(self, name: str, value: Any) -> Any:
        """User function that logs its calls and returns a value."""

        def user_function(*_: Any) -> Any:
            self.calls.append(name)
            return value

        return user_function

    def _post_newton(self, *_: Any) -> list[float]:
        """Refuse the first attempt of the first step, so that it is repeated with half its length."""
        refused, self._step_refused = self._step_refused, True
        return [0.0, -1.0] if refused else [2.0, 0.5 * STEP]

    def _post_step(self, *_: Any) -> bool:
        """Note the addresses of the vectors."""
        self.addresses.append(tuple(vector.ctypes.data for vector in self._vectors()))
        return True

    def _vectors(self) -> list[Any]:
        """All vectors of `views.Views`."""
        data, start = self.mbs.systemData, exu.ConfigurationType.StartOfStep
        return [getattr(data, getter)(*state, copy=False) for getter in GETTERS for state in ((), (start,))]

    def run(self) -> None:
        """Solve the trial's steps."""
        self.solver.SolveSteps(self.mbs, self.settings)

    def controls(self) -> bool:
        """Whether a value written through a handle from before the start is read through a new one, and vice versa."""
        new = self.solver.it, self.solver.conv, self.solver.newton
        for written, read in (*zip(self.handles, new, strict=True), *zip(new, self.handles, strict=True)):
            for name in (name for name in CONTROLS if hasattr(written, name)):
                value = getattr(written, name)
                mark = not value if isinstance(value, bool) else type(value)(MARK)
                setattr(written, name, mark)
                read_back = getattr(read, name)
                setattr(written, name, value)
                if read_back != mark:
                    return False
        return bool(self.handles[0].currentTime == self.solver.it.currentTime)

    def views(self) -> bool:
        """Whether values that are written to each view appear in the copy that the engine returns."""
        data, start = self.mbs.systemData, exu.ConfigurationType.StartOfStep
        for getter in GETTERS:
            for state in ((), (start,)):
                get = getattr(data, getter)
                view = get(*state, copy=False)
                values = view.copy()
                view[:] = MARK
                read_back = np.array(get(*state))
                view[:] = values
                if not np.array_equal(read_back, np.full_like(values, MARK)):
                    return False
        return True
