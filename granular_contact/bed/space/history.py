"""What a granular load did in space, step by step, and the table that it is kept in while it grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.history import Entries, Table
from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]
DEPTH, SPEED, LOWEST, FIRST = 1, 2, 3, 4  # columns; the second to fourth as in `kernels.space_law`, one on


@dataclass(frozen=True)
class SpatialHistory(Entries):
    """One entry per accepted step, the start included.

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W;
    floor_work (n,) J: of the floor's contact alone, which is not in the two before; depth (n,) m of the deepest point
    (while all is far above the surface, a bound of it); of what is immersed speed (n,) m/s of the fastest and lowest
    (n,) m, the least height along `up`, infinite while nothing is; terms (n, terms, 6): of each of `term_names` the
    force (N) and the moment about the world origin (N m); bodies (n, bodies, 6): the same of all terms together, for
    each of `body_names`; immersed: body, kind and size (m) of all that ever was; reached (n, 4) m: of what is immersed
    the least x and y and the greatest, frame of the bed, infinite while nothing is; (n, 0) unless the load watches it.
    """

    power: Vector
    floor_work: Vector
    depth: Vector
    speed: Vector
    lowest: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]
    reached: Vector
    immersed: frozenset[tuple[str, Kind, float]] = frozenset()


class SpatialTable(Table[SpatialHistory]):
    """Rows with the columns above, then the power of each medium, its terms, and bodies."""

    def __init__(
        self,
        terms: Sequence[int],
        term_names: Sequence[str],
        bodies: Sequence[str],
        floor: bool = False,
        watch: bool = False,
    ) -> None:
        """Terms of each medium, their names, names of bodies; floor: whether the last medium is the floor's contact.

        watch: whether a row has how far what is immersed reaches.
        """
        first = np.zeros(FIRST + 4 * watch)
        first[[DEPTH, LOWEST]] = -np.inf, np.inf
        first[FIRST:] = (np.inf, np.inf, -np.inf, -np.inf)[: len(first) - FIRST]
        super().__init__(first, 6, terms, term_names, bodies, floor)

    def _read(self, rows: Vector) -> SpatialHistory:
        return SpatialHistory(
            **self._common(rows),
            depth=rows[:, DEPTH],
            speed=rows[:, SPEED],
            lowest=rows[:, LOWEST],
            reached=rows[:, FIRST : self._first],
        )
