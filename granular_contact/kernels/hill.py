"""Vertical resistance of an immersed body (Hill, Yeung and Koehler 2005), spread along a thin bar.

    F = eta (z/l)^lam g rho_g V    against the vertical motion of a volume V whose tip is at the depth z

The density (lam + 1) eta (z/l)^lam g rho_g A per unit of arc length, A the section, [ours] integrates to it over a
straight bar at any slope that pierces the surface. l is the diameter unless given; (eta, lam) have one value for
plunging and one for withdrawing. There is no horizontal force and no drag.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from granular_contact.kernels import law, strips
from granular_contact.kernels.bar_statics import component_return, vertical_force, vertical_tangent
from granular_contact.kernels.friction import direction, direction_slopes

TERMS = ("vertical_static",)
RECORD = np.dtype(
    [
        ("g_rho", "f8"),  # N/m^3
        ("l", "f8"),  # m; 0: the diameter
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
def strip_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """Add the end forces of a strip; arguments as in `law.strip_force`."""
    sigma = direction(ey, 0.5 * (v0y + v1y), m)
    eta, lam = (m.eta_plunge, m.lam_plunge) if sigma < 0.0 else (m.eta_withdraw, m.lam_withdraw)
    k = eta * m.g_rho * 0.25 * math.pi * run.width * run.width
    vertical_force(z0, z1, cx, cy, sigma, k, lam, m.l if m.l > 0.0 else run.width, f[0])


@law.provide(law.strip_tangent, "m", RECORD)
@njit(cache=True)
def strip_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of `strip_force`; arguments as in `law.strip_tangent`."""
    vy = 0.5 * (v0y + v1y)
    sigma = direction(ey, vy, m)
    sigma_p, sigma_v = direction_slopes(ey, vy, m)
    eta, lam = (m.eta_plunge, m.lam_plunge) if sigma < 0.0 else (m.eta_withdraw, m.lam_withdraw)
    k = eta * m.g_rho * 0.25 * math.pi * run.width * run.width
    scale = m.l if m.l > 0.0 else run.width
    vertical_tangent(z0, z1, cx, cy, sigma, sigma_p, sigma_v, k, lam, scale, kp, kz, kv)


law.provide(law.drag_anchor, "m", RECORD)(component_return)
strips.line_law(RECORD, caps=False)
