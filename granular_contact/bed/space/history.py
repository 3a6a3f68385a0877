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

    time (n,) s; work (n,) J done by all media on the bodies so far, negative when they lose energy; power (n,) W; depth
    (n,) m of the deepest point (while all is far above the surface, a bound of it); of what is immersed speed (n,) m/s
    of the fastest and lowest (n,) m, the least height along `up`, infinite while nothing is; terms (n, terms, 6): of
    each of `term_names` the force (N) and the moment about the world origin (N m); bodies (n, bodies, 6): the same of
    all terms together, for each of `body_names`; immersed: body, kind and size (m) of all that ever was.
    """

    power: Vector
    depth: Vector
    speed: Vector
    lowest: Vector
    terms: Vector
    bodies: Vector
    term_names: tuple[str, ...]
    body_names: tuple[str, ...]
    immersed: frozenset[tuple[str, Kind, float]] = frozenset()


class SpatialTable(Table[SpatialHistory]):
    """Rows with the columns above, then the power of each medium, its terms, and bodies."""

    def __init__(self, terms: Sequence[int], term_names: Sequence[str], bodies: Sequence[str]) -> None:
        """Terms of each medium, their names, names of bodies."""
        first = np.zeros(FIRST)
        first[[DEPTH, LOWEST]] = -np.inf, np.inf
        super().__init__(first, 6, terms, term_names, bodies)

    def _read(self, rows: Vector) -> SpatialHistory:
        return SpatialHistory(**self._common(rows), depth=rows[:, DEPTH], speed=rows[:, SPEED], lowest=rows[:, LOWEST])
