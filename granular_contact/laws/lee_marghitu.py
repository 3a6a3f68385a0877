"""Lee-Marghitu medium: velocity-squared drag and depth-dependent static resistance of an immersed cylinder.

Compiled equations: `kernels.lee_marghitu`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity

TERMS = ("drag", "horizontal_static", "vertical_static")


@dataclass(frozen=True)
class VerticalResistance:
    """Coefficient eta_v and depth exponent lam of the vertical static resistance in one direction of motion."""

    eta_v: float
    lam: float


@dataclass(frozen=True)
class LeeMarghitu:
    """Coefficients of the law, all >= 0.

    density: rho_g of the medium (kg/m3); eta_d: drag; eta_h: horizontal static; plunging, withdrawing: vertical static.
    """

    density: float
    eta_d: float
    eta_h: float
    plunging: VerticalResistance
    withdrawing: VerticalResistance
    name: str = "lee_marghitu"
    validity: Validity = NOT_STATED

    equation = "F = -eta_d rho A_r |v| v - eta_h g rho z^2 d sgn(v_x) e_x - eta_v (z/d)^lambda g rho V sgn(v_y) e_y"
    terms = TERMS
    takes = frozenset({"round"})
    by_component = True

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """Coefficients as the (1,) record that the kernels read; gravity in m/s2, its sense does not matter.

        Importing the kernels is put off until a medium is really used: a scene in vacuum needs no compiler.
        """
        from granular_contact.kernels import lee_marghitu

        record = np.zeros(1, lee_marghitu.RECORD)
        record["g"], record["rho"] = abs(gravity), self.density
        record["eta_d"], record["eta_h"] = self.eta_d, self.eta_h
        record["eta_plunge"], record["lam_plunge"] = self.plunging.eta_v, self.plunging.lam
        record["eta_withdraw"], record["lam_withdraw"] = self.withdrawing.eta_v, self.withdrawing.lam
        static.fill(record)
        return record
