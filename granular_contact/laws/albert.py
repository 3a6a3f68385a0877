"""Medium of Albert et al. (1999): horizontal resistance eta_h g rho_g H^2 d of a thin round bar; nothing else.

Compiled equations: `kernels.albert`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.laws.validity import NOT_STATED, Validity


@dataclass(frozen=True)
class Albert:
    """density: rho_g (kg/m3); eta_h: fitted to the medium."""

    density: float
    eta_h: float
    name: str = "albert"
    validity: Validity = NOT_STATED

    equation = "F_h = -eta_h g rho z^2 d sgn(v_x)"
    terms = ("horizontal_static",)
    takes = frozenset({"round"})
    by_component = True

    def record(self, static: Elastoplastic | Smooth, gravity: float) -> NDArray[np.void]:
        """As `Medium.record`."""
        from granular_contact.kernels import albert

        record = np.zeros(1, albert.RECORD)
        record["eta_h_g_rho"] = self.eta_h * abs(gravity) * self.density
        static.fill(record)
        return record
