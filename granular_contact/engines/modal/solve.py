"""Model -> Trajectory: integrate from regime to regime of the static law, to rest or to the end time."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.kernels import march as kernels
from granular_contact.engines.modal.kernels.events import HUB, MEAN
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays
from granular_contact.engines.modal.marching import March
from granular_contact.engines.modal.model import Model
from granular_contact.results import Cost, Outline, Progress, Status
from granular_contact.results.observed import Observations
from granular_contact.results.stopping import ended, paused
from granular_contact.scene.types import Vector

OVERTIME = kernels.CHATTERING + 1


@dataclass(frozen=True)
class Trajectory:
    """Rows of a solve, at multiples of the scene's step and at the last instant.

    time (rows,) s; q, v (rows, n + 1); work, damping (rows,) J: work of the medium and of the internal damping so far;
    terms (rows, 3, 3): see `sand.history`; stop: of the first zero after the touch, time (s) and q_1 (rad) for the
    mean rate, and time (s) for the hub's rate, NaN for none; turns: number of ends of regimes of the static law;
    arrays: arrays that the kernels worked on.
    """

    status: Status
    cost: Cost
    time: Vector
    q: Vector
    v: Vector
    work: Vector
    damping: Vector
    terms: Vector
    stop: tuple[float, float, float]
    turns: int
    arrays: PendulumArrays


@dataclass(frozen=True)
class SolveState:
    """State of a solve: arrays of the march, and the status."""

    march: dict[str, NDArray[Any]]
    code: int
    seconds: float
    interrupted: bool


class Solve:
    """A solve in progress, in one go or from pause to pause; see `engines.exudyn.solve.Solve`."""

    def __init__(self, model: Model, progress: Progress | None = None) -> None:
        self.model, self.progress = model, progress
        self.march = March(model)
        self.seconds, self._code, self._interrupted = 0.0, kernels.PAUSE, False

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return self.march.time

    @property
    def spent(self) -> float:
        """Wall time (s) so far."""
        return self.seconds

    @property
    def over(self) -> bool:
        """Whether the solve is finished."""
        stopped = self._code in (kernels.REST, kernels.FAILED, kernels.CHATTERING, OVERTIME)
        return self._interrupted or stopped or self._at_end

    @property
    def _at_end(self) -> bool:
        return self.time >= self.model.scene.solver.end_time_s * (1.0 - 1e-14)

    def advance(self, until: float = math.inf) -> None:
        """March to a time (s), at most to the end time of the scene; does nothing when the solve is finished."""
        if self.over:
            return
        self.march.control["end"] = min(until, self.model.scene.solver.end_time_s)
        began = time.perf_counter()
        try:
            self._code = self._integrate(began)
        except KeyboardInterrupt:
            self._interrupted = True
        self.seconds += time.perf_counter() - began

    def _integrate(self, began: float) -> int:
        """March until a reason to return; return its code. began: clock at the start (s)."""
        solver, march = self.model.scene.solver, self.march
        deadline = math.inf if solver.max_wall_s is None else began + solver.max_wall_s - self.seconds
        while True:
            code = march.go_on()
            if code not in (kernels.PAUSE, kernels.END) or self._at_end:
                return code
            if time.perf_counter() > deadline:
                return OVERTIME
            if code == kernels.END:  # the time of a pause
                return code
            if self.progress is not None:
                self.progress(march.time, solver.end_time_s)

    def observe(self) -> Observations:
        """Observations of the present state."""
        from granular_contact.engines.modal.observe import now

        return now(self.model, self._rows(self.march.now()[None, :]))

    def outlines(self) -> tuple[Outline, ...]:
        """Outlines of the mechanism at the present state, for drawing."""
        from granular_contact.engines.modal.observe import Motion

        return Motion(self.model, self._rows(self.march.now()[None, :])).outlines(0)

    def state(self) -> SolveState:
        """The present state."""
        return SolveState(self.march.kept(), self._code, self.seconds, self._interrupted)

    def restore(self, kept: SolveState) -> None:
        """Return to a state of this solve, or of another one of the same scene."""
        self.march.restore(kept.march)
        self._code, self.seconds, self._interrupted = kept.code, kept.seconds, kept.interrupted

    def close(self) -> None:
        """Release resources; the modal pendulum holds none."""

    def trajectory(self) -> Trajectory:
        """All rows so far."""
        return self._rows(self.march.table())

    def _rows(self, rows: Vector) -> Trajectory:
        march, m = self.march, self.march.size
        counts = march.counts
        return Trajectory(
            status=self.status(),
            cost=Cost(
                solve_s=self.seconds,
                steps=int(counts["steps"]),
                newton_iterations=0,
                jacobians=0,
                load_calls=int(counts["rates"]),
            ),
            time=rows[:, 0],
            q=rows[:, 1 : 1 + m],
            v=rows[:, 1 + m : 1 + 2 * m],
            work=rows[:, 1 + 2 * m],
            damping=rows[:, 2 + 2 * m],
            terms=rows[:, 3 + 2 * m :].reshape(-1, 3, 3),
            stop=first_stop(march.watch),
            turns=int(counts["turns"]),
            arrays=march.arrays,
        )

    def status(self) -> Status:
        """How the solve ended, or that it is paused."""
        if self._interrupted:
            return ended("interrupted", self.time, self.model.scene.solver)
        if self._code in (kernels.PAUSE, kernels.END) and not self._at_end:
            return paused(self.time, self.model.scene.solver)
        return status(self.model, self._code, self.time, self.march.y, self.march.true_sign)


def first_stop(watch: np.void) -> tuple[float, float, float]:
    """Field `stop` of a trajectory, from a record of WATCH."""
    time, angle = watch["time"], watch["angle"]
    return float(time[MEAN]), float(angle[MEAN]), float(time[HUB])


def solve(model: Model, progress: Progress | None = None) -> Trajectory:
    """Run a model to its end time, to rest, to a failure or to Ctrl-C; rows so far are kept."""
    under_way = Solve(model, progress)
    under_way.advance()
    return under_way.trajectory()


def status(model: Model, code: int, time: float, y: Vector, true_sign: bool) -> Status:
    """How a run ended; code: reason of the kernels; time (s) and y (see `modal_motion`): where it ended."""
    solver = model.scene.solver
    if code == kernels.CHATTERING:
        return Status(
            "failed",
            f"the static force turned round {kernels.CROWD} times within {0.1 * solver.step_s:g} s at {time:.6g} s; "
            "take method.reduced.static: elastoplastic, whose bristle gives way",
        )
    if code == OVERTIME:
        return ended("time_limit", time, solver)
    if code == kernels.FAILED:
        return Status(
            "failed",
            f"no step is small enough for method.reduced.rtol ({model.method.rtol:g}) at {time:.6g} s; raise it, or "
            "take fewer modes",
        )
    if code != kernels.REST:
        return ended("end_time", time, solver)
    if not true_sign or not _speed(model, y) > solver.rest_speed_m_s:
        return ended("rest", time, solver)
    return Status(
        "rest",
        f"at rest: the middle of the immersed part slower than {solver.rest_speed_m_s:g} m/s for "
        f"{solver.rest_time_s:g} s; the true sign holds only that point, and the link vibrates about it for ever",
    )


def _speed(model: Model, y: Vector) -> float:
    """Greatest speed (m/s) of any one coordinate."""
    lever = np.array([model.reach] + [1.0] * (model.size - 1))
    return float(np.max(np.abs(lever * y[model.size : 2 * model.size])))
