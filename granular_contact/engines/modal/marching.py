"""State of a solve of the modal pendulum, and its march by the Runge-Kutta pair of Tsitouras (2011)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.arrays import alone, arrays_of, one_of
from granular_contact.engines.modal.kernels import march as kernels
from granular_contact.engines.modal.kernels.events import WATCH
from granular_contact.engines.modal.kernels.modal_load import PendulumArrays, rest
from granular_contact.engines.modal.kernels.modal_motion import decide
from granular_contact.engines.modal.kernels.runge_kutta import STAGES, TSITOURAS
from granular_contact.engines.modal.model import Model
from granular_contact.scene.types import Reduced, Vector

SHARE = 4096  # steps between two updates of progress bar and wall time
# Longest step, in steps of the scene: bristles yield only at the end of a step; the true sign has no such memory.
LONGEST, LONGEST_OF_BRISTLES = 50.0, 5.0
MOST_STILL = 1e-5  # upper bound of the speed that counts as none, as a share of the speed of the scene
SHORT = 0.1  # of the scene's step: length of the first step, and the time in which regimes crowd


def started(y: Vector, capacity: int) -> kernels.State:
    """State of several runs at their starts y (runs, size), with room for `capacity` rows each."""
    count, size = y.shape
    parts = min(2, (size - 2) // 2)
    watch = np.zeros(count, WATCH)
    watch["time"] = watch["angle"] = np.nan
    return kernels.State(
        y=y.copy(),
        regime=np.ones((count, parts)),
        stopped=np.zeros((count, parts), dtype=bool),
        clock=np.zeros(count, kernels.CLOCK),
        counts=np.zeros(count, kernels.COUNTS),
        watch=watch,
        turns=np.zeros((count, kernels.CROWD)),
        rows=np.zeros((count, capacity, 1 + size + 9)),
    )


def room(method: Reduced) -> kernels.Room:
    """Work space of a march."""
    size = 2 * method.modes + 4
    return kernels.Room(TSITOURAS, np.zeros((STAGES, size)), np.zeros((5, size)), np.zeros(size))


def control(several: Sequence[Model], w: PendulumArrays, *, forces: bool) -> NDArray[np.void]:
    """Records (runs,) of the kernels' CONTROL; w: arrays of the runs, which all have either the true sign or bristles.

    forces: whether rows have the forces of the medium.
    """
    made = np.zeros(len(several), kernels.CONTROL)
    solvers = [model.scene.solver for model in several]
    made["end"], made["interval"] = [solver.end_time_s for solver in solvers], [solver.step_s for solver in solvers]
    bristles = w.lines.shape[-1] > 0 and not w.pendulum["true_sign"][0]
    made["longest"] = made["interval"] * (LONGEST_OF_BRISTLES if bristles else LONGEST)
    made["reach"], made["rest_speed"] = [m.reach for m in several], [solver.rest_speed_m_s for solver in solvers]
    made["rest_time"] = [np.inf if solver.rest_time_s is None else solver.rest_time_s for solver in solvers]
    made["crowd"], made["blurred"] = SHORT * made["interval"], [MOST_STILL * model.speed for model in several]
    made["forces"] = forces
    return made


def ahead(limits: NDArray[np.void]) -> NDArray[np.int64]:
    """`kernels.rows_of_a_step` of several runs, from their records of CONTROL (runs,)."""
    rows: NDArray[np.int64] = (limits["longest"] / limits["interval"]).astype(np.int64) + 2
    return rows


def allowed(several: Sequence[Model]) -> Vector:
    """Allowed error (runs, 2 n + 2) of each coordinate and rate in a step."""
    rtol, reach, speed = np.array([[m.method.rtol, m.reach, m.speed] for m in several]).T[:, :, None]
    lengths = np.repeat(reach, several[0].size, axis=1)
    lengths[:, 0] = 1.0
    error: Vector = rtol * np.concatenate([lengths, lengths * speed / reach], axis=1)
    return error


def begin(state: kernels.State, w: PendulumArrays, i: int) -> None:
    """Put the anchors of the i-th run at its stations, or choose its first regime of the true sign."""
    y, run = state.y[i], one_of(w, i)
    if run.pendulum["true_sign"][0]:
        decide(y, state.regime[i], state.stopped[i], run)
        return
    for first, end in zip(w.starts[:-1], w.starts[1:], strict=True):
        rest(y[: run.pendulum["modes"][0] + 1], run.geometry[first:end], run.anchors[first:end])


class March:
    """State of a solve; `kernels.march` changes the arrays, and explains them."""

    def __init__(self, model: Model) -> None:
        self.model, self.arrays = model, arrays_of(model)
        self.size, self.true_sign = model.size, bool(self.arrays.pendulum["true_sign"][0])
        self.control = control([model], self.arrays, forces=True)
        self._take_places(started(model.start[None], 1024))
        self.clock["step"] = SHORT * model.scene.solver.step_s
        self.allowed, self.room = allowed([model])[0], room(model.method)
        self.codes = np.zeros(1, dtype=np.int64)
        begin(self.state, alone(self.arrays), 0)
        self.warm()

    def _take_places(self, state: kernels.State) -> None:
        self.state = state
        self.y, self.regime, self.stopped, self.clock, self.counts, self.watch, *_ = (array[0] for array in state)

    @property
    def rows(self) -> Vector:
        """Table to be filled."""
        table: Vector = self.state.rows[0]
        return table

    @property
    def time(self) -> float:
        """Time reached (s)."""
        return float(self.clock["now"])

    def go_on(self) -> int:
        """March for a share of steps, and enlarge the table if needed; return the code of the reason to return."""
        code = self._march()
        if self.full:
            self._more_rows(2 * len(self.rows))
        return code

    @property
    def full(self) -> bool:
        """Whether the table may lack room for the rows of the next step."""
        return bool(self.counts["rows"] + ahead(self.control)[0] > len(self.rows))

    def _more_rows(self, capacity: int) -> None:
        used = min(int(self.counts["rows"]), len(self.rows))
        table = np.zeros((1, capacity, self.rows.shape[1]))
        table[0, :used] = self.rows[:used]
        self.state = self.state._replace(rows=table)

    def warm(self) -> None:
        """Compile the kernels of the march, or load them, which is no part of a solve; changes nothing."""
        self._march(0)
        kernels.write_row(self.time, self.y, self.regime, self.arrays, np.zeros_like(self.rows[0]))

    def _march(self, share: int = SHARE) -> int:
        self.codes[0] = kernels.PAUSE
        kernels.march(share, self.codes, self.state, alone(self.arrays), self.control, self.allowed[None], self.room)
        return int(self.codes[0])

    def table(self) -> Vector:
        """Rows so far, and a row for the time reached unless it is the last of them."""
        count = int(self.counts["rows"])
        rows = self.rows[:count]
        if count and rows[-1, 0] >= self.time:
            return rows.copy()
        return np.vstack([rows, self.now()])

    def now(self) -> Vector:
        """Row for the time reached; the table need not have room for it."""
        row: Vector = np.zeros_like(self.rows[0])
        kernels.write_row(self.time, self.y, self.regime, self.arrays, row)
        return row

    def kept(self) -> dict[str, NDArray[Any]]:
        """Copies of all arrays that determine the future of the march, and of its rows."""
        arrays = {name: array.copy() for name, array in self._changing().items()}
        return arrays | {"rows": self.rows[: int(self.counts["rows"])].copy()}

    def restore(self, kept: dict[str, NDArray[Any]]) -> None:
        """Return to a state from `kept`."""
        for name, array in self._changing().items():
            array[...] = kept[name]
        used = len(kept["rows"])
        if used > len(self.rows):
            self._more_rows(2 * used)
        self.rows[:used] = kept["rows"]

    def _changing(self) -> dict[str, NDArray[Any]]:
        arrays = {name: array[:1] for name, array in self.state._asdict().items() if name != "rows"}
        return arrays | {"anchors": self.arrays.anchors, "still": self.arrays.pendulum["still"]}
