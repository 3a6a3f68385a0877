"""A layer of a bed: a medium between two depths."""

from __future__ import annotations

import math
from dataclasses import dataclass

from granular_contact.laws.law import Law


@dataclass(frozen=True)
class Layer:
    """Medium between two depths below the free surface. By default it fills the bed.

    The law of the medium is evaluated at the depth below the free surface, not below the top of the layer.

    Parameters
    ----------
    medium : Law
        The medium of the layer.
    top, bottom : float
        Depths of its boundaries (m), 0 <= top < bottom.

    Raises
    ------
    ValueError
        The depths do not satisfy 0 <= top < bottom.
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
        """Whether the layer fills the whole bed."""
        return self.top == 0.0 and self.bottom == math.inf
