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
from granular_contact.kernels.bar_statics import component_return, vertical_force

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
def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the vertical term; arguments as in `law.strip_force`."""
    eta, lam = (m.eta_plunge, m.eta_withdraw), (m.lam_plunge, m.lam_withdraw)
    k = m.g_rho * 0.25 * math.pi * run.width * run.width
    scale = m.l if m.l > 0.0 else run.width
    vertical_force(a, b, z0, z1, cx, cy, v0y, v1y, e0y, e1y, k, eta, lam, scale, m, f[0])


law.provide(law.drag_anchor, "m", RECORD)(component_return)
strips.line_law(RECORD, caps=False)
