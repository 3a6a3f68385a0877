"""Tree -> Trajectory: march to rest, to the end, to a failure or to Ctrl-C; what was reached by then is kept."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.history import HistoryTable, LoadHistory
from granular_contact.bed.load import GranularLoad
from granular_contact.bed.state import BatchState, batch_states, restore_batches
from granular_contact.kernels import tree_march as kernels
from granular_contact.minimal.tree import Tree
from granular_contact.multibody.kinematics import Kinematics
from granular_contact.multibody.mass_and_gravity import mass_matrix
from granular_contact.multibody.senses import Senses
from granular_contact.multibody.system import Trajectory, at_one
from granular_contact.results import Cost, Outline, Progress, Status
from granular_contact.results.ending import ended
from granular_contact.results.observed import Observations
from granular_contact.scene.types import Minimal, Scene, Vector

SHARE = 1024  # steps between two updates of the progress bar
FIRST_STEP = 0.1  # of the scene's
LEAST_REACH = 1e-3  # m, of a mechanism that is all on its hinge


class March:
    """State of a solve, as `kernels.tree_march` keeps it up to date; the arrays are explained there."""

    def __init__(self, tree: Tree, method: Minimal) -> None:
        scene, self.tree, nodes = tree.scene, tree, len(tree.arrays.nodes)
        solver = scene.solver
        reach, speed = _size(scene)
        self.y = tree.start.copy()
        self.control = np.zeros(1, kernels.CONTROL)
        self.control["end"], self.control["longest"] = solver.end_time_s, solver.step_s
        self.control["rest_speed"] = solver.rest_speed_m_s
        self.control["rest_time"] = np.inf if scene.rest_time is None else scene.rest_time
        self.control["allowed"] = [[method.rtol * reach, method.rtol * speed]]
        self.clock = np.array([0.0, FIRST_STEP * solver.step_s, 0.0, 0.0, kernels.OLD])
        self.counts = np.zeros(3, dtype=np.int64)
        self.direction = np.zeros_like(self.y)
        self.blank = (HistoryTable() if tree.load is None else tree.load.table).blank
        self.states = np.zeros((SHARE, kernels.WIDTH * nodes + 2))
        self.rows = np.zeros((SHARE, len(self.blank)))
        kernels.start(self.y, tree.arrays, self.blank, self.states, self.rows)
        self._march(self.rows[:1])  # is full: compiles the march or loads it, which is no part of a solve

    def go_on(self) -> int:
        """March until the tables are full, then make room; why is one of the kernels' codes."""
        code = self._march(self.rows)
        if code == kernels.PAUSE:
            self._enlarge()
        return code

    def _enlarge(self) -> None:
        self.states = np.concatenate([self.states, np.zeros((SHARE, self.states.shape[1]))])
        self.rows = np.concatenate([self.rows, np.zeros((SHARE, self.rows.shape[1]))])

    def _march(self, rows: Vector) -> int:
        state = self.y, self.tree.arrays, self.control, self.clock, self.counts, self.direction
        return int(kernels.march(*state, self.blank, self.states, rows))

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return float(self.clock[kernels.NOW])

    @property
    def last(self) -> int:
        """The row of the present state."""
        return int(self.counts[kernels.STEPS])

    def kept(self) -> dict[str, NDArray[Any]]:
        """Copies of all that its future and its rows depend on."""
        arrays = {name: getattr(self, name).copy() for name in ("y", "clock", "counts", "direction")}
        arrays["joints"] = self.tree.arrays.state.copy()
        return arrays | {name: getattr(self, name)[: self.last + 1].copy() for name in ("states", "rows")}

    def restore(self, kept: dict[str, NDArray[Any]]) -> None:
        """Go back to what was kept."""
        for name in ("y", "clock", "counts", "direction"):
            getattr(self, name)[:] = kept[name]
        self.tree.arrays.state[:] = kept["joints"]
        used = len(kept["rows"])
        while len(self.rows) < used:
            self._enlarge()
        self.states[:used], self.rows[:used] = kept["states"], kept["rows"]


def _size(scene: Scene) -> tuple[float, float]:
    """Reach (m) of the mechanism and scale of its speeds (m/s)."""
    reach = max(
        body.workspace.radius(p) + shape.drop for body in scene.rigid for shape in body.shapes for p in shape.points
    )
    reach = max(reach if math.isfinite(reach) else scene.length, LEAST_REACH)
    rate = max(abs(body.motion.rate) for body in scene.rigid)
    return reach, max(reach * rate + float(np.sqrt(abs(scene.gravity) * reach)), scene.speed, 1e-6)


@dataclass(frozen=True)
class SolveState:
    """State of a solve: arrays of the march, rows so far, the states of the batches, and how it stands."""

    march: dict[str, NDArray[Any]]
    batches: tuple[BatchState, ...]
    code: int
    seconds: float
    interrupted: bool


