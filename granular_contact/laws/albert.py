"""Horizontal resistance of a vertical cylinder (Albert et al. 1999), distributed along a thin bar.

    F = eta_h g rho_g H^2 d        against the horizontal motion of a cylinder immersed to the depth H

The force per unit of arc length is 2 eta_h g rho_g d z |t_y| [ours]. Its integral over a straight bar that pierces the
surface is the published force, at any slope of the bar. The law has no vertical force and no drag.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, WEIGHT_FACTOR
from granular_contact.laws.law import Law
from granular_contact.sand import kernels
from granular_contact.values.strict import NotNegative, Positive


class Albert(Law):
    """Horizontal resistance eta_h g rho H^2 d of a vertical cylinder, without any other term (Albert et al. 1999).

    Parameters
    ----------
    density : float
        Bulk density of the medium (kg/m3), above 0.
    eta_h : float
        Coefficient of the horizontal resistance, 0 or more.
    """

    law: Literal["albert"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    eta_h: Annotated[NotNegative, WEIGHT_FACTOR]

    equation = "F_h = -eta_h g rho z^2 d sgn(v_x)"
    terms = ("horizontal_static",)
    takes = frozenset({"round"})
    by_component = True
    resultant = True
    constants = ("eta_h_g_rho",)  # N/m^3

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the force; see `Law.numbers`."""
        return {"eta_h_g_rho": self.eta_h * gravity * self.density}

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the horizontal term of a strip of a round bar in the plane.

        Parameters
        ----------
        strip : Strip
            The immersed part of the strip and its motion, see `sand.kernels.strip`.
        line : record
            Contact line of the strip, see `sand.kernels.law.LINE`; `line.width` is the diameter d (m).
        m : record
            The law's `constants`, and the constants of static friction.
        f : (terms, 2, 2) array
            Forces (N) of each term at both ends of the strip, x and y (up) in the world frame. The term is added.
        """
        kernels.bar_statics.horizontal_force(strip, m.eta_h_g_rho * line.width, m, f[0])

    @staticmethod
    def bar_force(strip, cluster, m, f):
        """Add the horizontal term of a strip of a round bar in space.

        Parameters
        ----------
        strip : Strip
            As in `strip_force`, with vectors of three components, z up.
        cluster : record
            Cluster of the bar, see `sand.kernels.space_law.CLUSTER`; `cluster.width` is the diameter d (m).
        m : record
            As in `strip_force`.
        f : (terms, 2, 3) array
            Forces (N) of each term at both ends of the strip, in the frame of the bed. The term is added.
        """
        kernels.bars.horizontal_force(strip, m.eta_h_g_rho * cluster.width, m, f[0])
