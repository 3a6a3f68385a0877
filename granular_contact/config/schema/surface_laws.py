"""Schema of the resistive force theories, for plates, outlines and round bars."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from granular_contact.config.schema.provenance import MediumBase
from granular_contact.values.strict import NotNegative, Positive, Strict, refusal


class RftCoefficients(Strict):
    """Fourier coefficients of alpha_z (A, B) and alpha_x (C, D); B_11 and C_11 are those with the index -1,1."""

    A00: float
    A10: float
    B11: float
    B01: float
    B_11: float
    C11: float
    C01: float
    C_11: float
    D10: float

    @model_validator(mode="after")
    def _resist(self) -> RftCoefficients:
        """A medium can't push an element along: looked at every 5 degrees of it and 10 of its motion."""
        driven = ((self._power(b, g), b, g) for b in range(-90, 90, 5) for g in range(-180, 180, 10))
        power, beta, gamma = max(driven)
        if power > 1e-9 * max(map(abs, (self.A00, self.B01, self.C01))):
            where = f"an element at beta {beta} deg that moves at gamma {gamma} deg"
            raise refusal([((), f"pushes {where} with {power:.3g} N/cm3; allowed is what resists every motion")])
        return self

    def _power(self, beta: float, gamma: float) -> float:
        """Stress along the motion, per depth; see `kernels.rft`, which has both sides of the angles in one form."""
        b, g = math.radians(beta), math.radians(gamma)
        c2, s2, ux, uy = math.cos(2 * b), math.sin(2 * b), math.cos(g), -math.sin(g)
        sx = -(self.C01 + (self.C11 + self.C_11) * c2) * ux - (self.C11 - self.C_11) * s2 * uy - self.D10 * s2
        sy = self.A00 + self.A10 * c2 + (self.B11 - self.B_11) * s2 * ux - (self.B01 + (self.B11 + self.B_11) * c2) * uy
        return sx * ux + sy * uy


# The generic set of Li, Zhang and Goldman (2013), which a medium scales by its zeta.
GENERIC = RftCoefficients(
    A00=0.206, A10=0.169, B11=0.212, B01=0.358, B_11=0.055, C11=-0.124, C01=0.253, C_11=0.007, D10=0.088
)


class _Rft(MediumBase):
    zeta: Positive = 1.0
    """Factor of the coefficients."""
    alpha_N_cm3: RftCoefficients = GENERIC
    """Left out: the generic set, for which zeta is the medium's."""


class Rft(_Rft):
    """Resistive force theory in the plane: stress zeta alpha(beta, gamma) z."""

    law: Literal["rft"]


class Drft(_Rft):
    """The stress of rft, and the inertia -lambda rho v_n^2 n of the grains pushed away."""

    law: Literal["drft"]
    density_kg_m3: Positive
    lambda_: Annotated[float, Field(alias="lambda", ge=0)]
    """`lambda` in YAML."""
    surface_drop_m: NotNegative = 0.0
    """delta_h, by which the free surface is lowered."""


class Rft3d(MediumBase):
    """Three-dimensional resistive force theory, used in the plane: density and friction are all it needs."""

    law: Literal["rft3d"]
    density_kg_m3: Positive
    mu_int: Positive
    """Internal friction of the medium."""
    mu_surf: NotNegative
    """Friction between the medium and the surface."""
