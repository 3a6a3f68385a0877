"""Horizontal resistance of a vertical cylinder (Albert et al. 1999), spread along a thin bar.

    F = eta_h g rho_g H^2 d        against the horizontal motion of a cylinder immersed to the depth H

The density 2 eta_h g rho_g d z |t_y| per unit of arc length [ours] integrates to it over a straight bar at any slope
that pierces the surface. There is no vertical force and no drag.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, WITH_WEIGHT
from granular_contact.laws.law import Law
from granular_contact.sand import kernels
from granular_contact.values.strict import NotNegative, Positive


class Albert(Law):
    """Horizontal resistance eta_h g rho H^2 d of a vertical cylinder, and nothing else (Albert et al. 1999).

    Parameters
    ----------
    density : float
        Of the medium (kg/m3), above 0.
    eta_h : float
        Coefficient, 0 or more.
    """

    law: Literal["albert"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    eta_h: Annotated[NotNegative, WITH_WEIGHT]

    equation = "F_h = -eta_h g rho z^2 d sgn(v_x)"
    terms = ("horizontal_static",)
    takes = frozenset({"round"})
    by_component = True
    resultant = True
    constants = ("eta_h_g_rho",)  # N/m^3

    def numbers(self, gravity: float) -> dict[str, float]:
        """As `Law.numbers`."""
        return {"eta_h_g_rho": self.eta_h * gravity * self.density}

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the horizontal term; arguments as in `sand.kernels.law.strip_force`."""
        kernels.bar_statics.horizontal_force(strip, m.eta_h_g_rho * line.width, m, f[0])

    @staticmethod
    def bar_force(strip, cluster, m, f):
        """Add the horizontal term in space; arguments as in `sand.kernels.space_law.bar_force`."""
        kernels.bars.horizontal_force(strip, m.eta_h_g_rho * cluster.width, m, f[0])
