"""What a granular load did, step by step, and the table that it is kept in while it grows."""

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
REACHED = LEFT  # first of the columns of how far it reaches; those before are the same in the plane and in space
SPACE = 6  # numbers of a wrench in space


@dataclass(frozen=True, kw_only=True)
class LoadHistory:
    """What a load did at each accepted step, the start included; all its arrays have a row a step.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W;
    floor_work (n,) J: of the floor's contact alone, which is not in the two before; depth (n,) m of the deepest point,
    negative above the surface, in space a bound while all is far above; of what is immersed speed (n,) m/s of the
    fastest and lowest (n,) m, the height of the lowest point (in space along `up`), infinite while nothing is; reached
    m, infinite likewise: the least and the greatest x (n, 2), in space the least x and y and then the greatest, frame
    of the bed, (n, 4), or (n, 0) unless the load watches it.

    terms (n, terms, size): for each of `term_names` its resultant force (N) and its moment about the world origin
    (N m); bodies (n, bodies, size): the same of all terms together, for each of `body_names`. In the plane the size is
    3, x, y and the moment, right-handed about z, so counter-clockwise (tables of runs have it clockwise); in space 6.

    immersed: body, kind and width (m) of all that ever was.
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

    def at_end(self) -> LoadHistory:
        """The last entry alone, if there is one."""
        return replace(self, **self._rows(slice(-1, None)))

    def since(self, start: float) -> LoadHistory:
        """The entries from a time (s) on, with works counted from there."""
        first = int(np.searchsorted(self.time, start))
        if first == 0:
            return self
        later = self._rows(slice(first, None))
        return replace(self, **later | {n: v - v[:1] for n, v in later.items() if n in ("work", "floor_work")})

    def _rows(self, rows: slice) -> dict[str, Any]:
        return {name: values[rows] for name, values in vars(self).items() if isinstance(values, np.ndarray)}


class HistoryTable:
    """Rows that grow: first columns as in `kernels.lines`, then the power of each medium, its terms, and bodies.

    In space there is nothing of strips among the first, and how far it reaches only if that is watched. blank: a row
    before anything is added to it; length: number of rows.
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
        """Terms of each medium, their names, names of bodies; floor: whether the last medium is the floor's contact.

        size: numbers of a wrench; reached: how far it reaches while nothing is immersed.
        """
        self.media, self._size, self._terms, self._floor = len(terms), size, tuple(terms), floor
        self._names = tuple(term_names), tuple(bodies)
        first = np.concatenate([np.zeros(REACHED), reached])
        first[[DEPTH, LOWEST]] = -np.inf, np.inf
        self._first = len(first)
        self._first_term = self._first + self.media
        self._first_body = self._first_term + size * TERMS * self.media
        self.blank = np.concatenate([first, np.zeros(self._first_body - self._first + size * len(bodies))])
        self._rows = np.zeros((256, len(self.blank)))
        self._summed = 0, 0.0  # a row, and the work up to it
        self.length = 0

    def columns(self, medium: int, body: str) -> NDArray[Any]:
        """Where kernels add the power of a medium, its terms and the wrench on a body."""
        place = self._first_body + self._size * self._names[1].index(body)
        term = self._first_term + self._size * TERMS * medium
        return np.array([self._first + medium, term, place], dtype=np.int64)

    def new_row(self, time: float) -> Vector:
        """A blank row at the end, for this time (s)."""
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
        """Names of the bodies that it has columns of."""
        return self._names[1]

    @property
    def row(self) -> Vector:
        """The last row."""
        row: Vector = self._rows[self.length - 1]
        return row

    def wrenches(self, row: Vector) -> Vector:
        """Forces and moments (bodies, size) of a row."""
        return row[self._first_body :].reshape(-1, self._size).copy()

    def kept(self) -> tuple[Vector, tuple[int, float]]:
        """A copy of all rows so far, and what is summed up of them."""
        return self._rows[: self.length].copy(), self._summed

    def restore(self, rows: Vector, summed: tuple[int, float]) -> None:
        """Take rows and sums that were kept for its own."""
        self.length = len(rows)
        if self.length > len(self._rows):
            self._rows = np.zeros((2 * self.length, len(self.blank)))
        self._rows[: self.length], self._summed = rows, summed

    def last(self) -> LoadHistory:
        """The last row alone, with the work up to it; none where there is none. Does not read the others again."""
        if self.length < 3:
            return self.history().at_end()
        first, before = self._summed
        rows = self._rows[first : self.length]
        work = before + accumulate(rows[:, TIME], self._power(rows))
        self._summed = self.length - 2, float(work[-2])  # the last row may be taken back
        return replace(self._read(self._rows[self.length - 1 : self.length]), work=work[-1:])

    def history(self) -> LoadHistory:
        """All rows so far; works are integrals of the power by the trapezoidal rule."""
        return self._read(self._rows[: self.length].copy())

    def _power(self, rows: Vector) -> Vector:
        """Power (n,) W of all media, without the floor's."""
        power: Vector = rows[:, self._first : self._first_term - self._floor].sum(axis=1)
        return power

    def _read(self, rows: Vector) -> LoadHistory:
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

    def adopt(self, rows: Vector) -> None:
        """Take on rows that were filled elsewhere."""
        self._rows, self.length = rows, len(rows)
