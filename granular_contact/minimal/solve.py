"""Tree -> Trajectory: march to rest, to the end, to a failure or to Ctrl-C; what was reached by then is kept."""

from __future__ import annotations

import time

import numpy as np

from granular_contact.bed.history import HistoryTable, LoadHistory
from granular_contact.bed.load import GranularLoad
from granular_contact.kernels import tree_march as kernels
from granular_contact.minimal.tree import Tree
from granular_contact.multibody.mass_and_gravity import mass_matrix
from granular_contact.multibody.system import Trajectory
from granular_contact.results import Cost, Progress, Status
from granular_contact.results.ending import ended
from granular_contact.scene.types import Minimal, Scene, Vector

SHARE = 1024  # steps between two looks at the progress bar
FIRST_STEP = 0.1  # of the scene's
LEAST_REACH = 1e-3  # m, of a mechanism that is all on its hinge


class March:
    """State of a solve, as `kernels.tree_march` keeps it up to date; the arrays are explained there."""

    def __init__(self, tree: Tree, method: Minimal) -> None:
        scene, self.tree, bodies = tree.scene, tree, len(tree.forest.bodies)
        solver = scene.solver
        reach, speed = _size(scene)
        self.y = tree.start.copy()
        self.control = np.zeros(1, kernels.CONTROL)
        self.control["end"], self.control["longest"] = solver.end_time_s, solver.step_s
        self.control["rest_speed"] = solver.rest_speed_m_s
        self.control["rest_time"] = np.inf if solver.rest_time_s is None else solver.rest_time_s
        self.control["allowed"] = [[method.rtol * reach, method.rtol * speed]]
        self.clock = np.array([0.0, FIRST_STEP * solver.step_s, 0.0, 0.0, kernels.OLD])
        self.counts = np.zeros(3, dtype=np.int64)
        self.direction = np.zeros_like(self.y)
        self.blank = (HistoryTable() if tree.load is None else tree.load.table).blank
        self.states = np.zeros((SHARE, 6 * bodies + 1))
        self.rows = np.zeros((SHARE, len(self.blank)))
        kernels.start(self.y, tree.forest, self.blank, self.states, self.rows)
        self._march(self.rows[:1])  # is full: compiles the march or loads it, which is no part of a solve

    def go_on(self) -> int:
        """March until the tables are full, then make room; why is one of the kernels' codes."""
        code = self._march(self.rows)
        if code == kernels.PAUSE:
            self.states = np.concatenate([self.states, np.zeros((SHARE, self.states.shape[1]))])
            self.rows = np.concatenate([self.rows, np.zeros((SHARE, self.rows.shape[1]))])
        return code

    def _march(self, rows: Vector) -> int:
        state = self.y, self.tree.forest, self.control, self.clock, self.counts, self.direction
        return int(kernels.march(*state, self.blank, self.states, rows))

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return float(self.clock[kernels.NOW])


def _size(scene: Scene) -> tuple[float, float]:
    """Reach (m) of the mechanism and scale of its speeds (m/s)."""
    reach = max(
        body.workspace.radius(p) + shape.drop for body in scene.rigid for shape in body.shapes for p in shape.points
    )
    reach = max(reach, LEAST_REACH)
    rate = max(abs(body.motion.rate) for body in scene.rigid)
    return reach, max(reach * rate + float(np.sqrt(abs(scene.gravity) * reach)), 1e-6)


def solve(tree: Tree, progress: Progress | None = None) -> Trajectory:
    """Run a tree; its trajectory is in the engine's coordinates."""
    scene = tree.scene
    assert isinstance(scene.method, Minimal)
    march = March(tree, scene.method)
    code, began = kernels.PAUSE, time.perf_counter()
    wall = scene.solver.max_wall_s
    try:
        while code == kernels.PAUSE and (wall is None or time.perf_counter() - began < wall):
            code = march.go_on()
            if progress is not None:
                progress(march.time, scene.solver.end_time_s)
        status = _status(scene, scene.method, code, march.time)
    except KeyboardInterrupt:
        status = ended("interrupted", march.time, scene.solver)
    seconds = time.perf_counter() - began
    steps, _, evaluations = (int(count) for count in march.counts)
    count = 3 * len(tree.forest.bodies)
    states = march.states[: steps + 1]
    return Trajectory(
        status=status,
        cost=Cost(solve_s=seconds, steps=steps, newton_iterations=0, jacobians=0, load_calls=evaluations),
        time=march.rows[: steps + 1, 0].copy(),
        q=states[:, :count],
        v=states[:, count : 2 * count],
        load=None if tree.load is None else _history(tree.load, march.rows[: steps + 1], states[:, 2 * count]),
        mass=mass_matrix(tree.system),
        reactions={},
    )


def _history(load: GranularLoad, rows: Vector, work: Vector) -> LoadHistory:
    """What the medium did, with the work as it was integrated along with the motion."""
    load.table.adopt(rows, work)
    return load.history


def _status(scene: Scene, method: Minimal, code: int, t: float) -> Status:
    if code == kernels.FAILED:
        return Status(
            "failed",
            f"no step is small enough for method.minimal.rtol ({method.rtol:g}) at {t:.6g} s; raise it",
        )
    if code == kernels.PAUSE:
        return ended("time_limit", t, scene.solver)
    return ended("rest" if code == kernels.REST else "end_time", t, scene.solver)
