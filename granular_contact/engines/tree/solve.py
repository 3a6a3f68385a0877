"""Tree -> Trajectory: march to rest, to the end time, to a failure or to Ctrl-C; rows so far are kept."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from granular_contact.engines.tree.kernels import tree_march as kernels
from granular_contact.engines.tree.march import March
from granular_contact.engines.tree.tree import Tree
from granular_contact.mechanics.ending import crowded, diverged, late, unsolved
from granular_contact.mechanics.mass_and_gravity import mass_matrix
from granular_contact.mechanics.system import Trajectory, at_one
from granular_contact.results import Cost, Outline, Progress, Status
from granular_contact.results.observed import Observations
from granular_contact.results.stopping import ended, paused
from granular_contact.sand.state import BatchState, batch_states, restore_batches
from granular_contact.scene.types import Vector


@dataclass(frozen=True)
class SolveState:
    """State of a solve: the march with its rows so far, the batches of the load, and the status."""

    march: Any
    batches: tuple[BatchState, ...]
    code: int
    seconds: float
    interrupted: bool
    restarts: bool


class Solve:
    """A solve in progress, in one go or from pause to pause; see `engines.exudyn.solve.Solve`."""

    def __init__(self, tree: Tree, progress: Progress | None = None) -> None:
        self.tree, self.progress = tree, progress
        self.march = March(tree)
        self.seconds, self._code, self._interrupted = 0.0, kernels.PAUSE, False
        self._restarts = False  # whether a drive was set at the start, which changes the accelerations there
        self._sensors = tree.sensors(self.march)
        self._shown, first = [], 0  # columns of poses, their rates and accelerations of bodies in a row of states
        for name in ("pose", "pose_rates", "acceleration"):
            self._shown.append(first + tree.state_indices(name))
            first += tree.arrays[name].size
        self._efforts = first

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return self.march.time

    @property
    def spent(self) -> float:
        """Wall time (s) so far, including the time to build the granular load."""
        return self.seconds + (0.0 if self.tree.load is None else self.tree.load.building_s)

    @property
    def over(self) -> bool:
        """Whether the solve is finished."""
        end = self.tree.scene.solver.end_time_s
        stopped = self._interrupted or self._code not in (kernels.PAUSE, kernels.END) or self._late(0.0)
        return stopped or self.time >= end

    def _late(self, more: float) -> bool:
        """Return whether the limit of wall time is reached `more` seconds from now."""
        wall = self.tree.scene.solver.max_wall_s
        return wall is not None and self.spent + more >= wall

    def advance(self, until: float = math.inf) -> None:
        """March to a time (s), at most to the end time of the scene; does nothing when the solve is finished."""
        end = self.tree.scene.solver.end_time_s
        if self.over:
            return
        if self._restarts:
            self.march.begin()
            self._restarts = False
        self.march.plan(min(until, end))
        self._code, began = kernels.PAUSE, time.perf_counter()
        try:
            while self._code == kernels.PAUSE and not self._late(time.perf_counter() - began):
                self._code = self.march.proceed()
                if self.progress is not None:
                    self.progress(self.time, end)
        except KeyboardInterrupt:
            self._interrupted = True
        self.seconds += time.perf_counter() - began

    def observe(self) -> Observations:
        """Observations of the present state."""
        row = self.march.last
        return self._sensors.read(self.time, self._coordinates(row, 0), self._coordinates(row, 1), self.march.rows[row])

    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of the mechanism at the present state, for drawing."""
        system, now = self.tree.system, slice(self.march.last, self.march.last + 1)
        q, v = (self._coordinates(now, derivative) for derivative in (0, 1))
        return system.kinematics(at_one(system, np.array([self.time]), q, v)).outlines(0)

    def _coordinates(self, rows: int | slice, derivative: int) -> Vector:
        """Coordinates of the system (m,) or (k, m) in these rows, their rates, or accelerations of the kernels."""
        coordinates: Vector = self.march.states[rows][..., self._shown[derivative]]
        return coordinates

    def set_to(self, joint: str, value: float) -> None:
        """Set the target of the drive of a joint, in SI units, from now on; at the start, find accelerations anew."""
        load = self.tree.system.loads[joint]
        self._restarts |= self.march.last == 0 and load.set_to != value
        load.set_to = value

    def state(self) -> SolveState:
        """The present state."""
        batches = () if self.tree.load is None else batch_states(self.tree.load.batches)
        stands = self._code, self.seconds, self._interrupted, self._restarts
        return SolveState(self.march.kept(), batches, *stands)

    def restore(self, kept: SolveState) -> None:
        """Return to a state of this solve, or of another one of the same scene."""
        self.march.restore(kept.march)
        if self.tree.load is not None:
            restore_batches(self.tree.load.batches, kept.batches)
        self._code, self.seconds = kept.code, kept.seconds
        self._interrupted, self._restarts = kept.interrupted, kept.restarts

    def close(self) -> None:
        """Release resources; a tree holds none."""

    def trajectory(self) -> Trajectory:
        """All steps so far, in the coordinates of the engine."""
        march, tree = self.march, self.tree
        rows = slice(0, march.last + 1)
        q, v, a = (self._coordinates(rows, derivative) for derivative in range(3))
        efforts, wanted = np.split(march.states[rows, self._efforts :], 2, axis=1)
        if tree.load is not None:
            tree.load.table.replace_rows(march.rows[rows])
        return Trajectory(
            status=self.status(),
            cost=self._cost(),
            time=march.rows[rows, 0].copy(),
            q=q,
            v=v,
            load=None if tree.load is None else tree.load.history,
            mass=mass_matrix(tree.system),
            # The multiplier of the engine's constraint has the sign opposite to the effort along the coordinate.
            multipliers={joint: -efforts[:, node] for joint, node in tree.prescribed.items()},
            a=tree.accelerations(q, a) if tree.prescribed else None,
            mode_residuals=tree.mode_residuals(efforts),
            set_to={joint: wanted[:, node].copy() for joint, node in tree.set_from_outside.items()},
        )

    def _cost(self) -> Cost:
        counted = self.march.cost
        calls = 0 if self.tree.load is None else counted["newton_iterations"]
        return Cost(solve_s=self.seconds, load_calls=calls, **counted)

    def status(self) -> Status:
        """How the solve ended, or that it is paused."""
        scene, t, code = self.tree.scene, self.time, self._code
        if self._interrupted:
            return ended("interrupted", t, scene.solver)
        step = self.march.tried
        if code == kernels.FAILED:
            return unsolved(scene, t, step)
        if code == kernels.AWAY:
            return diverged(scene, t)
        if code == kernels.MANY_STEPS:
            return crowded(scene, t, self.march.last, step)
        if code == kernels.REST:
            return ended("rest", t, scene.solver)
        if t < scene.solver.end_time_s:  # END of the kernels may be that of a pause
            return late(scene, t) if self._late(0.0) else paused(t, scene.solver)
        return ended("end_time", t, scene.solver)


def solve(tree: Tree, progress: Progress | None = None) -> Trajectory:
    """Run a tree; its trajectory is in the coordinates of the engine."""
    under_way = Solve(tree, progress)
    under_way.advance()
    return under_way.trajectory()
