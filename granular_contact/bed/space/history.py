"""What a granular load did in space, step by step, and the table that it is kept in while it grows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.history import Entries, Table

Vector = NDArray[np.float64]
DEPTH, SPEED, LOWEST, FIRST = 1, 2, 3, 4  # columns; the second to fourth as in `kernels.space_law`, one on


@dataclass(frozen=True, kw_only=True)
class SpatialHistory(Entries):
    """As `Entries`, in space, of 6 numbers; heights are along `up`, and depth is a bound while all is far above.

    reached (n, 4) m: of what is immersed the least x and y and the greatest, frame of the bed, infinite while nothing
    is; (n, 0) unless the load watches it.
    """

    reached: Vector


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
