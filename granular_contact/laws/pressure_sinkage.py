"""Pressure-sinkage law with Bekker's size term, and the shear of Janosi and Hanamoto, as for Bekker-Wong wheels.

    p = (k_c / b + k_phi) (z / z_0)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

The textbooks (Bekker 1969, Wong) have z_0 = 1 m, with k_c in N/m^(n+1) and k_phi in N/m^(n+2). Another z_0 describes
the same law. With a z_0 in the middle of the measured depths, a fit finds k_phi and n nearly independent of each other.
Without k_c the law is p = k z^n. The coefficients belong to a place, including its gravity [textbook form].
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import SHAPE, not_known
from granular_contact.laws.surface_pressure import Exponent, SurfacePressure
from granular_contact.values.strict import NotNegative, Positive

# Kobayashi et al. (2010): in flight the sinkage of a wheel in two dry sands did not depend on gravity, as with k
# proportional to g; on the ground with less load it sank less. One study of wheels gives no law for each of k, n, k_c.
PLATE_TESTS = not_known("we know of no plates at other gravities; a wheel sank as deep at each (Kobayashi et al. 2010)")


class PressureSinkage(SurfacePressure):
    """Pressure (k_c / b + k_phi) z^n (Bekker), and shear with the limit of Mohr and Coulomb (Janosi and Hanamoto).

    Parameters
    ----------
    k_phi : float
        Pressure (Pa) at the reference depth under a plate of infinite width, 0 or more.
    exponent : float
        n, above 0, at most 5.
    k_c : float
        Additional pressure at the reference depth by the edges of a plate, times b (N/m).
    reference_depth : float
        z_0 (m), above 0.
    friction_angle, cohesion, shear_deformation_modulus, plate_width : float
        See `SurfacePressure`.
    """

    law: Literal["pressure_sinkage"]
    k_phi: Annotated[NotNegative, PLATE_TESTS] = Field(alias="k_phi_Pa")
    exponent: Annotated[Exponent, PLATE_TESTS]
    k_c: Annotated[NotNegative, PLATE_TESTS] = Field(0.0, alias="k_c_N_m")
    reference_depth: Annotated[Positive, SHAPE] = Field(1.0, alias="reference_depth_m")

    equation = "p = (k_c/b + k_phi) (z/z_0)^n, tau = (c + p tan phi) (1 - exp(-j/K))"

    def pressure(self, gravity: float) -> dict[str, float]:
        """Constants of the pressure; see `SurfacePressure.pressure`."""
        return {"k_0": self.k_phi, "k_c": self.k_c, "scale": self.reference_depth, "n": self.exponent}

    @property
    def depends_on_width(self) -> bool:
        """Whether the pressure depends on b: if k_c is not 0."""
        return self.k_c > 0.0
