"""Floor of a bed: a level line that reports when it is reached, and may carry a stiff contact.

The contact is a spring and a damper per unit of length, normal to the floor:

    dF_y/ds = k delta max(0, 1 - d v_y)

with the depth delta below the floor and the vertical velocity v_y at mid-strip. The damping grows with the depth, so
the force is continuous at the touch, and it never pulls. On a ball k acts over its diameter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact import kernels
from granular_contact.laws.kinds import Kind

TERM = "floor"


@dataclass(frozen=True)
class Floor:
    """height: y (m); stiffness: N/m2, per length and penetration, None for no contact; damping: d (s/m)."""

    height: float
    stiffness: float | None = None
    damping: float = 0.0

    @property
    def profile(self) -> NDArray[np.float64]:
        """The floor as a surface (1, 2) m."""
        return np.array([[0.0, self.height]])

    def record(self, kind: Kind) -> NDArray[np.void]:
        """Constants as the (1,) record that the kernels read on shapes of a kind."""
        from granular_contact.kernels.joining import blank

        record = blank(OnBalls if kind == "ball" else OnStrips)
        record["stiffness"], record["damping"] = self.stiffness or 0.0, self.damping
        return record


class OnStrips:
    """The contact as a law of lines; it has no bristles."""

    constants = ("stiffness", "damping")  # N/m^2, s/m

    @staticmethod
    def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
        """Add the end forces of a strip; z0, z1 are depths below the floor, else as in `kernels.law.strip_force`."""
        share = max(0.0, 1.0 - m.damping * 0.5 * (v0y + v1y))
        k = m.stiffness * share * math.sqrt(cx * cx + cy * cy)
        j0, j1 = kernels.immersion.part_integrals(a, b, z0, z1, 1.0)
        f[0, 0, 1] += k * j0
        f[0, 1, 1] += k * j1

    @staticmethod
    def drag_anchor(px, py, ax, ay, m):
        """A floor has no bristles."""
        return ax, ay


class OnBalls:
    """The contact as a law of balls."""

    constants = OnStrips.constants
    drag_anchor = staticmethod(OnStrips.drag_anchor)

    @staticmethod
    def ball_force(z, vx, vy, ex, ey, run, m, f):
        """Add the force of a ball, z being the depth of its lowest point below the floor; as in `kernels.law`."""
        f[0, 1] += m.stiffness * run.width * z * max(0.0, 1.0 - m.damping * vy)
