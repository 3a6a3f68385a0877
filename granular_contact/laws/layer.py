"""A medium between two depths."""

from __future__ import annotations

import math
from dataclasses import dataclass

from granular_contact.laws.kinds import Medium


@dataclass(frozen=True)
class Layer:
    """medium between the depths top and bottom (m) below the free surface; the whole bed unless given.

    Depths in its law stay those below the free surface.
    """

    medium: Medium
    top: float = 0.0
    bottom: float = math.inf

    @property
    def whole(self) -> bool:
        """Whether it fills the bed."""
        return self.top == 0.0 and self.bottom == math.inf
