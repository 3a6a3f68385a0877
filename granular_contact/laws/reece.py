"""Pressure-sinkage law with Reece's size terms, and the shear of Janosi and Hanamoto.

    p = (c k_c' + gamma b k_phi') (z / b)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

with gamma = rho g. k_c' and k_phi' are dimensionless. At the same depth a wider plate therefore has a higher pressure
where n < 1, and a lower one where n > 1 [textbook form].
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, SHAPE, WEIGHT_FACTOR, derived
from granular_contact.laws.surface_pressure import Exponent, SurfacePressure
from granular_contact.values.strict import NotNegative, Positive


class Reece(SurfacePressure):
    """Pressure (c k_c' + gamma b k_phi') (z / b)^n (Reece), shear as in `pressure_sinkage`.

    Parameters
    ----------
    density : float
        Bulk density (kg/m3), of which gamma is the weight.
    k_phi_prime : float
        k_phi', the dimensionless modulus of friction, 0 or more; k_phi of `pressure_sinkage` is a pressure.
    exponent : float
        n, above 0, at most 5.
    k_c_prime : float
        k_c', the dimensionless modulus of cohesion, 0 or more; without cohesion it has no effect.
    friction_angle, cohesion, shear_deformation_modulus, plate_width : float
        See `SurfacePressure`.
    """

    law: Literal["reece"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    k_phi_prime: Annotated[NotNegative, WEIGHT_FACTOR]
    exponent: Annotated[Exponent, SHAPE]
    k_c_prime: Annotated[NotNegative, derived(0, "a number; the cohesion is beside it")] = 0.0

    equation = "p = (c k_c' + gamma b k_phi') (z/b)^n, tau = (c + p tan phi) (1 - exp(-j/K))"

    def pressure(self, gravity: float) -> dict[str, float]:
        """Constants of the pressure; see `SurfacePressure.pressure`."""
        return {
            "k_0": self.cohesion * self.k_c_prime,
            "k_b": self.density * gravity * self.k_phi_prime,
            "n": self.exponent,
        }

    @property
    def depends_on_width(self) -> bool:
        """Whether the pressure depends on b: always."""
        return True
