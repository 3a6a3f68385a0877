"""Pressure and sinkage with Reece's terms of size, and Janosi and Hanamoto's shear.

    p = (c k_c' + gamma b k_phi') (z / b)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

with gamma = rho g: k_c' and k_phi' are numbers, so that wide plates press harder at the same depth where n < 1, and
less so where n > 1 [textbook form].
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, SHAPE, WITH_WEIGHT, derived
from granular_contact.laws.surface_pressure import Exponent, SurfacePressure
from granular_contact.values.strict import NotNegative, Positive


class Reece(SurfacePressure):
    """Pressure (c k_c' + gamma b k_phi') (z / b)^n (Reece), shear as in `pressure_sinkage`.

    Parameters
    ----------
    density : float
        Of the bulk (kg/m3); gamma is its weight.
    k_phi_prime : float
        k_phi', the dimensionless modulus of friction, 0 or more; k_phi of `pressure_sinkage` is a pressure.
    exponent : float
        n, above 0, at most 5.
    k_c_prime : float
        k_c', the dimensionless modulus of cohesion, 0 or more: without effect where there is none.
    friction_angle, cohesion, shear_deformation_modulus, plate_width : float
        As of `SurfacePressure`.
    """

    law: Literal["reece"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    k_phi_prime: Annotated[NotNegative, WITH_WEIGHT]
    exponent: Annotated[Exponent, SHAPE]
    k_c_prime: Annotated[NotNegative, derived(0, "a number; the cohesion is beside it")] = 0.0

    equation = "p = (c k_c' + gamma b k_phi') (z/b)^n, tau = (c + p tan phi) (1 - exp(-j/K))"

    def pressure(self, gravity: float) -> dict[str, float]:
        """As `SurfacePressure.pressure`."""
        return {
            "k_0": self.cohesion * self.k_c_prime,
            "k_b": self.density * gravity * self.k_phi_prime,
            "n": self.exponent,
        }

    @property
    def of_width(self) -> bool:
        """As `SurfacePressure.of_width`."""
        return True
