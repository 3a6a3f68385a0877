"""Resistive force theory in the plane (Li, Zhang and Goldman 2013), for plates, outlines and round bars.

An element lies at the angle beta to the horizontal and moves at the angle gamma below the horizontal. Both angles are
folded to [-pi/2, pi/2], with beta > 0 where the leading face looks down. The stresses per depth, upward (z) and against
the motion (x), are

    alpha_z = A00 + A10 cos 2b + B11 sin(2b + g) + B01 sin g + B-11 sin(-2b + g)
    alpha_x = C11 cos(2b + g) + C01 cos g + C-11 cos(-2b + g) + D10 sin 2b

with b = beta and g = gamma. With the tangent t = (cos b, sin b) and the direction of motion u = (cos g, -sin g) no fold
is needed, also not for motion to the left: with c2 = t_x^2 - t_y^2 and s2 = 2 t_x t_y

    S_x = -[C01 + (C11 + C-11) c2] u_x - (C11 - C-11) s2 u_y - D10 s2
    S_y = A00 + A10 c2 + (B11 - B-11) s2 u_x - [B01 + (B11 + B-11) c2] u_y

S is even in t and affine in u. The record of the law holds the sums and differences of coefficients in N/m^3.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.gravity import derived, measured
from granular_contact.laws.law import Law
from granular_contact.values.strict import Faults, Positive

FRICTIONAL_STRESS = measured(
    1, "stresses of friction grow with the weight above; wheels computed grain by grain agree (Slonaker et al. 2017)"
)
FACTOR = derived(0, "a factor of alpha, which has the gravity")
CONSTANTS = ("A00", "A10", "B01", "B_sum", "B_difference", "C01", "C_sum", "C_difference", "D10")


class RftCoefficients(Coefficients):
    """Fourier coefficients of the stresses per depth: alpha_z (A, B) upward, alpha_x (C, D) against the motion.

    Parameters
    ----------
    A00, A10, B11, B01, B_11 : float
        Coefficients of alpha_z (N/cm3); B_11 has the index -1,1.
    C11, C01, C_11, D10 : float
        Coefficients of alpha_x (N/cm3); C_11 has the index -1,1.
    """

    A00: float
    A10: float
    B11: float
    B01: float
    B_11: float
    C11: float
    C01: float
    C_11: float
    D10: float

    def _faults(self) -> Faults:
        """Refuse a medium that would drive an element, checked at every 5 degrees of beta and 10 degrees of gamma."""
        power, beta, gamma = _greatest_driving_stress(*(getattr(self, name) for name in type(self).model_fields))
        if power > 1e-9 * max(map(abs, (self.A00, self.B01, self.C01))):
            where = f"an element at beta {beta} deg that moves at gamma {gamma} deg"
            yield (), f"pushes {where} with {power:.3g} N/cm3; allowed is what resists every motion"

    def numbers(self, zeta: float) -> dict[str, float]:
        """Coefficients times zeta, as the constants of the law.

        Parameters
        ----------
        zeta : float
            Factor.

        Returns
        -------
        dict
            Values of `CONSTANTS` (N/m3).
        """
        scale = 1e6 * zeta
        return {name: scale * getattr(self, name) for name in ("A00", "A10", "B01", "C01", "D10")} | {
            "B_sum": scale * (self.B11 + self.B_11),
            "B_difference": scale * (self.B11 - self.B_11),
            "C_sum": scale * (self.C11 + self.C_11),
            "C_difference": scale * (self.C11 - self.C_11),
        }


@lru_cache(64)  # a fit of other numbers evaluates the same coefficients thousands of times
def _greatest_driving_stress(
    A00: float, A10: float, B11: float, B01: float, B_11: float, C11: float, C01: float, C_11: float, D10: float
) -> tuple[float, int, int]:
    """Greatest stress along the motion, per depth (N/cm3), and the angles beta and gamma (deg) at which it occurs."""
    greatest = (-math.inf, 0, 0)
    for beta in range(-90, 90, 5):
        c2, s2 = math.cos(math.radians(2 * beta)), math.sin(math.radians(2 * beta))
        for gamma in range(-180, 180, 10):
            ux, uy = math.cos(math.radians(gamma)), -math.sin(math.radians(gamma))
            sx = -(C01 + (C11 + C_11) * c2) * ux - (C11 - C_11) * s2 * uy - D10 * s2
            sy = A00 + A10 * c2 + (B11 - B_11) * s2 * ux - (B01 + (B11 + B_11) * c2) * uy
            greatest = max(greatest, (sx * ux + sy * uy, beta, gamma))
    return greatest


# The generic set of Li, Zhang and Goldman (2013), which the zeta of a medium scales.
GENERIC = RftCoefficients(0.206, 0.169, 0.212, 0.358, 0.055, -0.124, 0.253, 0.007, 0.088)


class Rft(Law):
    """Resistive force theory in the plane: stress zeta alpha(beta, gamma) z (Li, Zhang and Goldman 2013).

    Parameters
    ----------
    coefficients : RftCoefficients
        Coefficients of the stress; by default the generic set, which the zeta of the medium scales.
    zeta : float
        Factor of the coefficients, above 0.
    """

    law: Literal["rft"]
    coefficients: Annotated[RftCoefficients, FRICTIONAL_STRESS] = Field(GENERIC, alias="alpha_N_cm3")
    zeta: Annotated[Positive, FACTOR] = 1.0

    equation = "stress = zeta alpha(beta, gamma) z"
    terms = ("static",)
    takes = frozenset({"round", "flat", "outline"})
    constants = CONSTANTS

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the stress; see `Law.numbers`."""
        return self.coefficients.numbers(self.zeta)

    @staticmethod
    def stress(t, u, m):
        """Stress per depth S (2,) N/m^3; arguments as in `laws.law`."""
        (tx, ty), (ux, uy) = t, u
        c2, s2 = tx * tx - ty * ty, 2.0 * tx * ty
        return (
            -(m.C01 + m.C_sum * c2) * ux - m.C_difference * s2 * uy - m.D10 * s2,
            m.A00 + m.A10 * c2 + m.B_difference * s2 * ux - (m.B01 + m.B_sum * c2) * uy,
        )
