"""Results of a run: its status, time series, key numbers and snapshots. Plain data, independent of the engine.

observation                    `Observation` of a solved scene, and the `Results` made from it
series, in_space               columns of the time series, in the plane and in space
summary, stopping              key numbers of the run, its drives and strides; first touch, stop, status of the run
energy, limits, accuracy       energy balance; ranges that the run exceeded; estimates of the error
alike                          warnings of many runs, grouped where they differ only in numbers
interpolation                  values between time steps
frames, motion                 pictures evenly spaced in time; the motion for playback
observed                       observations of one instant, by name
methods                        methods of `Results` that need the rooms above (folders, figures), imported at the call
"""

from __future__ import annotations

import os
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
# Definition of the stopping time: of a pendulum, and of any other mechanism without drives.
STOP_MEASURE = "from touch to the first zero of the mean rate (angular momentum over inertia, about the pivot)"
REST_MEASURE = "from touch until the whole mechanism came to rest and stayed at rest"
# Columns of the moment of a term of the medium's force: about the pivot, or without a pivot about the centre of mass.
MOMENT, CENTRAL_MOMENT = "moment_Nm", "moment_about_center_of_mass_Nm"
WELDS = ("weld", "fixed")
FINISHED: tuple[StatusCode, ...] = ("rest", "end_time")  # the run reached its regular end
# Called during a run with the simulated time so far and the end time (s).
Progress = Callable[[float, float], None]
Compiling = Callable[[str], None]  # called when a compilation begins, with a sentence that names what is compiled


@dataclass(frozen=True)
class Status:
    """How a run ended, with a sentence for the user; the sentence of a failure says what to change."""

    code: StatusCode
    message: str


@dataclass(frozen=True)
class Cost:
    """Computational cost of a solve; solve_s is wall time (s).

    full_newton: steps repeated with a new Jacobian in every iteration; shortened_steps: steps that were shortened
    because the iteration failed; refused_steps: steps repeated because their estimated error was too large (adaptive
    steps only).
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
    """One part of the mechanism as it is drawn: a disc, a bar or a filled area.

    points: (n, 2) m, world frame (x horizontal, y up). One point is the centre of a disc; an open line is the axis of a
    bar; a closed line (last point equal to the first) bounds an area. diameter: m, of the disc or across the bar.
    """

    part: str
    points: NDArray[np.float64]
    diameter: float


@dataclass(frozen=True)
class Force:
    """Force (2,) N of the medium on a body, and its point of action (2,) m; `body` is empty for the total force."""

    body: str
    point: NDArray[np.float64]
    force: NDArray[np.float64]


@dataclass(frozen=True)
class Snapshot:
    """The mechanism at one instant (s); `label` is `touch`, `deepest` or `end`, or `frame` for one of an animation."""

    label: str
    time: float
    outlines: tuple[Outline, ...]
    forces: tuple[Force, ...] = ()


@dataclass(frozen=True, repr=False)
class Results:
    """A finished run.

    table: (rows, len(columns)), one row per accepted step (or per `output.interval_s`), the first at t = 0.
    summary: content of summary.json (JSON types only, SI units in the keys).
    scenario: the scenario with every default resolved, as plain YAML types.
    surface: height of the free surface (m), or the corners (k, 2) m of a surface that is not level, whose first and
    last pieces extend without end; None in vacuum.
    layers: depths (m) below the surface at which other media begin; floor: height (m) of the floor, None without one.
    terms: names of the terms of the granular force, as in the columns (`drag_force_x_N`).
    frames: snapshots evenly spaced in time, for an animation; empty unless the run was asked for them.
    sizes: diameters and widths (m) of the immersed shapes.
    motion: motion for playback, of a run in space alone.
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
        """Column `name` as an array (rows,); the KeyError of an unknown name suggests similar names, or lists all."""
        for i, column in enumerate(self.columns):
            if column.name == name:
                return self.table[:, i]
        raise KeyError(unknown_name("column", name, self.names, self._welded()))

    def _welded(self) -> dict[str, str]:
        """Map each welded body to the first body of its chain of welds, under whose name both move."""
        model = self.scenario.get("model")
        joints = (model.get("joints") if isinstance(model, dict) else None) or {}
        parents = {joint["child"]: joint["parent"] for joint in joints.values() if joint["type"] in WELDS}
        roots = {}
        for body in parents:
            root = body
            while root in parents:
                root = parents[root]
            roots[body] = root
        return roots

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
        """Return the table as a pandas DataFrame, one row per row of `table`.

        Returns
        -------
        DataFrame
            Its `attrs` describe the columns.

        Raises
        ------
        MissingPackageError
            pandas is not installed.
        """
        from granular_contact.results.methods import dataframe

        return dataframe(self)

    def plot(self, *names: str) -> Figure:
        """Plot columns over time, one panel for each unit.

        Parameters
        ----------
        *names : str
            Names of columns, for example "tip_y_m".

        Returns
        -------
        Figure
            A notebook shows it; `savefig` saves it.

        Raises
        ------
        KeyError
            There is no such column.
        """
        from granular_contact.results.methods import plot

        return plot(self, names)

    def figures(self) -> dict[str, Figure]:
        """Draw all figures that `save` writes.

        Returns
        -------
        dict of Figure
            By name: `motion`, `forces`, `energy`, `mechanism` and others. Which exist depends on the run.

        Examples
        --------
        >>> simulate("pendulum").figures()["forces"].savefig("forces.pdf")  # doctest: +SKIP
        """
        from granular_contact.results.methods import figures

        return figures(self)

    def animation(self, file: str | PathLike[str] = "animation.gif") -> Film:
        """Write a film of the motion, to scale, with the forces of the medium.

        Parameters
        ----------
        file : str or path
            Ends in .gif, or in .mp4; for .mp4 the program ffmpeg has to be on the path.

        Returns
        -------
        Film
            Path of the file; a notebook plays it.

        Raises
        ------
        ResultsError
            The run was made without pictures (`most_frames=0`), or the file has another ending.
        OSError
            The file cannot be written, or ffmpeg is missing or fails.
        """
        from granular_contact.results.methods import animation

        return animation(self, Path(file))

    def save(self, directory: str | PathLike[str], *, figures: bool = True) -> Path:
        """Write a results folder, as the command `run` does; results of an earlier run in the folder are replaced.

        Parameters
        ----------
        directory : str or path
            Folder to write. It appears complete or not at all.
        figures : bool
            Whether to draw the figures, which takes a second or two.

        Returns
        -------
        Path
            The folder.

        Raises
        ------
        OSError
            The folder cannot be written, or it contains files that no run wrote.
        """
        from granular_contact.results.methods import save

        return save(self, Path(os.path.expanduser(directory)), figures)

    @classmethod
    def open(cls, directory: str | PathLike[str]) -> Results:
        """Read the results in a folder that a run or `save` wrote: table, summary, warnings and scenario.

        NaN in the summary is read back as None. `snapshots` and `sizes` are not saved, so they are empty.

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
            The folder contains no run, or a damaged one; the message names the file and the fault.
        """
        from granular_contact.results.methods import opened

        return opened(Path(directory))
