"""Lee-Marghitu resistance of a granular medium, per unit of arc length of an immersed cylinder.

With local depth z, velocity v, unit tangent t, diameter d and section area A = pi d^2 / 4:

    dF_d /ds = -eta_d rho d |t x v| v                               dynamic friction (drag)
    dF_sh/ds = -2 eta_h g rho d z |t_y| sgn(v_x)                    horizontal static resistance
    dF_sv/ds = -(lam + 1) eta_v g rho A (z/d)^lam sgn(v_y)          vertical static resistance

Over a straight link that pierces the surface these integrate to the resultants of the source paper [rebuilt there, see
README]. (eta_v, lam) have one value for plunging (v_y < 0) and one for withdrawing. The sign is regularised in
`kernels.friction`.

A strip has end positions p_0, p_1 with c = p_1 - p_0, so that ds = |c| dxi, |t x v| ds = |c x v| dxi and
|t_y| ds = |c_y| dxi.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import Field, SerializerFunctionWrapHandler, field_serializer

from granular_contact import kernels
from granular_contact.laws.coefficients import Coefficients
from granular_contact.laws.law import Law
from granular_contact.values.strict import NotNegative, OrNull, Positive

DRAG, HORIZONTAL, VERTICAL = 0, 1, 2  # terms


class VerticalResistance(Coefficients):
    """Vertical static resistance, eta_v (z/d)^lambda per weight of displaced medium at depth z."""

    eta_v: NotNegative
    lam: float = Field(alias="lambda", ge=0, le=5)
    """`lambda` in YAML."""

    def numbers(self, way: str) -> dict[str, float]:
        """Constants of a law in one direction of motion, plunge or withdraw."""
        return {f"eta_{way}": self.eta_v, f"lam_{way}": self.lam}


class LeeMarghitu(Law):
    """Drag quadratic in speed, static resistance that grows with depth; all coefficients are dimensionless."""

    law: Literal["lee_marghitu"]
    density: Positive = Field(alias="density_kg_m3")
    """Density of the medium as its law uses it."""
    eta_d: NotNegative
    """Drag."""
    eta_h: NotNegative
    """Horizontal static resistance."""
    plunging: VerticalResistance
    """Where the link moves down."""
    withdrawing: Annotated[VerticalResistance, OrNull(), Field(default=None)]
    """Where the link moves up; null: as plunging."""

    equation = "F = -eta_d rho A_r |v| v - eta_h g rho z^2 d sgn(v_x) e_x - eta_v (z/d)^lambda g rho V sgn(v_y) e_y"
    terms = ("drag", "horizontal_static", "vertical_static")
    takes = frozenset({"round"})
    by_component = True
    resultant = True
    constants = ("g", "rho", "eta_d", "eta_h", "eta_plunge", "lam_plunge", "eta_withdraw", "lam_withdraw")

    def model_post_init(self, context: Any, /) -> None:
        """What withdrawing leaves out is as for plunging."""
        super().model_post_init(context)
        if self.withdrawing is None:
            self.__dict__["withdrawing"] = self.plunging

    @field_serializer("withdrawing", mode="wrap")
    def _as_plunging(self, withdrawing: VerticalResistance, dump: SerializerFunctionWrapHandler) -> Any:
        return None if withdrawing is self.plunging else dump(withdrawing)

    def numbers(self, gravity: float) -> dict[str, float]:
        """As `Law.numbers`."""
        return {
            "g": gravity,
            "rho": self.density,
            "eta_d": self.eta_d,
            "eta_h": self.eta_h,
            **self.plunging.numbers("plunge"),
            **self.withdrawing.numbers("withdraw"),
        }

    @staticmethod
    def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
        """Add the three force terms; arguments as in `kernels.law.strip_force`, run.width is the diameter d."""
        d = run.width
        if m.eta_d != 0.0:
            drag_force(a, b, cx, cy, v0x, v0y, v1x, v1y, m.eta_d * m.rho * d, f[DRAG])
        if m.eta_h != 0.0:
            k = m.eta_h * m.g * m.rho * d
            kernels.bar_statics.horizontal_force(a, b, z0, z1, cy, v0x, v1x, e0x, e1x, k, m, f[HORIZONTAL])
        eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
        k = m.g * m.rho * 0.25 * math.pi * d * d
        kernels.bar_statics.vertical_force(
            a, b, z0, z1, cx, cy, v0y, v1y, e0y, e1y, k, eta, lam, d, m, f[VERTICAL]
        )  # fmt: skip

    @staticmethod
    def cap_force(cx, cy, vx, vy, run, m, f):
        """Add the drag on the free end face at end 1 of a strip, -eta_d rho A |t . v| v, to f[DRAG, 1] (N)."""
        d, length = run.width, math.hypot(cx, cy)
        if length == 0.0:  # looks nowhere
            return
        k = m.eta_d * m.rho * 0.25 * math.pi * d * d * abs(cx / length * vx + cy / length * vy)
        f[DRAG, 1, 0] -= k * vx
        f[DRAG, 1, 1] -= k * vy


def drag_force(a, b, cx, cy, v0x, v0y, v1x, v1y, k, f):
    """Add the drag to f[end, xy] (N); k = eta_d rho d. On either side of the zero of c x v it is a cubic in xi."""
    c = kernels.immersion.sign_change(a, b, cx * v0y - cy * v0x, cx * v1y - cy * v1x)
    for start, end in ((a, c), (c, b)):
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
