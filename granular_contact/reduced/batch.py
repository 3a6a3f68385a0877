"""Many runs marched by one compiled call, during which other threads of Python go on.

Runs may differ in all their numbers. What they have in common is the size of their arrays: modes, strips, corners.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence

import numpy as np

from granular_contact.kernels import march as kernels
from granular_contact.reduced.marching import SHARE, ahead, alone, joined
from granular_contact.reduced.solve import OWN, Solve

MOST = 64  # runs in a call
MOST_ROWS = 4096  # of a run, to begin with
MOST_IN_ALL = MOST * MOST_ROWS  # of all runs of a call at their ends: some 30 MB with a mode


def advance(solves: Sequence[Solve]) -> None:
    """Bring solves, none begun yet, to their ends; each as `Solve.advance` does it, number by number."""
    for group in _alike(solves):
        _advance(group)


def _alike(solves: Sequence[Solve]) -> Iterator[list[Solve]]:
    """Solves whose arrays have the same sizes, at most so many; alone those that have to be looked at on the way."""
    groups: dict[object, list[Solve]] = {}
    for i, one in enumerate(solves):
        solver, march = one.model.scene.solver, one.march
        watched = one.progress is not None or solver.max_wall_s is not None or one.model.method.integrator != OWN
        w = march.arrays
        sizes = tuple(array.shape for array in w), tuple(w.starts.tolist()), march.state.y.shape
        groups.setdefault(i if watched else sizes, []).append(one)
    for group in groups.values():
        rows = max(one.model.scene.solver.end_time_s / one.model.scene.solver.step_s for one in group)
        most = int(max(1, min(MOST, MOST_IN_ALL / rows)))
        for first in range(0, len(group), most):
            yield group[first : first + most]


def _advance(group: list[Solve]) -> None:
    if len(group) == 1:
        group[0].advance()
        return
    begun, marches = time.perf_counter(), [one.march for one in group]
    state, stacked = (
        joined(several) for several in ([m.state for m in marches], [alone(march.arrays) for march in marches])
    )
    limits, allowed = np.concatenate([m.control for m in marches]), np.array([m.allowed for m in marches])
    needed = ahead(limits)
    rows = int(np.max(np.minimum(MOST_ROWS, limits["end"] / limits["interval"] + 2.0) + needed))
    state = _with_rows(state, rows)
    codes = np.zeros(len(group), dtype=np.int64)
    while np.any(codes == kernels.PAUSE):
        kernels.march(SHARE, codes, state, stacked, limits, allowed, marches[0].room)
        if np.any(state.counts[:, kernels.ROWS] + needed > state.rows.shape[1]):
            state = _with_rows(state, 2 * state.rows.shape[1])
    evaluations = state.counts[:, kernels.RATES]
    seconds = (time.perf_counter() - begun) * evaluations / evaluations.sum()
    for i, one in enumerate(group):
        one.march.move(state, stacked, i)
        one.ended(int(codes[i]), float(seconds[i]))


def _with_rows(state: kernels.State, capacity: int) -> kernels.State:
    """The same with longer tables."""
    table = np.zeros((len(state.rows), capacity, state.rows.shape[2]))
    used = min(capacity, state.rows.shape[1], int(state.counts[:, kernels.ROWS].max()))
    table[:, :used] = state.rows[:, :used]
    return state._replace(rows=table)
