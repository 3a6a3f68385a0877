"""Problem of a fit: measured runs, parameters shared by runs, and parameters of single runs."""

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

    The solver works with scaled values: the logarithm, or the value divided by high - low.
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
        """Whether it is a parameter of the config of all runs, and not of a single run."""
        return "@" not in self.label

    @property
    def unit(self) -> float:
        """Length of the scale of a linear parameter."""
        return self.high - self.low

    def scaled(self, value: float) -> float:
        """Scale a value."""
        return math.log(value) if self.log else value / self.unit

    def value(self, scaled: float) -> float:
        """Inverse of `scaled`, limited to the bounds, which round-off could exceed."""
        return min(max(self.unbounded(scaled), self.low), self.high)

    def unbounded(self, scaled: float) -> float:
        """Inverse of `scaled` without the bounds, for the ends of confidence intervals."""
        return math.exp(scaled) if self.log else scaled * self.unit

    def slope(self, value: float) -> float:
        """Derivative of the value with respect to the scaled value."""
        return value if self.log else self.unit


@dataclass(frozen=True)
class MeasuredRun:
    """A measured run and its model.

    acting: indices of the parameters that act on the run, in the order of the simulator's keys. offset: model time is
    measured time minus this offset (s), or minus the parameter of index `offset_index` if the offset is fitted.
    """

    name: str
    simulator: Simulator
    measured: Measured
    acting: tuple[int, ...] = ()
    offset: float = 0.0
    offset_index: int | None = None

    def at(self, x: Vector, time: Vector) -> Vector:
        """Model values (n, columns) at measured times (n,) s, for parameters x (parameters,), not scaled."""
        offset = self.offset if self.offset_index is None else x[self.offset_index]
        return self.simulator.response(tuple(float(x[i]) for i in self.acting)).at(time - offset)


@dataclass(frozen=True)
class Problem:
    """Runs, parameters, noise and options of a fit.

    noise: standard deviation of each column, in its unit; None if unknown. loss: of residuals in units of the noise;
    starts: number of starting points; seed: of their random choice. scatter: whether the scatter of grains is separated
    from noise.
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
        """Columns measured in at least one run."""
        return list(self.noise)

    @property
    def start(self) -> Vector:
        """Start values (parameters,), scaled."""
        return np.array([parameter.scaled(parameter.start) for parameter in self.parameters])

    @property
    def bounds(self) -> tuple[Vector, Vector]:
        """Lower and upper bounds (parameters,), scaled."""
        pairs = [(parameter.scaled(parameter.low), parameter.scaled(parameter.high)) for parameter in self.parameters]
        low, high = np.array(pairs).T
        return low, high

    def values(self, scaled: Vector) -> Vector:
        """Parameters (parameters,) from scaled values."""
        return np.array([parameter.value(float(s)) for parameter, s in zip(self.parameters, scaled, strict=True)])

    def times(self) -> list[Vector]:
        """Times (n,) s of each run's data."""
        return [run.measured.time for run in self.runs]

    def data(self) -> Vector:
        """All measured values (values,): run by run, in each run row by row."""
        return np.concatenate([run.measured.values.ravel() for run in self.runs])

    def split(self, values: Vector, times: Sequence[Vector] | None = None) -> list[Vector]:
        """Split values in the order of `data`, or of `model` at the given times, into (n, columns) of each run."""
        counts = [len(time) for time in (self.times() if times is None else times)]
        shapes = [(n, len(run.measured.columns)) for n, run in zip(counts, self.runs, strict=True)]
        parts = np.split(values, np.cumsum([n * m for n, m in shapes])[:-1])
        return [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]

    def by_column(self, blocks: Sequence[Vector] | None = None) -> dict[str, list[Vector]]:
        """For each column the list of its series (n,) in all runs, from blocks (n, columns) of each run or the data."""
        columns: dict[str, list[Vector]] = {name: [] for name in self.columns}
        for run, block in zip(self.runs, blocks or [run.measured.values for run in self.runs], strict=True):
            for name, series in zip(run.measured.columns, block.T, strict=True):
                columns[name].append(series)
        return columns

    def model(self, scaled: Vector, times: Sequence[Vector]) -> Vector:
        """Model values at the given times of each run, in the order of `data`; raises ModelFailed."""
        x = self.values(scaled)
        return np.concatenate([run.at(x, time).ravel() for run, time in zip(self.runs, times, strict=True)])

    def column_indices(self) -> NDArray[np.intp]:
        """Index into `columns` of each value of `data`."""
        indices = []
        for run in self.runs:
            row = [self.columns.index(name) for name in run.measured.columns]
            indices.append(np.tile(row, len(run.measured.time)))
        return np.concatenate(indices).astype(np.intp)
