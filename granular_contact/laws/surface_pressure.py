"""Base class of pressure-sinkage laws: a pressure that grows with the depth z, and the shear stress that it limits.

    p = (k_0 + k_c / b + k_b b) (z / l)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

The stresses act on what moves into the medium: the outside of an outline where n . u > 0, or either face of a thin
plate. The pressure acts against n. The shear acts against the component of the motion along the surface, with the limit
of Mohr and Coulomb. Bekker and Wong apply these stresses to the rim of a wheel.

The shear displacement j of Janosi and Hanamoto is the path along which the bristles of a surface were dragged since the
surface entered the medium. Janosi and Hanamoto give no law for a surface that turns back, as the rim of a braked wheel
does. There j restarts at 0, as in Wong and Reece's towed wheel, and the shear opposes the motion
(`sand.kernels.path_length`). So no energy is given back. The pull goes from driving to braking without a jump, but
steeply: with the root of the slip.

The equations do not vanish where the motion comes to lie along a thin plate, or at right angles to a surface. Over the
angle FADE from these directions both stresses on the plate fade, and the shear on the surface [ours]. The laws describe
surfaces that press down. On a leading surface whose normal looks up, the stresses fall linearly with the sine of its
elevation, to 0 on a horizontal face that is lifted [ours]. The cohesion grows from 0 over the first SHALLOW b of depth,
so that the force is continuous at the touch [ours].
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from granular_contact.laws.gravity import FRICTION, SHAPE, derived, not_known
from granular_contact.laws.law import METADATA, Law
from granular_contact.values.strict import NotNegative, Positive

SHEAR = ("friction_angle", "cohesion", "shear_deformation_modulus", "plate_width")
SHALLOW = 1e-2  # depth, divided by b, over which the cohesion grows to its full value
FADE = 0.05  # sine of the angle over which the stresses fade: 2.9 degrees
BONDS = derived(0, "a strength of the bonds between grains, whatever they weigh")
SHEARED = not_known("a length; we know of no tests at other gravities")
Exponent = Annotated[float, Field(gt=0, le=5)]
Angle = Annotated[float, Field(ge=0, lt=90)]


class SurfacePressure(Law):
    """Law with the shear stress of this module. A subclass gives the constants of the pressure.

    Parameters
    ----------
    friction_angle : float
        phi (deg), 0 to below 90; 0: no shear but that of the cohesion.
    cohesion : float
        c (Pa), 0 or more.
    shear_deformation_modulus : float
        K (m) of Janosi and Hanamoto, also called shear displacement modulus; 0: the full shear from the first motion
        on.
    plate_width : float, optional
        b (m); null: the width of a shape normal to the plane, or the diameter of a bar. In space b has to be given.
    """

    friction_angle: Annotated[Angle, FRICTION] = Field(alias="friction_angle_deg")
    cohesion: Annotated[NotNegative, BONDS] = Field(0.0, alias="cohesion_Pa")
    shear_deformation_modulus: Annotated[NotNegative, SHEARED] = Field(0.0, alias="shear_deformation_modulus_m")
    plate_width: Annotated[Positive | None, SHAPE] = Field(None, alias="plate_width_m")

    terms = ("pressure", "shear")
    takes = frozenset({"round", "flat", "outline"})
    # Units: Pa, N/m, N/m^3, m (0: b), -, Pa, -, m, m (0: the width of the shape)
    constants = ("k_0", "k_c", "k_b", "scale", "n", "cohesion", "tan_phi", "K", "b")

    @classmethod
    def positions(cls) -> list[str]:
        """Names in the order of positional arguments: required ones first, those of the pressure before the shear."""
        pressure_names = [name for name in super().positions() if name not in (*SHEAR, *METADATA)]
        required = {name for name in (*pressure_names, *SHEAR) if cls.model_fields[name].is_required()}
        return [*sorted((*pressure_names, *SHEAR), key=lambda name: name not in required), *METADATA]

    def pressure(self, gravity: float) -> dict[str, float]:
        """Constants of the pressure.

        Parameters
        ----------
        gravity : float
            Gravity (m/s2), 0 or more.

        Returns
        -------
        dict
            Values of k_0, k_c, k_b, scale and n, where they are not 0; units as in `constants`.
        """
        raise NotImplementedError

    @property
    def depends_on_width(self) -> bool:
        """Whether the pressure depends on b."""
        raise NotImplementedError

    @property
    def shear_grows(self) -> bool:
        """Whether the shear depends on the shear displacement; see `Law.shear_grows`."""
        return self.shear_deformation_modulus > 0.0

    @property
    def lacking_in_space(self) -> list[str]:
        """Keys that are missing in space; see `Law.lacking_in_space`."""
        return ["plate_width_m"] if self.depends_on_width and self.plate_width is None else []

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the stresses; see `Law.numbers`."""
        return {
            "cohesion": self.cohesion,
            "tan_phi": math.tan(math.radians(self.friction_angle)),
            "K": self.shear_deformation_modulus,
            "b": self.plate_width or 0.0,
            **self.pressure(gravity),
        }

    @staticmethod
    def traction(z, t, u, width, side, j, m):
        """Pressure and shear traction, (2,) and (2,) Pa, in the plane; arguments as in `laws.law`."""
        (tx, ty), (ux, uy) = t, u
        across, along = tx * uy - ty * ux, tx * ux + ty * uy
        share = leading_share(across, tx, side)
        p = pressure(z, width, m)
        tau = abs(share) * faded_sign(along) * shear(p, z, width, j, m)
        return (p * share * ty, -p * share * tx), (-tau * tx, -tau * ty)

    @staticmethod
    def facet_traction(z, n, u, side, j, m):
        """Pressure and shear traction, (3,) and (3,) Pa, in space; arguments as in `laws.law`."""
        (nx, ny, nz), (ux, uy, uz) = n, u
        across = nx * ux + ny * uy + nz * uz
        share = leading_share(across, nz, side)
        p = pressure(z, 0.0, m)
        tx, ty, tz = ux - across * nx, uy - across * ny, uz - across * nz
        tau = abs(share) * shear(p, z, 0.0, j, m) / max(FADE, math.sqrt(tx * tx + ty * ty + tz * tz))
        p *= share
        return (-p * nx, -p * ny, -p * nz), (-tau * tx, -tau * ty, -tau * tz)


