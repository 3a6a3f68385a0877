"""What a run leaves behind: how it ended, its time series, key numbers and snapshots. Plain data, no engine in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

StatusCode = Literal["rest", "end_time", "time_limit", "failed", "interrupted"]
# What a stopping time is of: of a pendulum, and of all else that is not driven.
STOP_MEASURE = "from touch to the first zero of the mean rate (angular momentum over inertia, about the pivot)"
REST_MEASURE = "from touch until all of it came to rest, and stayed there"
# Columns of a term of the medium's force: about the pivot, or about the centre of mass of what has none.
MOMENT, CENTRAL_MOMENT = "moment_Nm", "moment_about_center_of_mass_Nm"
FINISHED: tuple[StatusCode, ...] = ("rest", "end_time")  # what can be relied on
# Told now and then how far a run is: simulated time and end time (s).
Progress = Callable[[float, float], None]
Compiling = Callable[[str], None]  # told in a sentence what is compiled, as it begins


@dataclass(frozen=True)
class Status:
    """How a run ended, with a sentence for people; for a failure it says what to change."""

    code: StatusCode
    message: str


@dataclass(frozen=True)
class Cost:
    """What a solve took; solve_s is wall time (s).

    full_newton: steps whose iteration was begun again with a fresh Jacobian each time; shortened_steps: those taken
    shorter than asked for, as the iteration failed; refused_steps: repeated for their error, where steps are chosen.
    """

    solve_s: float
    steps: int
    newton_iterations: int
    jacobians: int
    load_calls: int
    full_newton: int = 0
    shortened_steps: int = 0
    refused_steps: int = 0


@dataclass(frozen=True)
class Column:
    """One column of the time series: `name` ends in its unit (`tip_y_m`)."""

    name: str
    description: str


@dataclass(frozen=True)
class Outline:
    """One part of the mechanism as it is drawn.

    A disc around its only point, a bar along an open line, or the area within a closed one (its first point repeated).
    points: (n, 2) m, world frame (x horizontal, y up); diameter: m, of a disc or across a bar.
    """

    part: str
    points: NDArray[np.float64]
    diameter: float


@dataclass(frozen=True)
class Force:
    """Force (2,) N of the medium, and where it acts, point (2,) m; `body` empty: on all together."""

    body: str
    point: NDArray[np.float64]
    force: NDArray[np.float64]


@dataclass(frozen=True)
class Snapshot:
    """The mechanism at one instant (s); `label` is `touch`, `deepest` or `end`, or `frame` in an animation."""

    label: str
    time: float
    outlines: tuple[Outline, ...]
    forces: tuple[Force, ...] = ()


@dataclass(frozen=True)
class Results:
    """A finished run.

    table: (rows, len(columns)), one row per accepted step (or per `output.interval_s`), the first at t = 0.
    summary: what summary.json holds (JSON types only, SI units in the keys).
    scenario: the scenario with every default resolved, as plain YAML types.
    surface: height of the free surface (m), or of one that is not level its corners (k, 2) m, its first and last pieces
    without end; None in vacuum.
    layers: depths (m) below the surface at which other media begin; floor: height (m) of the floor, None without one.
    terms: names of the terms of the granular force, as they stand in the columns (`drag_force_x_N`).
    frames: snapshots evenly spaced in time, for an animation; none unless the run was asked for them.
    sizes: diameters and widths (m) of what was immersed.
    """

    name: str
    status: Status
    columns: tuple[Column, ...]
    table: NDArray[np.float64]
    summary: dict[str, Any]
    scenario: dict[str, Any]
    snapshots: tuple[Snapshot, ...]
    surface: float | NDArray[np.float64] | None
    warnings: tuple[str, ...] = ()
    terms: tuple[str, ...] = ()
    frames: tuple[Snapshot, ...] = ()
    layers: tuple[float, ...] = ()
    floor: float | None = None
    sizes: tuple[float, ...] = ()

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Column `name` as an array (rows,); KeyError lists the columns there are."""
        for i, column in enumerate(self.columns):
            if column.name == name:
                return self.table[:, i]
        raise KeyError(f"no column {name!r}; there are: {', '.join(c.name for c in self.columns)}")
