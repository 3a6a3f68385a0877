"""Medium of Allen, Mayfield and Morrison: A v^2 + B v + C on a ball.

Compiled equations: `kernels.scalar`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.scalar import scalar_record
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class Allen:
    """drag: A (kg/m); viscosity: B (N s/m); constant_force: C (N)."""

    drag: float
    viscosity: float
    constant_force: float
    name: str = "allen"
    validity: Validity = NOT_STATED

    equation = "F = A v^2 + B v + C"
    terms = ("constant", "viscous", "drag")
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficients do not depend on gravity."""
        return scalar_record(static, self.terms, F0=self.constant_force, b=self.viscosity, c=self.drag)
