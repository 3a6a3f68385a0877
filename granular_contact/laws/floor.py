"""Floor of a bed: a level line that reports when it is reached, and may carry a stiff contact.

Compiled equations: `kernels.floor`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind

TERM = "floor"


@dataclass(frozen=True)
class Floor:
    """height: y (m); stiffness: N/m2, per length and penetration, None for no contact; damping: s/m, see the kernel."""

    height: float
    stiffness: float | None = None
    damping: float = 0.0

    @property
    def profile(self) -> NDArray[np.float64]:
        """The floor as a surface (1, 2) m."""
        return np.array([[0.0, self.height]])

    def record(self, kind: Kind) -> NDArray[np.void]:
        """Constants as the (1,) record that the kernels read on shapes of a kind."""
        from granular_contact.kernels import floor

        record = np.zeros(1, floor.BALL_RECORD if kind == "ball" else floor.STRIP_RECORD)
        record["floor_stiffness"], record["floor_damping"] = self.stiffness or 0.0, self.damping
        return record
