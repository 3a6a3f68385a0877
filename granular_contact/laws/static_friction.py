"""Regularisations of the sign in the static resistance; their equations are in `kernels.friction`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Elastoplastic:
    """Bristle that yields at `yield_displacement` (m), damped with `damping_time` (s). Holds still at rest."""

    yield_displacement: float = 1e-5
    damping_time: float = 1e-3

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into a medium record (1,)."""
        from granular_contact.kernels.friction import ELASTOPLASTIC

        record["friction"] = ELASTOPLASTIC
        record["u_y"], record["tau"] = self.yield_displacement, self.damping_time


@dataclass(frozen=True)
class Smooth:
    """tanh(v / reference_speed), m/s. Creeps under any load; for comparison."""

    reference_speed: float = 1e-3

    def fill(self, record: NDArray[np.void]) -> None:
        """Write the constants into a medium record (1,)."""
        from granular_contact.kernels.friction import SMOOTH

        record["friction"] = SMOOTH
        record["v_eps"] = self.reference_speed
