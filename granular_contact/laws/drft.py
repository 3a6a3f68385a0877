"""Dynamic resistive force theory (Agarwal et al. 2021): `rft` and the inertia of the grains, -lam rho v_n^2 n.

Compiled equations: `kernels.drft`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.rft import Coefficients
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class Drft:
    """As `Rft`; density: rho (kg/m3); lam: inertial factor; surface_drop: delta_h (m), what lowers the surface."""

    coefficients: Coefficients
    density: float
    lam: float
    zeta: float = 1.0
    surface_drop: float = 0.0
    name: str = "drft"
    validity: Validity = NOT_STATED

    equation = "stress = zeta alpha(beta, gamma) z - lambda rho v_n |v_n| n"
    terms = ("static", "inertial")
    takes = frozenset({"round", "flat", "outline"})
    by_component = False

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """As `Medium.record`."""
        from granular_contact.kernels import drft

        record = np.zeros(1, drft.RECORD)
        self.coefficients.fill(record, self.zeta, gravity)
        record["lam_rho"], record["delta_h"] = self.lam * self.density, self.surface_drop
        static.fill(record)
        return record
