"""History of a granular load, a row for each accepted step, and the table in which it grows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.results.energy import accumulate
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.lines import DEPTH, LEFT, LOWEST, SPEED, TIME

Vector = NDArray[np.float64]
REACHED = LEFT  # first column of the range; the columns before it are the same in the plane and in space
SPACE = 6  # size of a wrench in space


@dataclass(frozen=True, kw_only=True)
class LoadHistory:
    """History of a load. All arrays have a row for each accepted step, and one for the start.

    In the plane a wrench has the size 3: force x, y (N) and moment (N m), right-handed about z, so counter-clockwise
    (tables of runs have it clockwise). In space it has the size 6: force and moment. Moments are about the world
    origin.

    Parameters
    ----------
    time : (n,) array
        Time (s).
    work : (n,) array
        Work (J) of all media on the bodies since the start, negative when the bodies lose energy.
    power : (n,) array
        Power (W) of all media.
    floor_work : (n,) array
        Work (J) of the contact of the floor, which `work` and `power` do not contain.
    depth : (n,) array
        Depth (m) of the deepest point, negative above the surface; in space a bound while everything is far above.
    speed : (n,) array
        Greatest speed (m/s) of what is immersed.
    lowest : (n,) array
        Height (m) of the lowest immersed point (in space along `up`), infinite while nothing is immersed.
    reached : (n, 2), (n, 4) or (n, 0) array
        Range (m) of what is immersed, infinite while nothing is: least and greatest x; in space least x and y and then
        greatest x and y, in the frame of the bed, or no columns unless the load watches it.
    terms : (n, terms, size) array
        Resultant wrench of each term, see `term_names`.
    bodies : (n, bodies, size) array
        Wrench of all terms on each body, see `body_names`.
    term_names, body_names : tuple of str
        Names of terms and bodies.
    immersed : frozenset
        Name of the body, kind and width (m) of all that has ever been immersed.
    """

    time: Vector
    work: Vector
    power: Vector
    floor_work: Vector
    depth: Vector
    speed: Vector
    lowest: Vector
    reached: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]
    immersed: frozenset[tuple[str, Kind, float]] = frozenset()

    def last_entry(self) -> LoadHistory:
        """History of the last row alone, if there is one."""
        return replace(self, **self._rows(slice(-1, None)))

    def since(self, start: float) -> LoadHistory:
        """History of the rows from a time on, with works counted from there.

        Parameters
        ----------
        start : float
            Time (s).
        """
        first = int(np.searchsorted(self.time, start))
        if first == 0:
            return self
        later = self._rows(slice(first, None))
        return replace(self, **later | {n: v - v[:1] for n, v in later.items() if n in ("work", "floor_work")})

    def _rows(self, rows: slice) -> dict[str, Any]:
        """Arrays with some of the rows, by the names of the fields."""
        return {name: values[rows] for name, values in vars(self).items() if isinstance(values, np.ndarray)}


class HistoryTable:
    """Table of a history that grows by rows.

    Its first columns are those of `kernels.lines`; then come the power of each medium, the wrenches of its terms, and
    the wrenches on bodies. In space the first columns have no range of strips, and the range of what is immersed only
    if it is watched.

    Parameters
    ----------
    terms : sequence of int
        Number of terms of each medium.
    term_names : sequence of str
        Names of all terms.
    bodies : sequence of str
        Names of the bodies.
    floor : bool
        Whether the last medium is the contact of the floor.
    size : int
        Size of a wrench: 3 in the plane, 6 in space.
    reached : sequence of float
        Range (m) while nothing is immersed.

    Attributes
    ----------
    blank : (columns,) array
        A row before anything is added to it.
    length : int
        Number of rows.
    """

    def __init__(
        self,
        terms: Sequence[int] = (),
        term_names: Sequence[str] = (),
        bodies: Sequence[str] = (),
        floor: bool = False,
        size: int = 3,
        reached: Sequence[float] = (math.inf, -math.inf),
    ) -> None:
        """Make an empty table; parameters as in the class."""
        self.media, self._size, self._terms, self._floor = len(terms), size, tuple(terms), floor
        self._names = tuple(term_names), tuple(bodies)
        first = np.concatenate([np.zeros(REACHED), reached])
        first[[DEPTH, LOWEST]] = -np.inf, np.inf
        self._first = len(first)
        self._first_term = self._first + self.media
        self._first_body = self._first_term + size * TERMS * self.media
        self.blank = np.concatenate([first, np.zeros(self._first_body - self._first + size * len(bodies))])
        self._rows = np.zeros((256, len(self.blank)))
        self._summed = 0, 0.0  # number of a row, and the work up to it
        self.length = 0

    def columns(self, medium: int, body: str) -> NDArray[Any]:
        """Columns of a medium and a body, for the kernels.

        Parameters
        ----------
        medium : int
            Number of the medium.
        body : str
            Name of the body.

        Returns
        -------
        (3,) array of int
            First columns of the power of the medium, of the wrenches of its terms, and of the wrench on the body.
        """
        place = self._first_body + self._size * self._names[1].index(body)
        term = self._first_term + self._size * TERMS * medium
        return np.array([self._first + medium, term, place], dtype=np.int64)

    def new_row(self, time: float) -> Vector:
        """Append a blank row.

        Parameters
        ----------
        time : float
            Time (s).

        Returns
        -------
        (columns,) array
            View of the row, which the kernels fill.
        """
        if self.length == len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        if self.length == 0:
            self._summed = 0, 0.0
        row: Vector = self._rows[self.length]
        row[:] = self.blank
        row[TIME] = time
        self.length += 1
        return row

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies that have columns."""
        return self._names[1]

    @property
    def row(self) -> Vector:
        """View of the last row."""
        row: Vector = self._rows[self.length - 1]
        return row

    def wrenches(self, row: Vector) -> Vector:
        """Wrenches on the bodies in a row.

        Parameters
        ----------
        row : (columns,) array
            A row.

        Returns
        -------
        (bodies, size) array
        """
        return row[self._first_body :].reshape(-1, self._size).copy()

    def snapshot(self) -> tuple[Vector, tuple[int, float]]:
        """Copy of all rows, and the state of the running sum of work."""
        return self._rows[: self.length].copy(), self._summed

    def restore(self, rows: Vector, summed: tuple[int, float]) -> None:
        """Restore rows and sum as returned by `snapshot`.

        Parameters
        ----------
        rows : (n, columns) array
            Rows.
        summed : tuple
            Number of the row up to which work is summed, and that work (J).
        """
        self.length = len(rows)
        if self.length > len(self._rows):
            self._rows = np.zeros((2 * self.length, len(self.blank)))
        self._rows[: self.length], self._summed = rows, summed

    def last(self) -> LoadHistory:
        """History of the last row alone, with the work up to it; without a row, an empty one.

        Earlier rows are not read again.
        """
        if self.length < 3:
            return self.history().last_entry()
        row, summed = self._summed
        rows = self._rows[row : self.length]
        work = summed + accumulate(rows[:, TIME], self._power(rows))
        self._summed = self.length - 2, float(work[-2])  # the last row may be taken back
        return replace(self._read(self._rows[self.length - 1 : self.length]), work=work[-1:])

    def history(self) -> LoadHistory:
        """History of all rows. Works are integrals of the power by the trapezoidal rule."""
        return self._read(self._rows[: self.length].copy())

    def _power(self, rows: Vector) -> Vector:
        """Power (n,) W of all media, without the floor's."""
        power: Vector = rows[:, self._first : self._first_term - self._floor].sum(axis=1)
        return power

    def _read(self, rows: Vector) -> LoadHistory:
        """History of rows (n, columns)."""
        time, power = rows[:, TIME], self._power(rows)
        floor = rows[:, self._first_term - self._floor : self._first_term].sum(axis=1)
        used = [TERMS * i + k for i, number in enumerate(self._terms) for k in range(number)]
        terms = rows[:, self._first_term : self._first_body].reshape(len(rows), TERMS * self.media, self._size)
        return LoadHistory(
            time=time,
            work=accumulate(time, power),
            power=power,
            floor_work=accumulate(time, floor),
            depth=rows[:, DEPTH],
            speed=rows[:, SPEED],
            lowest=rows[:, LOWEST],
            reached=rows[:, REACHED : self._first],
            terms=terms[:, used],
            bodies=rows[:, self._first_body :].reshape(len(rows), len(self._names[1]), self._size),
            term_names=self._names[0],
            body_names=self._names[1],
        )

    def replace_rows(self, rows: Vector) -> None:
        """Use rows that were filled elsewhere as those of the table.

        Parameters
        ----------
        rows : (n, columns) array
            The rows, not copied.
        """
        self._rows, self.length = rows, len(rows)
