"""Medium of Hill, Yeung and Koehler (2005): vertical resistance eta (z/l)^lam g rho_g V of a thin round bar only.

Compiled equations: `kernels.hill`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.lee_marghitu import VerticalResistance
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class Hill:
    """density: rho_g (kg/m3); plunging, withdrawing: eta and lam; length_scale: l (m), None for the diameter."""

    density: float
    plunging: VerticalResistance
    withdrawing: VerticalResistance
    length_scale: float | None = None
    name: str = "hill"
    validity: Validity = NOT_STATED

    equation = "F_v = -eta (z/l)^lambda g rho V sgn(v_y)"
    terms = ("vertical_static",)
    takes = frozenset({"round"})
    by_component = True

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """As `Medium.record`."""
        from granular_contact.kernels import hill

        record = np.zeros(1, hill.RECORD)
        record["g_rho"], record["l"] = abs(gravity) * self.density, self.length_scale or 0.0
        record["eta_plunge"], record["lam_plunge"] = self.plunging.eta_v, self.plunging.lam
        record["eta_withdraw"], record["lam_withdraw"] = self.withdrawing.eta_v, self.withdrawing.lam
        static.fill(record)
        return record
