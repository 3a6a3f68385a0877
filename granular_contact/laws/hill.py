"""Vertical resistance of an immersed body (Hill, Yeung and Koehler 2005), distributed along a thin bar.

    F = eta (z/l)^lam g rho_g V    against the vertical motion of a volume V whose tip is at the depth z

The force per unit of arc length is (lam + 1) eta (z/l)^lam g rho_g A, with the section area A [ours]. Its integral over
a straight bar that pierces the surface is the published force, at any slope of the bar. l is the diameter unless it is
given. eta and lam have one value for plunging and another for withdrawing. The law has no horizontal force and no drag.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from granular_contact.laws.gravity import BULK, SHAPE
from granular_contact.laws.law import Law
from granular_contact.laws.lee_marghitu import VerticalResistance
from granular_contact.sand import kernels
from granular_contact.values.strict import Positive


class Hill(Law):
    """Vertical resistance eta (z/l)^lambda g rho V of an immersed volume, without any other term (Hill et al. 2005).

    Parameters
    ----------
    density : float or None
        Bulk density of the medium (kg/m3), above 0; null: the source does not state it, and a run needs it.
    plunging : VerticalResistance
        For a body that moves down.
    withdrawing : VerticalResistance
        For a body that moves up.
    length_scale : float, optional
        l (m); null: the diameter.
    """

    law: Literal["hill"]
    density: Annotated[Positive | None, BULK] = Field(alias="density_kg_m3")
    plunging: VerticalResistance
    withdrawing: VerticalResistance
    length_scale: Annotated[Positive | None, SHAPE] = Field(None, alias="length_scale_m")

    equation = "F_v = -eta (z/l)^lambda g rho V sgn(v_y)"
    terms = ("vertical_static",)
    takes = frozenset({"round"})
    by_component = True
    resultant = True
    constants = ("g_rho", "l", "eta_plunge", "lam_plunge", "eta_withdraw", "lam_withdraw")  # N/m^3, m (0: the diameter)

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the force; see `Law.numbers`."""
        assert self.density is not None  # `Law.record` refuses a medium without it
        return {
            "g_rho": gravity * self.density,
            "l": self.length_scale or 0.0,
            **self.plunging.numbers("plunge"),
            **self.withdrawing.numbers("withdraw"),
        }

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the vertical term in the plane. Arguments: see `laws.law`; `line.width` is the diameter (m)."""
        eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
        k, scale = factor(line.width, m)
        kernels.bar_statics.vertical_force(strip, k, eta, lam, scale, m, f[0])

    @staticmethod
    def bar_force(strip, cluster, m, f):
        """Add the vertical term in space. Arguments: see `laws.law`; `cluster.width` is the diameter (m)."""
        eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
        k, scale = factor(cluster.width, m)
        kernels.bars.vertical_force(strip, k, eta, lam, scale, m, f[0])


def factor(d, m):
    """Force factor and depth scale of a bar.

    Parameters
    ----------
    d : float
        Diameter of the bar (m).
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        g rho A (N/m) with the section area A, and the length l (m) by which depths are divided.
    """
    return m.g_rho * 0.25 * math.pi * d * d, m.l if m.l > 0.0 else d
