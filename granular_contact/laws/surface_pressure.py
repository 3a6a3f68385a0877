"""What the laws of pressure and sinkage share: a pressure of the depth z, and the shear that it lets a surface bear.

    p = (k_0 + k_c / b + k_b b) (z / l)^n,      tau = (c + p tan phi) (1 - exp(-j / K))

on what goes into the medium: the outside of an outline where n . u > 0, either face of a thin plate. The pressure acts
against n, the shear against the part of the motion along the surface, no more than Mohr and Coulomb allow. Bekker and
Wong put these stresses on the rim of a wheel. The shear displacement j of Janosi and Hanamoto is the path that the
bristles of a surface were dragged along it since it got into the medium. They give no law for a surface that turns
back, as the rim of a braked wheel does: j is counted anew from there, as in Wong and Reece's towed wheel, and the shear
opposes the motion (`sand.kernels.path_length`). So nothing is given back, and the pull goes over from driving to
braking without a jump, though steeply: by the root of the slip.

The stresses do not vanish where the motion comes to lie along a thin plate, or at right angles to a surface: there both
are faded, over the angle FADE [ours]. The laws are of what presses down: on what leads with a normal that looks up the
stresses go down in proportion to its sine, to none on a face that is lifted as it lies [ours]. Cohesion grows from
nothing over the first SHALLOW b of the depth, so that the force is continuous at the touch [ours].
"""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from granular_contact.laws.gravity import FRICTION, SHAPE, derived, not_known
from granular_contact.laws.law import ABOUT, Law
from granular_contact.values.strict import NotNegative, Positive

SHEAR = ("friction_angle", "cohesion", "shear_deformation_modulus", "plate_width")
SHALLOW = 1e-2  # of b
FADE = 0.05  # sine: 2.9 degrees
BONDS = derived(0, "a strength of the bonds between grains, whatever they weigh")
SHEARED = not_known("a length; we know of no tests at other gravities")
Exponent = Annotated[float, Field(gt=0, le=5)]
Angle = Annotated[float, Field(ge=0, lt=90)]


class SurfacePressure(Law):
    """A law that gives the numbers of the pressure; the shear is here.

    Parameters
    ----------
    friction_angle : float
        phi (deg), 0 to below 90; 0: no shear but that of the cohesion.
    cohesion : float
        c (Pa), 0 or more.
    shear_deformation_modulus : float
        K (m) of Janosi and Hanamoto, also called shear displacement modulus; 0: all of the shear from the first motion
        on.
    plate_width : float, optional
        b (m); null: the width of a shape normal to the plane, the diameter of a bar. In space b has to be
        given.
    """

    friction_angle: Annotated[Angle, FRICTION] = Field(alias="friction_angle_deg")
    cohesion: Annotated[NotNegative, BONDS] = Field(0.0, alias="cohesion_Pa")
    shear_deformation_modulus: Annotated[NotNegative, SHEARED] = Field(0.0, alias="shear_deformation_modulus_m")
    plate_width: Annotated[Positive | None, SHAPE] = Field(None, alias="plate_width_m")

    terms = ("pressure", "shear")
    takes = frozenset({"round", "flat", "outline"})
    # Pa, N/m, N/m^3, m (0: b), -, Pa, -, m, m (0: of the shape)
    constants = ("k_0", "k_c", "k_b", "scale", "n", "cohesion", "tan_phi", "K", "b")

    @classmethod
    def positions(cls) -> list[str]:
        """As in `Coefficients`: what is needed first, the pressure before the shear."""
        own = [name for name in super().positions() if name not in (*SHEAR, *ABOUT)]
        needed = {name for name in (*own, *SHEAR) if cls.model_fields[name].is_required()}
        return [*sorted((*own, *SHEAR), key=lambda name: name not in needed), *ABOUT]

    def pressure(self, gravity: float) -> dict[str, float]:
        """Numbers of the pressure; gravity >= 0 in m/s2."""
        raise NotImplementedError

    @property
    def of_width(self) -> bool:
        """Whether the pressure depends on b."""
        raise NotImplementedError

    @property
    def shear_grows(self) -> bool:
        """As of `Law`."""
        return self.shear_deformation_modulus > 0.0

    @property
    def lacking_in_space(self) -> list[str]:
        """As of `Law`."""
        return ["plate_width_m"] if self.of_width and self.plate_width is None else []

    def numbers(self, gravity: float) -> dict[str, float]:
        """As `Law.numbers`."""
        return {
            "cohesion": self.cohesion,
            "tan_phi": math.tan(math.radians(self.friction_angle)),
            "K": self.shear_deformation_modulus,
            "b": self.plate_width or 0.0,
            **self.pressure(gravity),
        }

    @staticmethod
    def traction(z, t, u, width, side, j, m):
        """Pressure and shear; as `sand.kernels.plates.traction`."""
        (tx, ty), (ux, uy) = t, u
        across, along = tx * uy - ty * ux, tx * ux + ty * uy
        lead = led(across, tx, side)
        p = pressure(z, width, m)
        s = abs(lead) * faded(along) * shear(p, z, width, j, m)
        return (p * lead * ty, -p * lead * tx), (-s * tx, -s * ty)

    @staticmethod
    def facet_traction(z, n, u, side, j, m):
        """Pressure and shear; as `sand.kernels.facet_blocks.traction`."""
        (nx, ny, nz), (ux, uy, uz) = n, u
        across = nx * ux + ny * uy + nz * uz
        lead = led(across, nz, side)
        p = pressure(z, 0.0, m)
        tx, ty, tz = ux - across * nx, uy - across * ny, uz - across * nz
        s = abs(lead) * shear(p, z, 0.0, j, m) / max(FADE, math.sqrt(tx * tx + ty * ty + tz * tz))
        p *= lead
        return (-p * nx, -p * ny, -p * nz), (-s * tx, -s * ty, -s * tz)


def led(across, up, side):
    """Share of the pressure on an element, positive against its normal, which looks up by `up`, the sine of an angle.

    across: n . u, whose sign says which face of a thin plate leads. Of a facet on one side it may be below 0 at the
    centroid and yet above it on the part that leads.
    """
    if side != 0.0:
        return side * downward(side * up)
    return faded(across) * downward(math.copysign(1.0, across) * up)


def faded(part):
    """Sign of a part of a direction, which grows from -1 to 1 over 2 FADE."""
    return min(1.0, max(-1.0, part / FADE))


def downward(up):
    """Share of the stresses on what leads with a normal that looks up by `up`, the sine of an angle."""
    return min(1.0, 1.0 - up)


def pressure(z, width, m):
    """Pressure p (Pa) at a depth z > 0 (m) on a shape of a width (m)."""
    b = m.b if m.b > 0.0 else width
    k = m.k_0
    if m.k_c != 0.0 or m.k_b != 0.0:
        k += m.k_c / b + m.k_b * b
    return k * (z / (m.scale if m.scale > 0.0 else b)) ** m.n


def shear(p, z, width, j, m):
    """Shear tau (Pa) under a pressure p (Pa) at a depth z > 0 (m) after the shear displacement j (m)."""
    skin = SHALLOW * (m.b if m.b > 0.0 else width)
    most = m.cohesion * (min(1.0, z / skin) if skin > 0.0 else 1.0) + p * m.tan_phi
    return most * (1.0 - math.exp(-j / m.K)) if m.K > 0.0 else most
