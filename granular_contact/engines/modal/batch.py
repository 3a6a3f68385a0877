"""Key numbers of many runs, marched by one compiled call, during which other threads of Python go on.

Runs may differ in all numbers. They share the sizes of their arrays: modes, strips, corners. Work before and after the
march is done for all runs at once, wherever it is more than a few numbers.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal import energies
from granular_contact.engines.modal.arrays import stacked
from granular_contact.engines.modal.extremes import known
from granular_contact.engines.modal.kernels import march as kernels
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays
from granular_contact.engines.modal.marching import SHARE, SHORT, ahead, allowed, begin, control, room, started
from granular_contact.engines.modal.model import Model
from granular_contact.engines.modal.observe import observe, stop
from granular_contact.engines.modal.solve import first_stop, solve, status
from granular_contact.results import Cost
from granular_contact.results.observation import Known, key_numbers, warned
from granular_contact.results.stopping import touched
from granular_contact.results.summary import least_energy, summarise
from granular_contact.scene.types import Vector

MOST = 64  # greatest number of runs in a call
MOST_ROWS = 4096  # greatest number of rows that a table has at first
MOST_IN_ALL = MOST * MOST_ROWS  # rows of all runs of a call at their ends: some 30 MB with one mode


class Marched(NamedTuple):
    """Runs at their ends.

    codes, seconds (runs,): reason of the end, and share of the wall time (s), of each run; state, arrays: of all runs;
    first (runs + 1,): first row of each run in table (rows, columns of `State.rows` without forces). The last row of a
    run is at the time that it reached.
    """

    codes: NDArray[np.int64]
    seconds: Vector
    state: kernels.State
    arrays: PendulumArrays
    first: NDArray[np.int64]
    table: Vector


def summaries(models: Sequence[Model]) -> list[dict[str, Any]]:
    """Summary of the run of each model, as if it were run alone."""
    summary: dict[int, dict[str, Any]] = {}
    for indices in _alike(models):
        group = [models[i] for i in indices]
        numbers = [key_numbers(observe(group[0], solve(group[0])))[0]] if len(group) == 1 else _summaries(group)
        summary.update(zip(indices, numbers, strict=True))
    return [summary[i] for i in range(len(models))]


def _alike(models: Sequence[Model]) -> Iterator[list[int]]:
    """Indices of models in groups of equal array sizes, of limited length; with a limit of wall time a run is alone."""
    groups: dict[object, list[int]] = {}
    for i, model in enumerate(models):
        watched = model.scene.solver.max_wall_s is not None
        groups.setdefault(i if watched else _sizes(model), []).append(i)
    for group in groups.values():
        solvers = [models[i].scene.solver for i in group]
        rows = max(solver.end_time_s / solver.step_s for solver in solvers)
        most = int(max(1, min(MOST, MOST_IN_ALL / rows)))
        for first in range(0, len(group), most):
            yield group[first : first + most]


def _sizes(model: Model) -> object:
    strips = tuple((bar.strips, bar.bends) for bar in model.bars)
    return (
        model.size,
        model.method.static,
        model.met,
        strips,
        len(model.lines.points),
        bool(model.scene.media),
    )


def _summaries(group: Sequence[Model]) -> list[dict[str, Any]]:
    """Summaries of a group of several models with equal array sizes."""
    runs, m = march(group), group[0].size
    extremes = known(group, runs.first, runs.table)
    mass = energies.mass(runs.arrays.pendulum, m - 1, np.diff(runs.first))
    stored = energies.stored(runs.table[:, 1 : 1 + m], runs.table[:, 1 + m : 1 + 2 * m], mass)
    least = np.array([least_energy(model.scene) for model in group])
    numbers = energies.key_numbers(runs.first, stored, runs.table[:, 1 + 2 * m : 3 + 2 * m], least)
    return [_summary(runs, i, *of_run) for i, of_run in enumerate(zip(group, extremes, numbers, strict=True))]


def march(group: Sequence[Model]) -> Marched:
    """March the runs of models with equal array sizes to their ends; numbers are the same as by `Solve.advance`."""
    begun, w = time.perf_counter(), stacked(group)
    limits, errors = control(group, w, forces=False), allowed(group)
    needed = ahead(limits)
    rows = int(np.max(np.minimum(MOST_ROWS, limits["end"] / limits["interval"] + 2.0) + needed))
    state = started(np.array([model.start for model in group]), rows)
    state.clock["step"] = SHORT * limits["interval"]
    for i in range(len(group)):
        begin(state, w, i)
    codes, work = np.zeros(len(group), dtype=np.int64), room(group[0].method)
    while np.any(codes == kernels.PAUSE):
        kernels.march(SHARE, codes, state, w, limits, errors, work)
        if np.any(state.counts["rows"] + needed > state.rows.shape[1]):
            state = _with_rows(state, 2 * state.rows.shape[1])
    used = [_ended(state, i) for i in range(len(group))]
    evaluations = state.counts["rates"]
    seconds = (time.perf_counter() - begun) * evaluations / evaluations.sum()
    table = np.concatenate([state.rows[i, :count] for i, count in enumerate(used)])
    return Marched(codes, seconds, state, w, np.cumsum([0, *used]), table)


def _with_rows(state: kernels.State, capacity: int) -> kernels.State:
    """The same state, with tables of `capacity` rows."""
    table = np.zeros((len(state.rows), capacity, state.rows.shape[2]))
    used = min(capacity, state.rows.shape[1], int(state.counts["rows"].max()))
    table[:, :used] = state.rows[:, :used]
    return state._replace(rows=table)


def _ended(state: kernels.State, i: int) -> int:
    """Write a row for the time that a run reached, unless it is the last row; return the number of its rows."""
    count, now = int(state.counts["rows"][i]), float(state.clock["now"][i])
    if count and state.rows[i, count - 1, 0] >= now:
        return count
    state.rows[i, count, 0], state.rows[i, count, 1 : 1 + state.y.shape[1]] = now, state.y[i]
    return count + 1


def _summary(runs: Marched, i: int, model: Model, extremes: Known, energy: dict[str, float]) -> dict[str, Any]:
    """Summary of the i-th run; energy: its key numbers."""
    state, times = runs.state, runs.table[runs.first[i] : runs.first[i + 1], 0]
    counts, watch = state.counts[i], state.watch[i]
    cost = Cost(float(runs.seconds[i]), int(counts["steps"]), 0, 0, int(counts["rates"]))
    true_sign = bool(runs.arrays.pendulum["true_sign"][i])
    ended = status(model, int(runs.codes[i]), float(state.clock["now"][i]), state.y[i], true_sign)
    touch = None if extremes.touch is None else touched(times, extremes.touch)
    stopped = None if touch is None else stop(model, first_stop(watch))
    summary = summarise(model.scene, ended, cost, energy, touch, stopped, extremes.greatest)
    summary["static_turns"] = int(counts["turns"])
    start = None if extremes.depth is None else float(extremes.depth[0])
    return warned(summary, model.scene, extremes.greatest, extremes.reach, start)