class Solve:
    """A solve under way, in one go or from pause to pause; see `multibody.solve.Solve`."""

    def __init__(self, tree: Tree, progress: Progress | None = None) -> None:
        assert isinstance(tree.scene.method, Minimal)
        self.tree, self.method, self.progress = tree, tree.scene.method, progress
        self.march = March(tree, self.method)
        self.seconds, self._code, self._interrupted = 0.0, kernels.PAUSE, False
        self._senses = Senses(tree.system, tree.load)

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return self.march.time

    @property
    def over(self) -> bool:
        """Whether there is nothing to come."""
        end = self.tree.scene.solver.end_time_s
        stopped = self._interrupted or self._code in (kernels.REST, kernels.FAILED) or self._late(0.0)
        return stopped or self.time >= end

    def _late(self, more: float) -> bool:
        """Whether the wall time is over after some more seconds."""
        wall = self.tree.scene.solver.max_wall_s
        return wall is not None and self.seconds + more >= wall

    def advance(self, until: float = math.inf) -> None:
        """Go on to a time (s), the scene's end at the latest; does nothing when it is over."""
        end = self.tree.scene.solver.end_time_s
        if self.over:
            return
        self.march.control["end"], began = min(until, end), time.perf_counter()
        self._code = kernels.PAUSE
        try:
            while self._code == kernels.PAUSE and not self._late(time.perf_counter() - began):
                self._code = self.march.go_on()
                if self.progress is not None:
                    self.progress(self.time, end)
        except KeyboardInterrupt:
            self._interrupted = True
        self.seconds += time.perf_counter() - began

    def observe(self) -> Observations:
        """What is seen of the present state."""
        row = self.march.last
        return self._senses.read(self.time, self._coordinates(row, 0), self._coordinates(row, 1), self.march.rows[row])

    def outlines(self) -> tuple[Outline, ...]:
        """The mechanism as it is drawn, at the present state."""
        system, now = self.tree.system, slice(self.march.last, self.march.last + 1)
        q, v = (self._coordinates(now, derivative) for derivative in (0, 1))
        return Kinematics(system, at_one(system, np.array([self.time]), q, v)).outlines(0)

    def _coordinates(self, rows: int | slice, derivative: int) -> Vector:
        """Coordinates of the system (m,) or (k, m) in these rows, or their first or second derivatives by time."""
        first = 3 * len(self.tree.arrays.nodes) * derivative
        found: Vector = self.march.states[rows, first:][..., self.tree.coordinates]
        return found

    def set_to(self, joint: str, value: float) -> None:
        """Set the drive of a joint, in SI units, from now on."""
        self.tree.system.loads[joint].set_to = value

    def state(self) -> SolveState:
        """The present state."""
        batches = () if self.tree.load is None else batch_states(self.tree.load.batches)
        return SolveState(self.march.kept(), batches, self._code, self.seconds, self._interrupted)

    def restore(self, kept: SolveState) -> None:
        """Go back to a state of this solve or another one of the same scene."""
        self.march.restore(kept.march)
        if self.tree.load is not None:
            restore_batches(self.tree.load.batches, kept.batches)
        self._code, self.seconds, self._interrupted = kept.code, kept.seconds, kept.interrupted

    def close(self) -> None:
        """Let go of what is held: nothing that Python would not let go of."""

    def trajectory(self) -> Trajectory:
        """All steps so far, in the engine's coordinates."""
        march, tree = self.march, self.tree
        steps, _, evaluations = (int(count) for count in march.counts)
        rows, nodes = slice(0, steps + 1), len(tree.arrays.nodes)
        q, v, a = (self._coordinates(rows, derivative) for derivative in range(3))
        works, efforts, wanted = np.split(march.states[rows, kernels.MOVES * nodes :], [2, 2 + nodes], axis=1)
        return Trajectory(
            status=self.status(),
            cost=Cost(solve_s=self.seconds, steps=steps, newton_iterations=0, jacobians=0, load_calls=evaluations),
            time=march.rows[rows, 0].copy(),
            q=q,
            v=v,
            load=None if tree.load is None else _history(tree.load, march.rows[rows], works),
            mass=mass_matrix(tree.system),
            # A multiplier pulls the constraint back; the drive pushes along the coordinate.
            multipliers={joint: -efforts[:, node] for joint, node in tree.prescribed.items()},
            a=a if tree.prescribed else None,
            set_to={joint: wanted[:, node].copy() for joint, node in tree.set_from_outside.items()},
        )

    def status(self) -> Status:
        """How it ended."""
        solver, t = self.tree.scene.solver, self.time
        if self._interrupted:
            return ended("interrupted", t, solver)
        if self._code == kernels.FAILED:
            return Status(
                "failed",
                f"no step is small enough for method.minimal.rtol ({self.method.rtol:g}) at {t:.6g} s; raise it",
            )
        if self._code == kernels.PAUSE:
            return ended("time_limit", t, solver)
        return ended("rest" if self._code == kernels.REST else "end_time", t, solver)


def solve(tree: Tree, progress: Progress | None = None) -> Trajectory:
    """Run a tree; its trajectory is in the engine's coordinates."""
    under_way = Solve(tree, progress)
    under_way.advance()
    return under_way.trajectory()


def _history(load: GranularLoad, rows: Vector, works: Vector) -> LoadHistory:
    """What the medium did, with the works (n, 2) as they were integrated along with the motion."""
    load.table.adopt(rows, works[:, 0])
    return replace(load.history, floor_work=works[:, 1])
