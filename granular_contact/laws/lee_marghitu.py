"""Lee-Marghitu resistance of a granular medium, per unit of arc length of an immersed cylinder.

With the local depth z, velocity v, unit tangent t, diameter d and section area A = pi d^2 / 4:

    dF_d /ds = -eta_d rho d |t x v| v                               dynamic friction (drag)
    dF_sh/ds = -2 eta_h g rho d z |t_y| sgn(v_x)                    horizontal static resistance
    dF_sv/ds = -(lam + 1) eta_v g rho A (z/d)^lam sgn(v_y)          vertical static resistance

Over a straight link that pierces the surface these integrate to the resultants of the source paper [rebuilt, see
docs/about/model.md]. eta_v and lam have one value for plunging (v_y < 0) and another for withdrawing.
`sand.kernels.friction` regularises the sign. In space sgn(v_x) e_x becomes the horizontal direction r of the motion,
and |t_y| becomes |t x r| [ours]; see `sand.kernels.bars`.

A strip has the end positions p_0, p_1. With c = p_1 - p_0, ds = |c| dxi, |t x v| ds = |c x v| dxi and |t_y| ds = |c_y|
dxi.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, field_serializer

from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.gravity import BULK, INERTIA, SHAPE, WEIGHT_FACTOR
from granular_contact.laws.law import Law
from granular_contact.sand import kernels
from granular_contact.values.strict import NotNegative, OrNull, Positive

DRAG, HORIZONTAL, VERTICAL = 0, 1, 2  # terms


class VerticalResistance(Coefficients):
    """Vertical static resistance, eta_v (z/d)^lambda per weight of displaced medium at the depth z.

    Parameters
    ----------
    eta_v : float
        Coefficient, 0 or more.
    lam : float
        Power of the depth, 0 to 5; `lambda` in YAML.
    """

    eta_v: Annotated[NotNegative, WEIGHT_FACTOR]
    lam: Annotated[float, SHAPE] = Field(alias="lambda", ge=0, le=5)

    def numbers(self, direction: str) -> dict[str, float]:
        """Constants of a law for one direction of motion.

        Parameters
        ----------
        direction : {"plunge", "withdraw"}
            Direction, the end of the names of the constants.

        Returns
        -------
        dict
            eta_v and lambda as constants of a law.
        """
        return {f"eta_{direction}": self.eta_v, f"lam_{direction}": self.lam}


class LeeMarghitu(Law):
    """Drag quadratic in speed, static resistance that grows with depth, on a round bar (Lee and Marghitu).

    Parameters
    ----------
    density : float
        Density of the medium as the law uses it (kg/m3), above 0.
    eta_d : float
        Coefficient of the drag, 0 or more.
    eta_h : float
        Coefficient of the horizontal static resistance, 0 or more.
    plunging : VerticalResistance
        Vertical static resistance of a link that moves down.
    withdrawing : VerticalResistance, optional
        Vertical static resistance of a link that moves up; null: as plunging.
    """

    law: Literal["lee_marghitu"]
    density: Annotated[Positive, BULK] = Field(alias="density_kg_m3")
    eta_d: Annotated[NotNegative, INERTIA]
    eta_h: Annotated[NotNegative, WEIGHT_FACTOR]
    plunging: VerticalResistance
    withdrawing: Annotated[VerticalResistance, OrNull(), Field(default=None)]

    equation = "F = -eta_d rho A_r |v| v - eta_h g rho z^2 d sgn(v_x) e_x - eta_v (z/d)^lambda g rho V sgn(v_y) e_y"
    terms = ("drag", "horizontal_static", "vertical_static")
    takes = frozenset({"round"})
    by_component = True
    resultant = True
    constants = ("g", "rho", "eta_d", "eta_h", "eta_plunge", "lam_plunge", "eta_withdraw", "lam_withdraw")

    def model_post_init(self, context: Any, /) -> None:
        """Use the coefficients of plunging for withdrawing if none are given."""
        super().model_post_init(context)
        if self.withdrawing is None:
            self.__dict__["withdrawing"] = self.plunging

    @field_serializer("withdrawing", mode="wrap")
    def _as_plunging(self, withdrawing: VerticalResistance, dump: SerializerFunctionWrapHandler) -> Any:
        return None if withdrawing is self.plunging else dump(withdrawing)

    def numbers(self, gravity: float) -> dict[str, float]:
        """Constants of the forces; see `Law.numbers`."""
        return {
            "g": gravity,
            "rho": self.density,
            "eta_d": self.eta_d,
            "eta_h": self.eta_h,
            **self.plunging.numbers("plunge"),
            **self.withdrawing.numbers("withdraw"),
        }

    @staticmethod
    def strip_force(strip, line, m, f):
        """Add the three terms of a strip in the plane.

        Arguments as in `laws.law`; `line.width` is the diameter d (m).
        """
        d = line.width
        drag, horizontal, vertical = term_factors(d, m)
        if drag != 0.0:
            drag_force(strip, drag, f[DRAG])
        if horizontal != 0.0:
            kernels.bar_statics.horizontal_force(strip, horizontal, m, f[HORIZONTAL])
        eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
        kernels.bar_statics.vertical_force(strip, vertical, eta, lam, d, m, f[VERTICAL])

    @staticmethod
    def bar_force(strip, cluster, m, f):
        """Add the three terms of a strip in space.

        Arguments as in `laws.law`; `cluster.width` is the diameter d (m).
        """
        d = cluster.width
        drag, horizontal, vertical = term_factors(d, m)
        if drag != 0.0:
            kernels.bars.drag_force(strip, drag, f[DRAG])
        if horizontal != 0.0:
            kernels.bars.horizontal_force(strip, horizontal, m, f[HORIZONTAL])
        eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
        kernels.bars.vertical_force(strip, vertical, eta, lam, d, m, f[VERTICAL])

    @staticmethod
    def cap_force(c, v, line, m, f):
        """Add the drag on the free end face, -eta_d rho A |t . v| v, to f[DRAG, 1] (N). Arguments as in `laws.law`."""
        length = math.hypot(c[0], c[1])
        if length == 0.0:  # such a strip has no direction
            return
        k = face_factor(line.width, m) * abs(c[0] / length * v[0] + c[1] / length * v[1])
        f[DRAG, 1, 0] -= k * v[0]
        f[DRAG, 1, 1] -= k * v[1]

    @staticmethod
    def bar_cap(c, v, cluster, m, f):
        """Add the drag on the free end face in space to f[DRAG, 1] (N). Arguments as in `laws.law`."""
        length = kernels.vectors.norm(c)
        if length == 0.0:
            return
        k = face_factor(cluster.width, m) / length * abs(c[0] * v[0] + c[1] * v[1] + c[2] * v[2])
        for i in range(3):
            f[DRAG, 1, i] -= k * v[i]


def term_factors(d, m):
    """Factors of the three terms for a bar.

    Parameters
    ----------
    d : float
        Diameter of the bar (m).
    m : record
        Constants of the law.

    Returns
    -------
    tuple of float
        eta_d rho d (kg/m^2), eta_h g rho d (N/m^2) and g rho A (N/m).
    """
    return m.eta_d * m.rho * d, m.eta_h * m.g * m.rho * d, m.g * m.rho * 0.25 * math.pi * d * d


def face_factor(d, m):
    """Factor of the drag on an end face.

    Parameters
    ----------
    d : float
        Diameter of the bar (m).
    m : record
        Constants of the law.

    Returns
    -------
    float
        eta_d rho A (kg/m).
    """
    return m.eta_d * m.rho * 0.25 * math.pi * d * d


def drag_force(strip, k, f):
    """Add the drag of a strip in the plane.

    On either side of the zero of c x v the integrand is a cubic in xi, which two Gauss points integrate exactly.

    Parameters
    ----------
    strip : Strip
        The immersed part of the strip and its motion.
    k : float
        eta_d rho d (kg/m^2).
    f : (2, 2) array
        Forces (N) at both ends, x and y.
    """
    (cx, cy), (v0x, v0y), (v1x, v1y) = strip.c, strip.v0, strip.v1
    split = kernels.immersion.sign_change(strip.a, strip.b, cx * v0y - cy * v0x, cx * v1y - cy * v1x)
    for start, end in ((strip.a, split), (split, strip.b)):
        if start == end:
            continue
        for gauss in (kernels.immersion.GAUSS_LOW, kernels.immersion.GAUSS_HIGH):
            xi = start + (end - start) * gauss
            vx = (1.0 - xi) * v0x + xi * v1x
            vy = (1.0 - xi) * v0y + xi * v1y
            kw = k * 0.5 * (end - start) * abs(cx * vy - cy * vx)
            f[0, 0] -= (1.0 - xi) * kw * vx
            f[0, 1] -= (1.0 - xi) * kw * vy
            f[1, 0] -= xi * kw * vx
            f[1, 1] -= xi * kw * vy
