"""What a granular load did in space, step by step, and the table that it is kept in while it grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.history import integral
from granular_contact.kernels.law import TERMS
from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]
TIME, DEPTH, SPEED, LOWEST, FIRST = 0, 1, 2, 3, 4  # columns; the second to fourth as in `kernels.space_law`, one on


@dataclass(frozen=True)
class SpatialHistory:
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W; depth
    (n,) m of the deepest point (while all is far above the surface, a bound of it); of what is immersed speed (n,) m/s
    of the fastest and lowest (n,) m, the least height along `up`, infinite while nothing is; terms (n, terms, 6): of
    each of `term_names` the force (N) and the moment about the world origin (N m); bodies (n, bodies, 6): the same of
    all terms together, for each of `body_names`; immersed: body, kind and size (m) of all that ever was.
    """

    time: Vector
    work: Vector
    power: Vector
    depth: Vector
    speed: Vector
    lowest: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]
    immersed: frozenset[tuple[str, Kind, float]] = frozenset()

    def at_end(self) -> SpatialHistory:
        """The last entry alone, if there is one."""
        return replace(self, **self._rows(slice(-1, None)))

    def since(self, start: float) -> SpatialHistory:
        """The entries from a time (s) on, with the work counted from there."""
        first = int(np.searchsorted(self.time, start))
        later = self._rows(slice(first, None))
        later["work"] = later["work"] - later["work"][:1]
        return replace(self, **later)

    def _rows(self, rows: slice) -> dict[str, Any]:
        return {name: values[rows] for name, values in vars(self).items() if isinstance(values, np.ndarray)}


class SpatialTable:
    """Rows with the columns above, then the power of each medium, its terms, and bodies; length: number of rows."""

    def __init__(self, terms: Sequence[int], term_names: Sequence[str], bodies: Sequence[str]) -> None:
        """Terms of each medium, their names, names of bodies."""
        self.media, self._terms = len(terms), tuple(terms)
        self._names = tuple(term_names), tuple(bodies)
        self._first_term = FIRST + self.media
        self._first_body = self._first_term + 6 * TERMS * self.media
        self.blank = np.zeros(self._first_body + 6 * len(bodies))
        self.blank[[DEPTH, LOWEST]] = -np.inf, np.inf
        self._rows = np.zeros((256, len(self.blank)))
        self.length = 0

    def columns(self, medium: int, body: str) -> NDArray[np.int64]:
        """Where `kernels.space_bodies.accept` adds the power of a medium, its terms and the wrench on a body."""
        place = self._first_body + 6 * self._names[1].index(body)
        return np.array([FIRST + medium, self._first_term + 6 * TERMS * medium, place], dtype=np.int64)

    def new_row(self, time: float) -> Vector:
        """A blank row at the end, for this time (s)."""
        if self.length == len(self._rows):
            self._rows = np.vstack([self._rows, np.zeros_like(self._rows)])
        row: Vector = self._rows[self.length]
        row[:] = self.blank
        row[TIME] = time
        self.length += 1
        return row

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies that it has columns of."""
        return self._names[1]

    @property
    def row(self) -> Vector:
        """The last row."""
        row: Vector = self._rows[self.length - 1]
        return row

    def wrenches(self, row: Vector) -> Vector:
        """Forces and moments (bodies, 6) of a row, as of `SpatialHistory.bodies`."""
        return row[self._first_body :].reshape(-1, 6).copy()

    def kept(self) -> tuple[Vector, tuple[int, float]]:
        """A copy of all rows so far; nothing is summed up of them."""
        return self._rows[: self.length].copy(), (0, 0.0)

    def restore(self, rows: Vector, summed: tuple[int, float]) -> None:  # noqa: ARG002  # as of a table of the plane
        """Take rows that were kept for its own."""
        self.length = len(rows)
        if self.length > len(self._rows):
            self._rows = np.zeros((2 * self.length, len(self.blank)))
        self._rows[: self.length] = rows

    def last(self) -> SpatialHistory:
        """The last row alone, with the work up to it."""
        return self.history().at_end()

    def history(self) -> SpatialHistory:
        """All rows so far; the work is the integral of the power by the trapezoidal rule."""
        rows = self._rows[: self.length].copy()
        power = rows[:, FIRST : self._first_term].sum(axis=1)
        used = [TERMS * i + k for i, number in enumerate(self._terms) for k in range(number)]
        return SpatialHistory(
            time=rows[:, TIME],
            work=integral(power, rows[:, TIME]),
            power=power,
            depth=rows[:, DEPTH],
            speed=rows[:, SPEED],
            lowest=rows[:, LOWEST],
            terms=rows[:, self._first_term : self._first_body].reshape(len(rows), TERMS * self.media, 6)[:, used],
            bodies=rows[:, self._first_body :].reshape(len(rows), len(self._names[1]), 6),
            term_names=self._names[0],
            body_names=self._names[1],
        )
