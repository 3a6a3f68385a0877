"""Linear static medium: a force k z on a ball.

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
class LinearDepth:
    """stiffness: k (N/m)."""

    stiffness: float
    name: str = "linear_depth"
    validity: Validity = NOT_STATED

    equation = "F = k z"
    terms = ("static",)
    takes = frozenset({"ball"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:  # noqa: ARG002
        """As `Medium.record`; the coefficient does not depend on gravity."""
        return scalar_record(static, self.terms, k=self.stiffness)
