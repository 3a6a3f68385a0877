"""Medium of Tsimring and Volfson (2005): drag quadratic in speed and friction that grows with depth, on a ball.

    F = k z^p + c v^2

Only the form is known to us, and not the power of the depth: p is the user's. Compiled equations: `kernels.scalar`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.scalar import scalar_record
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class TsimringVolfson:
    """drag: c (kg/m); friction: k (N/m^p); exponent: p, above 0."""

    drag: float
    friction: float
    exponent: float
    name: str = "tsimring_volfson"
    validity: Validity = NOT_STATED

    equation = "F = k z^p + c v^2"
    terms = ("friction", "drag")
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficients do not depend on gravity."""
        return scalar_record(static, self.terms, k=self.friction, p=self.exponent, c=self.drag)
