"""Rest under gravity before the clock starts: the same system with damping, at negative times.

Every body is held back in proportion to its mass. Nothing else is changed, so that the rest that is found is one of the
undamped system: in sand one in which the static resistance carries what it has to, with the strips' anchors as they
then are. Drives keep the value that they start with, and want no speed.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items

from granular_contact.errors import OutOfTimeError, SolveError
from granular_contact.media.static_friction import Smooth
from granular_contact.multibody.recorder import Recorder
from granular_contact.multibody.system import System
from granular_contact.scene.types import Scene

# In swings of a pendulum as long as the mechanism, divided by 2 pi.
LONGEST, STILL = 60.0, 1.0
SLOW = 1e-2  # of solver.rest_speed_m_s: this is rest
COARSE = 4.0  # steps of the run


def swing(scene: Scene) -> float:
    """Angular frequency (rad/s) of a pendulum as long as the mechanism."""
    return math.sqrt(max(abs(scene.gravity), 0.1) / max(scene.length, 1e-3))


def add_dampers(system: System) -> None:
    """Hold every body back by twice its mass times the swing's frequency: critical damping of that swing."""
    mbs, rate = system.mbs, 2.0 * swing(system.scene)
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for rigid in system.rigid.values():
        body = rigid.body
        for coordinate, inertia in enumerate((body.mass, body.mass, body.inertia)):
            system.dampers.append(_damper(mbs, ground, rigid.node, coordinate, rate * inertia))
    for link in system.links.values():
        share = link.link.mass / len(link.nodes)
        system.dampers.extend(_damper(mbs, ground, node, i, rate * share) for node in link.nodes for i in (0, 1))


def _damper(mbs: Any, ground: Any, node: int, coordinate: int, damping: float) -> int:
    marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))
    item = items.ObjectConnectorCoordinateSpringDamper(markerNumbers=[ground, marker], damping=damping)
    return int(mbs.AddObject(item))


class _Watch:
    """Post-step function: stops once all has been slow for long enough."""

    def __init__(self, system: System, recorder: Recorder, hold: float) -> None:
        self.system, self.recorder, self.lever, self.hold = system, recorder, recorder.lever, hold
        self.slow = SLOW * system.scene.solver.rest_speed
        self.since: float | None = None
        self.rests = False
        wall = system.scene.solver.max_wall
        self.deadline = math.inf if wall is None else time.perf_counter() + wall

    def __call__(self, mbs: Any, t: float) -> bool:
        data = mbs.systemData
        q, v = data.GetODE2Coordinates(copy=False), data.GetODE2Coordinates_t(copy=False)
        for load in self.system.loads.values():
            load.accept(q, v)
        if np.abs(self.lever * v).max() > self.slow:
            self.since = None
        elif self.since is None:
            self.since = t
        self.rests = self.since is not None and t - self.since >= self.hold
        return not self.rests and not self.recorder.reason and time.perf_counter() < self.deadline


def settle(system: System, simulation: Any, recorder: Recorder) -> None:
    """Bring an assembled system to rest, and make that its initial state at t = 0.

    simulation: Exudyn's settings of the run; recorder: that of the run, which hears of Ctrl-C.

    Raises
    ------
    SolveError
        It does not come to rest; OutOfTimeError where it is not given the time.
    KeyboardInterrupt
        It was asked for; there is nothing to keep.
    """
    mbs, t = system.mbs, simulation.timeIntegration
    kept = t.startTime, t.endTime, t.numberOfSteps, t.generalizedAlpha.spectralRadius
    unit = 1.0 / swing(system.scene)
    with _negative_times():
        t.startTime = -LONGEST * unit
    t.endTime = 0.0
    t.numberOfSteps = max(1, math.ceil(LONGEST * unit / (COARSE * system.scene.solver.step)))
    t.generalizedAlpha.spectralRadius = 0.5
    watch = _Watch(system, recorder, STILL * unit)
    mbs.SetPostStepUserFunction(watch)
    problem = f"it still moves after {LONGEST * unit:.3g} s"
    try:
        exu.MainSolverImplicitSecondOrder().SolveSystem(mbs, simulation)
    except (exu.ExudynError, RuntimeError) as error:
        problem = str(error).strip().splitlines()[0]
    if recorder.reason == "interrupted":
        raise KeyboardInterrupt
    if not watch.rests and time.perf_counter() >= watch.deadline:
        allowed = f"solver.max_wall_s ({system.scene.solver.max_wall:g}) was over"
        raise OutOfTimeError(
            f"initial.settle: {allowed} before the mechanism rested; nothing was saved: take a larger one"
        )
    if not watch.rests:
        raise SolveError(f"initial.settle: the mechanism finds no rest: {problem}; {_remedy(system.scene)}")
    t.startTime, t.endTime, t.numberOfSteps, t.generalizedAlpha.spectralRadius = kept
    _begin(system)


def _remedy(scene: Scene) -> str:
    if scene.media and isinstance(scene.load.static, Smooth):
        return "smooth friction creeps under any load: take load.friction: {type: elastoplastic}"
    return "give the initial state without it"


@contextmanager
def _negative_times() -> Iterator[None]:
    """Let a solve start before t = 0: the engine can, but its settings refuse the number."""
    checks = exu.special.exceptions
    before, checks.parameterRangeChecks = checks.parameterRangeChecks, False
    try:
        yield
    finally:
        checks.parameterRangeChecks = before


def _begin(system: System) -> None:
    """Make where the system is now its initial state, at rest, without the dampers."""
    mbs, initial = system.mbs, exu.ConfigurationType.Initial
    data = mbs.systemData
    q = data.GetODE2Coordinates()
    data.SetODE2Coordinates(q, configuration=initial)
    data.SetODE2Coordinates_t(np.zeros_like(q), configuration=initial)
    for damper in system.dampers:
        mbs.SetObjectParameter(damper, "activeConnector", False)
    for load in system.loads.values():
        load.first_anchor = load.anchor
