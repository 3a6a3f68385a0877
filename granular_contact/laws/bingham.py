"""Bingham medium: a yield force and a viscous one, F0 + b v, on a ball.

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
class Bingham:
    """yield_force: F0 (N); viscosity: b (N s/m)."""

    yield_force: float
    viscosity: float
    name: str = "bingham"
    validity: Validity = NOT_STATED

    equation = "F = F0 + b v"
    terms = ("yield", "viscous")
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficients do not depend on gravity."""
        return scalar_record(static, self.terms, F0=self.yield_force, b=self.viscosity)
