"""Poncelet medium: a constant force and one quadratic in speed, F0 + c v^2, on a ball.

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
class Poncelet:
    """constant_force: F0 (N); drag: c (kg/m)."""

    constant_force: float
    drag: float
    name: str = "poncelet"
    validity: Validity = NOT_STATED

    equation = "F = F0 + c v^2"
    terms = ("constant", "drag")
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficients do not depend on gravity."""
        return scalar_record(static, self.terms, F0=self.constant_force, c=self.drag)
