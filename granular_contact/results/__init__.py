"""What a run leaves behind: how it ended, its time series, key numbers and snapshots. Plain data, no engine in it.

observation                    what was observed of a solved scene -> Results
series, in_space               columns, in the plane and in space
summary, stopping              key numbers: of all, drives and strides; touch and stop, how a run ended
energy, limits, accuracy       energy balance; what was left or exceeded; estimates of the error
alike                          warnings of many runs, those that differ only in numbers as one
interpolation                  numbers between steps
frames, motion                 pictures, and the motion as it is played
observed                       one instant, by name
methods                        what of `Results` needs the rooms above (folders, figures), loaded when it is called
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import unknown_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from granular_contact.results.methods import Film
    from granular_contact.results.motion import Motion

StatusCode = Literal["rest", "end_time", "time_limit", "failed", "interrupted"]
# What a stopping time is of: of a pendulum, and of all else that is not driven.
STOP_MEASURE = "from touch to the first zero of the mean rate (angular momentum over inertia, about the pivot)"
REST_MEASURE = "from touch until all of it came to rest, and stayed there"
# Columns of a term of the medium's force: about the pivot, or about the centre of mass of what has none.
MOMENT, CENTRAL_MOMENT = "moment_Nm", "moment_about_center_of_mass_Nm"
WELDS = ("weld", "fixed")
FINISHED: tuple[StatusCode, ...] = ("rest", "end_time")  # what can be relied on
# Called now and then with how far a run is: simulated time and end time (s).
Progress = Callable[[float, float], None]
Compiling = Callable[[str], None]  # called with a sentence on what is compiled, as it begins


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


@dataclass(frozen=True, repr=False)
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
    motion: how it moved, as it is played; of runs in space, where there are no frames.
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
    frames: Sequence[Snapshot] = ()
    layers: tuple[float, ...] = ()
    floor: float | None = None
    sizes: tuple[float, ...] = ()
    motion: Motion | None = None

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Column `name` as an array (rows,); KeyError says which are nearest, or what there is."""
        for i, column in enumerate(self.columns):
            if column.name == name:
                return self.table[:, i]
        raise KeyError(unknown_name("column", name, self.names, self._welded()))

    def _welded(self) -> dict[str, str]:
        """Of each body that is welded to another, the one nearest to the ground that it moves with."""
        model = self.scenario.get("model")
        joints = (model.get("joints") if isinstance(model, dict) else None) or {}
        parents = {one["child"]: one["parent"] for one in joints.values() if one["type"] in WELDS}
        found = {}
        for body in parents:
            root = body
            while root in parents:
                root = parents[root]
            found[body] = root
        return found

    @property
    def names(self) -> list[str]:
        """Names of the columns."""
        return [column.name for column in self.columns]

    def _ipython_key_completions_(self) -> list[str]:
        return self.names

    def __repr__(self) -> str:
        rows, columns = self.table.shape
        warned = f", {len(self.warnings)} warning{'s' * (len(self.warnings) > 1)}" if self.warnings else ""
        return f"<results of {self.name}: {self.status.message}; {rows} rows, {columns} columns{warned}>"

    def _repr_html_(self) -> str:
        from granular_contact.results.methods import notebook

        return notebook(self)

    def to_dataframe(self) -> DataFrame:
        """The table as a pandas DataFrame, one row per accepted step.

        Returns
        -------
        DataFrame
            What columns mean is in its `attrs`.

        Raises
        ------
        MissingPackageError
            There is no pandas.
        """
        from granular_contact.results.methods import dataframe

        return dataframe(self)

    def plot(self, *names: str) -> Figure:
        """Columns over time, a panel for each unit.

        Parameters
        ----------
        *names : str
            Columns, as "tip_y_m".

        Returns
        -------
        Figure
            A notebook shows it, `savefig` saves it.

        Raises
        ------
        KeyError
            There is no such column.
        """
        from granular_contact.results.methods import plot

        return plot(self, names)

    def figures(self) -> dict[str, Figure]:
        """All figures that a run is saved with.

        Returns
        -------
        dict of Figure
            By name, as `motion`, `forces`, `energy`, `mechanism`; which there are depends on what moves.

        Examples
        --------
        >>> simulate("pendulum").figures()["forces"].savefig("forces.pdf")  # doctest: +SKIP
        """
        from granular_contact.results.methods import figures

        return figures(self)

    def animation(self, file: str | PathLike[str] = "animation.gif") -> Film:
        """Write the motion as a film, to scale, with the forces of the medium; a notebook shows it.

        Parameters
        ----------
        file : str or path
            Ends in .gif, or in .mp4 for which ffmpeg has to be on the path.

        Returns
        -------
        Film
            The file, as a path that is shown.

        Raises
        ------
        ResultsError
            The run was not asked for pictures (`most_frames`), or the file has another ending.
        OSError
            The disk refuses, or ffmpeg is missing or fails.
        """
        from granular_contact.results.methods import animation

        return animation(self, Path(file))

    def save(self, directory: str | PathLike[str], *, figures: bool = True) -> Path:
        """Write a results folder, as the command `run` does, in place of an earlier run's results there.

        Parameters
        ----------
        directory : str or path
            Folder; it is there whole or not at all.
        figures : bool
            Whether to draw the figures, which takes a second or two.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        OSError
            The disk refuses, or the folder holds what no run wrote.
        """
        from granular_contact.results.methods import save

        return save(self, Path(directory), figures)

    @classmethod
    def open(cls, directory: str | PathLike[str]) -> Results:
        """The results in a folder that a run or `save` wrote: the same table, summary, warnings and scenario.

        NaN in a summary is None after it. `snapshots` and `sizes` are not saved, so there are none.

        Parameters
        ----------
        directory : str or path
            Folder of the run.

        Returns
        -------
        Results
            The run.

        Raises
        ------
        ResultsError
            The folder holds no run, or a damaged one; one line says which file and what is wrong.
        """
        from granular_contact.results.methods import opened

        return opened(Path(directory))
