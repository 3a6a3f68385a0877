"""Three-dimensional resistive force theory (Agarwal, Goldman and Kamrin 2023) in the plane.

The medium comes in by its density and two friction coefficients alone. Compiled equations: `kernels.rft3d`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class Rft3d:
    """density: rho_c (kg/m3); mu_int: internal friction; mu_surf: friction between medium and surface."""

    density: float
    mu_int: float
    mu_surf: float
    name: str = "rft3d"
    validity: Validity = NOT_STATED

    equation = "stress = xi_n [alpha_n + min(mu_surf |alpha_n| / |alpha_t|, 1) alpha_t] z"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    by_component = False

    def stiffness(self, gravity: float) -> float:
        """xi_n (N/m3), by which the generic response is scaled; gravity in m/s2."""
        mu = self.mu_int
        return self.density * abs(gravity) * (894.0 * mu**3 - 386.0 * mu**2 + 89.0 * mu)

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """As `Medium.record`."""
        from granular_contact.kernels import rft3d

        record = np.zeros(1, rft3d.RECORD)
        record["xi_n"], record["mu_surf"] = self.stiffness(gravity), self.mu_surf
        static.fill(record)
        return record