def leading_share(across, up, side):
    """Share of the pressure that acts on an element, positive against its normal.

    Parameters
    ----------
    across : float
        n . u. On a thin plate its sign selects the leading face. On a one-sided facet it may be negative at the
        centroid, while part of the facet leads.
    up : float
        Sine of the elevation of the normal.
    side : float
        +1 or -1 if one side of the element is outside, 0 on a thin plate.

    Returns
    -------
    float
        Share in [-1, 1].
    """
    if side != 0.0:
        return side * downward_share(side * up)
    return faded_sign(across) * downward_share(math.copysign(1.0, across) * up)


def faded_sign(part):
    """Regularised sign of the component of a direction.

    Parameters
    ----------
    part : float
        Component of a unit vector.

    Returns
    -------
    float
        -1 to 1, linear between -FADE and FADE.
    """
    return min(1.0, max(-1.0, part / FADE))


def downward_share(up):
    """Share of the stresses on a leading element, by the elevation of its normal.

    Parameters
    ----------
    up : float
        Sine of the elevation of the leading normal.

    Returns
    -------
    float
        1 where the normal looks down or to the side, falling to 0 where it points straight up.
    """
    return min(1.0, 1.0 - up)


def pressure(z, width, m):
    """Pressure p on an element.

    Parameters
    ----------
    z : float
        Depth (m), above 0.
    width : float
        Width of the shape (m), used where b is not given.
    m : record
        Constants of the law.

    Returns
    -------
    float
        Pa.
    """
    b = m.b if m.b > 0.0 else width
    k = m.k_0
    if m.k_c != 0.0 or m.k_b != 0.0:
        k += m.k_c / b + m.k_b * b
    return k * (z / (m.scale if m.scale > 0.0 else b)) ** m.n


def shear(p, z, width, j, m):
    """Shear stress tau on an element.

    Parameters
    ----------
    p : float
        Pressure (Pa).
    z : float
        Depth (m), above 0.
    width : float
        Width of the shape (m), used where b is not given.
    j : float
        Shear displacement (m).
    m : record
        Constants of the law.

    Returns
    -------
    float
        Pa.
    """
    depth = SHALLOW * (m.b if m.b > 0.0 else width)
    limit = m.cohesion * (min(1.0, z / depth) if depth > 0.0 else 1.0) + p * m.tan_phi
    return limit * (1.0 - math.exp(-j / m.K)) if m.K > 0.0 else limit
