"""Medium of Katsuragi and Durian (2007): k z + m v^2 / d1 on a ball of mass m.

The mass is that of the ball itself; the run has it. Compiled equations: `kernels.scalar`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.scalar import scalar_record
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class KatsuragiDurian:
    """stiffness: k (N/m); of the drag length d1 either itself (m) or its ratio to the ball's diameter, the other 0."""

    stiffness: float
    drag_length: float = 0.0
    drag_length_per_diameter: float = 0.0
    name: str = "katsuragi_durian"
    validity: Validity = NOT_STATED

    equation = "F = k z + m v^2 / d1"
    terms = ("static", "inertial")
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficients do not depend on gravity."""
        return scalar_record(
            static,
            self.terms,
            k=self.stiffness,
            d1=self.drag_length,
            d1_per_diameter=self.drag_length_per_diameter,
        )
