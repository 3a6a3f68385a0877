"""A medium between two depths."""

from __future__ import annotations

import math
from dataclasses import dataclass

from granular_contact.laws.law import Law


@dataclass(frozen=True)
class Layer:
    """Medium between two depths below the free surface; the whole bed unless they are given.

    Depths in its law stay those below the free surface.

    Parameters
    ----------
    medium : Law
        What lies there.
    top, bottom : float
        Depths (m), 0 <= top < bottom.

    Raises
    ------
    ValueError
        The depths are not 0 <= top < bottom.
    """

    medium: Law
    top: float = 0.0
    bottom: float = math.inf

    def __post_init__(self) -> None:
        if not 0.0 <= self.top < self.bottom:
            got = f"got top {self.top} and bottom {self.bottom}"
            raise ValueError(f"Layer: {got}, allowed is 0 <= top < bottom (m)")

    @property
    def whole(self) -> bool:
        """Whether it fills the bed."""
        return self.top == 0.0 and self.bottom == math.inf
