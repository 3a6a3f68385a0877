"""The problem of a fit: runs with their data, shared parameters and parameters of single runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from granular_contact.studies.fit.measurements import Measured
from granular_contact.studies.fit.responses import Key, Simulator
from granular_contact.values.arrays import Vector

Loss = Literal["soft_l1", "linear"]

OFFSET: Key = ("time_offset_s",)


@dataclass(frozen=True)
class Parameter:
    """A number to be estimated between `low` and `high`; it acts on `runs` (indices).

    Solvers see it scaled: its logarithm, or its position between low (0) and high (1).
    """

    key: Key
    runs: tuple[int, ...]
    low: float
    high: float
    start: float
    log: bool
    label: str

    @property
    def shared(self) -> bool:
        """Whether it is shared by runs, and not the clock or the start of a single one."""
        return "@" not in self.label

    @property
    def unit(self) -> float:
        """Length of the scale of a linear parameter."""
        return self.high - self.low

    def scaled(self, value: float) -> float:
        """The value as solvers see it."""
        return math.log(value) if self.log else value / self.unit

    def value(self, scaled: float) -> float:
        """The value of what solvers see, kept within the bounds where round-off would leave them."""
        return min(max(self.unbounded(scaled), self.low), self.high)

    def unbounded(self, scaled: float) -> float:
        """The same beyond the bounds of the search, as an end of an interval may be."""
        return math.exp(scaled) if self.log else scaled * self.unit

    def slope(self, value: float) -> float:
        """Derivative of the value by the scaled one."""
        return value if self.log else self.unit


@dataclass(frozen=True)
class MeasuredRun:
    """A measured run and its model. acting: indices of the problem's parameters, in the order of the simulator's keys.

    offset: model time is measured time less this (s), or less the parameter of index `offset_index`.
    """

    name: str
    simulator: Simulator
    measured: Measured
    acting: tuple[int, ...] = ()
    offset: float = 0.0
    offset_index: int | None = None

    def at(self, x: Vector, time: Vector) -> Vector:
        """Model values (n, columns) at times (n,) s of the measurement, for parameters x (parameters,)."""
        offset = self.offset if self.offset_index is None else x[self.offset_index]
        return self.simulator.response(tuple(float(x[i]) for i in self.acting)).at(time - offset)


@dataclass(frozen=True)
class Problem:
    """Runs, parameters and noise (of a column, in its unit; None: unknown), and how to solve.

    loss: of residuals in units of the noise; starts: how many points to start from; seed: of their choice. scatter:
    whether that of grains is separated from noise.
    """

    name: str
    runs: tuple[MeasuredRun, ...]
    parameters: tuple[Parameter, ...]
    noise: dict[str, float | None]
    loss: Loss = "soft_l1"
    starts: int = 8
    seed: int = 0
    scatter: bool = False

    @property
    def columns(self) -> list[str]:
        """What was measured in any run."""
        return list(self.noise)

    @property
    def start(self) -> Vector:
        """Start values (parameters,), scaled."""
        return np.array([p.scaled(p.start) for p in self.parameters])

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lower and upper bounds, scaled."""
        low, high = np.array([(p.scaled(p.low), p.scaled(p.high)) for p in self.parameters]).T
        return low, high

    def values(self, scaled: Vector) -> Vector:
        """Parameters (parameters,) from what solvers see."""
        return np.array([p.value(float(s)) for p, s in zip(self.parameters, scaled, strict=True)])

    def times(self) -> list[Vector]:
        """Times (n,) s of each run's data."""
        return [run.measured.time for run in self.runs]

    def data(self) -> Vector:
        """All measured values in a row: run by run, instant by instant."""
        return np.concatenate([run.measured.values.ravel() for run in self.runs])

    def split(self, values: Vector, times: Sequence[Vector] | None = None) -> list[Vector]:
        """Values in the order of `data`, or of `model` at these times, as (n, columns) of each run."""
        counts = [len(time) for time in (self.times() if times is None else times)]
        shapes = [(n, len(run.measured.columns)) for n, run in zip(counts, self.runs, strict=True)]
        parts = np.split(values, np.cumsum([n * m for n, m in shapes])[:-1])
        return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]

    def by_column(self, blocks: Sequence[Vector] | None = None) -> dict[str, list[Vector]]:
        """Series (n,) of each column in one run after another, of blocks (n, columns) of all runs or of the data."""
        found: dict[str, list[Vector]] = {name: [] for name in self.columns}
        for run, block in zip(self.runs, blocks or [run.measured.values for run in self.runs], strict=True):
            for name, series in zip(run.measured.columns, block.T, strict=True):
                found[name].append(series)
        return found

    def model(self, scaled: Vector, times: Sequence[Vector]) -> Vector:
        """The model at times of each run, in the order of `data`; raises ModelFailed."""
        x = self.values(scaled)
        return np.concatenate([run.at(x, time).ravel() for run, time in zip(self.runs, times, strict=True)])

    def column_of(self) -> NDArray[np.intp]:
        """Index into `columns` of each value of `data`."""
        indices = []
        for run in self.runs:
            own = [self.columns.index(name) for name in run.measured.columns]
            indices.append(np.tile(own, len(run.measured.time)))
        return np.concatenate(indices).astype(np.intp)
