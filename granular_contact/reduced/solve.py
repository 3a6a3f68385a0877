"""Model -> Trajectory: integrate from regime to regime of the static law, to rest or to the end."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from granular_contact.kernels import march as kernels
from granular_contact.kernels.modal_load import World
from granular_contact.reduced.marching import March, ScipyMarch
from granular_contact.reduced.model import Model
from granular_contact.results import Cost, Progress, Status
from granular_contact.results.ending import ended
from granular_contact.scene.types import Vector

OWN = "dormand_prince"
CROWD = 50  # ends of regimes within a tenth of the scene's step that are taken for chattering
CHATTERING, OVERTIME = kernels.FAILED + 1, kernels.FAILED + 2


@dataclass(frozen=True)
class Trajectory:
    """Rows of a solve at multiples of the scene's step, and the last instant.

    time (rows,) s; q, v (rows, n + 1); work, damping (rows,) J: of the medium and of the internal damping so far;
    terms (rows, 3, 3): see `bed.history`; stop: time (s) and q_1 (rad) at the first zero of the mean rate, and
    the time of the first zero of the hub's own, NaN for none; turns: how often a regime of the static law ended;
    world: what the kernels worked on.
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
    world: World


def solve(model: Model, progress: Progress | None = None) -> Trajectory:
    """Run a model to its end time, to rest, to a failure or to Ctrl-C; what was reached by then is kept."""
    march = (March if model.method.integrator == OWN else ScipyMarch)(model)
    turns: list[float] = []
    began = time.perf_counter()
    try:
        code = _integrate(march, turns, progress)
        status = _status(model, march, code)
    except KeyboardInterrupt:
        status = ended("interrupted", march.time, model.scene.solver)
    seconds = time.perf_counter() - began
    steps, _, evaluations, _ = (int(count) for count in march.counts)
    rows, m = march.table(), march.size
    _, _, stop_time, stop_angle, _, hub_time = march.watch
    return Trajectory(
        status=status,
        cost=Cost(solve_s=seconds, steps=steps, newton_iterations=0, jacobians=0, load_calls=evaluations),
        time=rows[:, 0],
        q=rows[:, 1 : 1 + m],
        v=rows[:, 1 + m : 1 + 2 * m],
        work=rows[:, 1 + 2 * m],
        damping=rows[:, 2 + 2 * m],
        terms=rows[:, 3 + 2 * m :].reshape(-1, 3, 3),
        stop=(float(stop_time), float(stop_angle), float(hub_time)),
        turns=len(turns),
        world=march.world,
    )


def _integrate(march: March, turns: list[float], progress: Progress | None) -> int:
    """March on until it is over; the times at which regimes ended are appended to turns."""
    solver, crowd = march.model.scene.solver, list[float]()
    deadline = math.inf if solver.max_wall_s is None else time.perf_counter() + solver.max_wall_s
    while True:
        code = march.go_on()
        if code == kernels.REGIME_END:
            turns.append(march.time)
            crowd.append(march.time)
            if len(crowd) > CROWD and crowd[-1] - crowd[-CROWD] < 0.1 * solver.step_s:
                crowd.clear()
                if not march.blur():
                    return CHATTERING
            march.decide()
        elif code != kernels.PAUSE:
            return code
        if time.perf_counter() > deadline:
            return OVERTIME
        if progress is not None:
            progress(march.time, solver.end_time_s)


def _status(model: Model, march: March, code: int) -> Status:
    solver, t = model.scene.solver, march.time
    if code == CHATTERING:
        return Status(
            "failed",
            f"the static force turned round {CROWD} times within {0.1 * solver.step_s:g} s at {t:.6g} s; take "
            "method.reduced.static: elastoplastic, whose bristle gives way",
        )
    if code == OVERTIME:
        return ended("time_limit", t, solver)
    if code == kernels.FAILED:
        return Status(
            "failed",
            f"no step is small enough for method.reduced.rtol ({model.method.rtol:g}) at {t:.6g} s; raise it, or take "
            "fewer modes",
        )
    if code != kernels.REST:
        return ended("end_time", t, solver)
    if not march.true_sign or not march.speed() > solver.rest_speed_m_s:
        return ended("rest", t, solver)
    return Status(
        "rest",
        f"at rest: the middle of the immersed part slower than {solver.rest_speed_m_s:g} m/s for "
        f"{solver.rest_time_s:g} s; the true sign holds only that point, and the link vibrates about it for ever",
    )
