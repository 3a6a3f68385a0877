"""Resistive force theory in the plane (Li, Zhang and Goldman 2013), for plates, outlines and round bars.

Compiled equations: `kernels.rft`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity

# The coefficients were measured on Earth. Stresses that come from friction grow in proportion to gravity [ours].
MEASURED_AT = 9.81


@dataclass(frozen=True)
class Coefficients:
    """Fourier coefficients of alpha_z (A, B) and alpha_x (C, D) in N/cm3; B_11, C_11 are B-1,1 and C-1,1."""

    A00: float
    A10: float
    B11: float
    B01: float
    B_11: float
    C11: float
    C01: float
    C_11: float
    D10: float

    def fill(self, record: NDArray[np.void], zeta: float, gravity: float) -> None:
        """Write zeta times the coefficients (N/m3) into a medium record (1,)."""
        scale = 1e6 * zeta * abs(gravity) / MEASURED_AT
        for name in ("A00", "A10", "B01", "C01", "D10"):
            record[name] = scale * getattr(self, name)
        record["B_sum"], record["B_difference"] = scale * (self.B11 + self.B_11), scale * (self.B11 - self.B_11)
        record["C_sum"], record["C_difference"] = scale * (self.C11 + self.C_11), scale * (self.C11 - self.C_11)


@dataclass(frozen=True)
class Rft:
    """coefficients: of the medium, or the generic set with the medium's zeta."""

    coefficients: Coefficients
    zeta: float = 1.0
    name: str = "rft"
    validity: Validity = NOT_STATED

    equation = "stress = zeta alpha(beta, gamma) z"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """As `Medium.record`."""
        from granular_contact.kernels import rft

        record = np.zeros(1, rft.RECORD)
        self.coefficients.fill(record, self.zeta, gravity)
        static.fill(record)
        return record
