"""Floor of a bed: a level line. A run reports that a body reaches it, and it may carry a stiff contact.

The contact is a spring and a damper per unit of length, normal to the floor:

    dF_y/ds = k delta max(0, 1 - d v_y)

delta is the depth below the floor, and v_y the vertical velocity at the middle of the strip. The damping grows with the
depth. So the force is continuous at the touch, and it never pulls. On a ball k acts over the diameter.

In space k is per area, and each point of a surface has its own delta and v_z, as on a row of springs (Winkler):

    dF_z/dA = k delta max(0, 1 - d v_z)

On a bar k acts over the diameter. On a ball of the radius R that a law takes as a whole, the force is the integral over
its surface, pi R k delta^2. The contact has no friction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.sand import kernels

TERM = "floor"


@dataclass(frozen=True)
class Floor:
    """Level floor of a bed.

    Parameters
    ----------
    height : float
        Height y of the floor (m); in space its height along `up`.
    stiffness : float, optional
        Stiffness k per length and penetration (N/m2), in space per area and penetration (N/m3), above 0; None: no
        contact.
    damping : float
        Damping d (s/m), 0 or more.

    Raises
    ------
    ValueError
        A number is not allowed.
    """

    height: float
    stiffness: float | None = None
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not math.isfinite(self.height):
            raise ValueError(f"Floor: got a height of {self.height}, allowed is a finite number (m)")
        if self.stiffness is not None and not 0.0 < self.stiffness < math.inf:
            raise ValueError(f"Floor: got a stiffness of {self.stiffness}, allowed is a number above 0, or None")
        if not 0.0 <= self.damping < math.inf:
            raise ValueError(f"Floor: got a damping of {self.damping}, allowed is 0 or more (s/m)")

    @property
    def profile(self) -> NDArray[np.float64]:
        """The floor as corners of a surface (1, 2) m."""
        return np.array([[0.0, self.height]])

    def record(self, kind: Kind) -> NDArray[np.void]:
        """Constants of the contact in the plane, as the kernels read them.

        Parameters
        ----------
        kind : str
            Kind of shape, one of `laws.kinds.Kind`.

        Returns
        -------
        (1,) array
            Record of `OnBalls` or `OnStrips`.
        """
        from granular_contact.sand.kernels.joining import blank

        record = blank(OnBalls if kind == "ball" else OnStrips)
        return self._filled(record)

    def record_in_space(self) -> NDArray[np.void]:
        """Constants of the contact in space, as a record (1,) of `InSpace`."""
        from granular_contact.sand.kernels.joining import blank

        return self._filled(blank(InSpace))

    def _filled(self, record: NDArray[np.void]) -> NDArray[np.void]:
        record["stiffness"], record["damping"] = self.stiffness or 0.0, self.damping
        return record


class OnStrips:
    """The contact on contact lines in the plane, as a law without bristles."""

    constants = ("stiffness", "damping")  # N/m^2, s/m

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the contact force of a strip. Arguments as in `laws.law`; depths are those below the floor."""
        share = max(0.0, 1.0 - m.damping * 0.5 * (strip.v0[1] + strip.v1[1]))
        k = m.stiffness * share * kernels.vectors.norm(strip.c)
        j0, j1 = kernels.immersion.part_integrals(strip.a, strip.b, strip.z0, strip.z1, 1.0)
        f[0, 0, 1] += k * j0
        f[0, 1, 1] += k * j1

    @staticmethod
    def drag_anchor(p, anchor, m):
        """Return the anchor unchanged, as a floor has no bristles; arguments as in `laws.law`."""
        return anchor


class OnBalls:
    """The contact on balls in the plane, as a law without bristles."""

    constants = OnStrips.constants
    drag_anchor = staticmethod(OnStrips.drag_anchor)

    @staticmethod
    def ball_force(z, v, e, line, m, f):
        """Add the contact force of a ball.

        Arguments as in `laws.law`; z is the depth of its lowest point below the floor.
        """
        f[0, 1] += m.stiffness * line.width * z * max(0.0, 1.0 - m.damping * v[1])


class InSpace:
    """The contact on surfaces, bars and balls in space, as a law without bristles.

    It acts on either side of a surface.
    """

    constants = ("stiffness", "damping")  # N/m^3, s/m
    by_component = False

    @staticmethod
    def facet_force(z, n, v, e, spread, side, j, m):
        """Traction of the floor on a facet. Arguments as in `laws.law`; z is the depth below the floor."""
        return (0.0, 0.0, m.stiffness * max(0.0, 1.0 - m.damping * v[2])), (0.0, 0.0, 0.0)

    @staticmethod
    def bar_force(strip, cluster, m, f):
        """Add the contact force of a strip of a bar. Arguments as in `laws.law`; depths are those below the floor."""
        share = max(0.0, 1.0 - m.damping * 0.5 * (strip.v0[2] + strip.v1[2]))
        k = m.stiffness * share * cluster.width * kernels.vectors.norm(strip.c)
        j0, j1 = kernels.immersion.part_integrals(strip.a, strip.b, strip.z0, strip.z1, 1.0)
        f[0, 0, 2] += k * j0
        f[0, 1, 2] += k * j1

    @staticmethod
    def space_ball_force(z, v, e, cluster, m, f):
        """Add the contact force of a ball.

        Arguments as in `laws.law`; z is the depth of its lowest point below the floor.
        """
        k = m.stiffness * math.pi * cluster.width * max(0.0, 1.0 - m.damping * v[2])
        cap = min(z, cluster.width)  # at a greater z the whole sphere lies below the floor
        f[0, 2] += k * (0.5 * cap * cap + cluster.width * (z - cap))
