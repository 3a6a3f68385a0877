"""What Exudyn lets a program do with its solver beyond its documented results, tried once in a process.

A solve changes numbers of the solver while that runs (`solver.it`, `.conv`, `.newton`), reads and writes the vectors of
the system in the engine's own memory, and counts on the order in which objects are asked for forces. None of that is
promised by Exudyn. So it is tried on two mass points and a constraint, three steps of 1 ms, before the first solve of a
process (about 1 ms). What does not work is not used: see `notices` for what a run then does instead.
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

STEP, STEPS = 1e-3, 3  # s, of the trial
MARK = 7  # what is written through one handle and read through another
# Fields of `solver.it`, `.conv` and `.newton` that a solve sets.
CONTROLS = (
    *("currentStepSize", "maxStepSize", "endTime", "currentTime", "newtonStepsCount"),
    *("jacobianUpdateRequested", "absoluteTolerance", "maxIterations"),
)
GETTERS = "GetODE2Coordinates", "GetODE2Coordinates_t", "GetODE2Coordinates_tt", "GetAECoordinates"
RESIDUAL, TRIGGER, SINK, CONSTRAINT = "residual", "trigger", "sink", "constraint"


@dataclass(frozen=True)
class Abilities:
    """What works with this Exudyn.

    controls: `solver.it`, `.conv` and `.newton` are the solver's own, not copies. views: vectors handed out without a
    copy are the engine's memory, and stay where they are from step to step. order: objects are asked for forces in the
    order in which they were added. constraints_last: they are asked before constraints are.
    """

    controls: bool = True
    views: bool = True
    order: bool = True
    constraints_last: bool = True


def abilities(mbs: Any = None) -> Abilities:
    """What works with the Exudyn of this process; mbs: the system for which it is asked.

    The engine's window shows the container that was made last: after the trial it is given back that of the system.
    """
    is_first = not tried.cache_info().currsize
    found = tried()
    if is_first and mbs is not None:
        mbs.GetSystemContainer().renderer.Attach()
    return found


@cache
def tried() -> Abilities:
    """What the trial shows."""
    trial = _Trial()
    views = trial.views()
    trial.run()
    controls = trial.controls()
    trial.container.Reset()
    order, last = in_order(trial.asked, TRIGGER, SINK), in_order(trial.asked, SINK, CONSTRAINT)
    return Abilities(controls, views and len(set(trial.places)) == 1, order, last)


def in_order(asked: list[str], first: str, second: str) -> bool:
    """Whether within each residual one is asked for the first time before another; both have to be."""
    starts = [i for i, name in enumerate(asked) if name == RESIDUAL]
    parts = [asked[a:b] for a, b in pairwise([*starts, len(asked)])]
    return bool(parts) and all(
        first in part and second in part and part.index(first) < part.index(second) for part in parts
    )


def _name() -> str:
    return f"Exudyn {metadata.version('exudyn')}"


def notices(able: Abilities) -> Iterator[str]:
    """What a run does in place of what does not work: sentences for its results."""
    if not able.controls:
        yield (
            f"{_name()} hands out copies of solver.it, .conv and .newton: Newton's method and its steps are left to "
            "the engine, which takes longer; with solver.accuracy steps are still refused by their error"
        )
    yield from of_vectors(able)


def of_vectors(able: Abilities) -> Iterator[str]:
    """`notices` of what concerns a bed in a system that somebody else solves."""
    if not able.views:
        yield (
            f"{_name()} hands out copies of its vectors of state: they are asked for each time, and Newton's method "
            "begins as the engine does, which takes longer"
        )
    if not able.order:
        yield f"{_name()} does not ask objects in the order in which they were added: forces go by lists: slower"


def of_restored() -> str:
    """What is different after a state was restored whose Jacobian or accelerations the engine did not go back to."""
    return (
        f"{_name()} did not go back to the Jacobian or the accelerations of a saved state: what follows it is the same "
        "within the error of a step, not to the last digit"
    )


def refusal(able: Abilities, *, pauses: bool, turns: bool) -> str | None:
    """Why a solve can't be done with what works, None if it can.

    pauses: whether it is to be stepped. turns: whether a prescribed motion is a constraint whose offset is set anew.
    """
    if pauses and not able.controls:
        return f"a run can't be stepped with {_name()}, which hands out copies of solver.it: `simulate` it as a whole"
    if turns and not able.constraints_last:
        return f"joints can't follow a prescribed motion with {_name()}: it asks constraints before it asks for forces"
    return None


class _Trial:
    """Two mass points, a constraint between ground and the second, and the two objects of an overlay on the points."""

    def __init__(self) -> None:
        self.container = exu.SystemContainer()
        self.mbs, self.solver = self.container.AddSystem(), exu.MainSolverImplicitSecondOrder()
        self.kept = self.solver.it, self.solver.conv, self.solver.newton  # as a solve does, before it begins
        self.asked: list[str] = []
        self._refused = False
        self.places: list[tuple[int, ...]] = []  # of the vectors, after each step
        mbs, starts = self.mbs, ([0.0, 0.0], [0.0, 1.0])  # m/s
        nodes = [mbs.AddNode(items.NodePoint2D(initialVelocities=velocity)) for velocity in starts]
        for node in nodes:
            mbs.AddObject(items.ObjectMassPoint2D(mass=1.0, nodeNumber=node))
        for name, some in ((TRIGGER, nodes[:1]), (SINK, nodes)):
            force = self._noting(name, [0.0] * (2 * len(some)))
            mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=some, forceUserFunction=force))
        ends = [mbs.AddNode(items.NodePointGround()), nodes[1]]
        markers = [mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)) for node in ends]
        offset = self._noting(CONSTRAINT, 0.0)
        mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=markers, offsetUserFunction=offset))
        mbs.SetPreNewtonResidualUserFunction(self._noting(RESIDUAL, None))
        mbs.SetPostNewtonUserFunction(self._judge)
        mbs.SetPostStepUserFunction(self._after)
        mbs.Assemble()
        self.settings = settings = exu.SimulationSettings()
        time = settings.timeIntegration
        time.endTime, time.numberOfSteps, time.verboseMode = STEPS * STEP, STEPS, 0
        settings.solution.file.write = False
        self.solver.InitializeSolver(mbs, settings)
        self.asked.clear()  # at the start constraints are asked for their rates first

    def _noting(self, name: str, answer: Any) -> Any:
        def called(*_: Any) -> Any:
            self.asked.append(name)
            return answer

        return called

    def _judge(self, *_: Any) -> list[float]:
        """Refuse the first try of a step, which is repeated."""
        refused, self._refused = self._refused, True
        return [0.0, -1.0] if refused else [2.0, 0.5 * STEP]

    def _after(self, *_: Any) -> bool:
        self.places.append(tuple(vector.ctypes.data for vector in self._vectors()))
        return True

    def _vectors(self) -> list[Any]:
        """All that `views.Views` asks for."""
        data, start = self.mbs.systemData, exu.ConfigurationType.StartOfStep
        return [getattr(data, getter)(*of, copy=False) for getter in GETTERS for of in ((), (start,))]

    def run(self) -> None:
        """The steps."""
        self.solver.SolveSteps(self.mbs, self.settings)

    def controls(self) -> bool:
        """Whether what is written to a handle kept from the start is read from a new one, and the other way round."""
        new = self.solver.it, self.solver.conv, self.solver.newton
        for one, other in (*zip(self.kept, new, strict=True), *zip(new, self.kept, strict=True)):
            for name in (name for name in CONTROLS if hasattr(one, name)):
                before = getattr(one, name)
                mark = not before if isinstance(before, bool) else type(before)(MARK)
                setattr(one, name, mark)
                seen = getattr(other, name)
                setattr(one, name, before)
                if seen != mark:
                    return False
        return bool(self.kept[0].currentTime == self.solver.it.currentTime)

    def views(self) -> bool:
        """Whether what is written to each vector is in the copy that the engine hands out, and nothing else is."""
        data, start = self.mbs.systemData, exu.ConfigurationType.StartOfStep
        for getter in GETTERS:
            for of in ((), (start,)):
                view, get = getattr(data, getter)(*of, copy=False), getattr(data, getter)
                before = view.copy()
                view[:] = MARK
                seen = np.array(get(*of))
                view[:] = before
                if not np.array_equal(seen, np.full_like(before, MARK)):
                    return False
        return True
