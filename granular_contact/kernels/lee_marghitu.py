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

import numpy as np
from numba import njit

from granular_contact.kernels import law, strips
from granular_contact.kernels.bar_statics import component_return, horizontal_force, vertical_force
from granular_contact.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, sign_change

DRAG, HORIZONTAL, VERTICAL = 0, 1, 2
TERMS = ("drag", "horizontal_static", "vertical_static")

RECORD = np.dtype(
    [
        ("g", "f8"),
        ("rho", "f8"),
        ("eta_d", "f8"),
        ("eta_h", "f8"),
        ("eta_plunge", "f8"),
        ("lam_plunge", "f8"),
        ("eta_withdraw", "f8"),
        ("lam_withdraw", "f8"),
        ("friction", "i8"),
        ("u_y", "f8"),
        ("tau", "f8"),
        ("v_eps", "f8"),
    ]
)


@law.provide(law.strip_force, "m", RECORD)
@njit(cache=True)
def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the three force terms; arguments as in `law.strip_force`, run.width is the diameter d."""
    d = run.width
    if m.eta_d != 0.0:
        drag_force(a, b, cx, cy, v0x, v0y, v1x, v1y, m.eta_d * m.rho * d, f[DRAG])
    if m.eta_h != 0.0:
        horizontal_force(a, b, z0, z1, cy, v0x, v1x, e0x, e1x, m.eta_h * m.g * m.rho * d, m, f[HORIZONTAL])
    eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
    k = m.g * m.rho * 0.25 * math.pi * d * d
    vertical_force(a, b, z0, z1, cx, cy, v0y, v1y, e0y, e1y, k, eta, lam, d, m, f[VERTICAL])


@njit(cache=True)
def drag_force(a, b, cx, cy, v0x, v0y, v1x, v1y, k, f):
    """Add the drag to f[end, xy] (N); k = eta_d rho d. On either side of the zero of c x v it is a cubic in xi."""
    c = sign_change(a, b, cx * v0y - cy * v0x, cx * v1y - cy * v1x)
    for start, end in ((a, c), (c, b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            vx = (1.0 - xi) * v0x + xi * v1x
            vy = (1.0 - xi) * v0y + xi * v1y
            kw = k * 0.5 * (end - start) * abs(cx * vy - cy * vx)
            f[0, 0] -= (1.0 - xi) * kw * vx
            f[0, 1] -= (1.0 - xi) * kw * vy
            f[1, 0] -= xi * kw * vx
            f[1, 1] -= xi * kw * vy


@law.provide(law.cap_force, "m", RECORD)
@njit(cache=True)
def cap_force(cx, cy, vx, vy, run, m, f):
    """Add the drag on the free end face at end 1 of a strip, -eta_d rho A |t . v| v, to f[DRAG, 1] (N)."""
    d, length = run.width, math.hypot(cx, cy)
    if length == 0.0:  # looks nowhere
        return
    k = m.eta_d * m.rho * 0.25 * math.pi * d * d * abs(cx / length * vx + cy / length * vy)
    f[DRAG, 1, 0] -= k * vx
    f[DRAG, 1, 1] -= k * vy


law.provide(law.drag_anchor, "m", RECORD)(component_return)
strips.line_law(RECORD)
