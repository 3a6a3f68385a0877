"""Pressure and sinkage with Bekker's term of size, and Janosi and Hanamoto's shear: what Bekker-Wong wheels roll on.

    p = (k_c / b + k_phi) (z / z_0)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

As in the textbooks (Bekker 1969, Wong) with z_0 = 1 m, where k_c is in N/m^(n+1) and k_phi in N/m^(n+2). Another z_0
gives the same law; with one in the middle of the data a fit of k_phi and n finds them nearly independent of each other.
Without k_c it is p = k z^n. The coefficients are those of a place, its gravity too [textbook form].
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import SHAPE, not_known
from granular_contact.laws.surface_pressure import Exponent, SurfacePressure
from granular_contact.values.strict import NotNegative, Positive

# Kobayashi et al. (2010): in flight a wheel sank as deep in two dry sands whatever the gravity, as k in proportion to g
# would give it; on the ground with less load it sank less. One study of wheels is no law for k, n and k_c each.
OF_PLACE = not_known("we know of no plates at other gravities; a wheel sank as deep at each (Kobayashi et al. 2010)")


class PressureSinkage(SurfacePressure):
    """Pressure (k_c / b + k_phi) z^n (Bekker), and shear with the limit of Mohr and Coulomb (Janosi and Hanamoto).

    Parameters
    ----------
    k_phi : float
        Pressure (Pa) at the reference depth on a plate without end, 0 or more.
    exponent : float
        n, above 0, at most 5.
    k_c : float
        Pressure at the reference depth that is added by a plate's edges, times b (N/m).
    reference_depth : float
        z_0 (m), above 0.
    friction_angle, cohesion, shear_deformation_modulus, plate_width : float
        As of `SurfacePressure`.
    """

    law: Literal["pressure_sinkage"]
    k_phi: Annotated[NotNegative, OF_PLACE] = Field(alias="k_phi_Pa")
    exponent: Annotated[Exponent, OF_PLACE]
    k_c: Annotated[NotNegative, OF_PLACE] = Field(0.0, alias="k_c_N_m")
    reference_depth: Annotated[Positive, SHAPE] = Field(1.0, alias="reference_depth_m")

    equation = "p = (k_c/b + k_phi) (z/z_0)^n, tau = (c + p tan phi) (1 - exp(-j/K))"

    def pressure(self, gravity: float) -> dict[str, float]:
        """As `SurfacePressure.pressure`."""
        return {"k_0": self.k_phi, "k_c": self.k_c, "scale": self.reference_depth, "n": self.exponent}

    @property
    def of_width(self) -> bool:
        """As `SurfacePressure.of_width`."""
        return self.k_c > 0.0
