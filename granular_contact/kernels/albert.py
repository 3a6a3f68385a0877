"""Horizontal resistance of a vertical cylinder (Albert et al. 1999), spread along a thin bar.

    F = eta_h g rho_g H^2 d        against the horizontal motion of a cylinder immersed to the depth H

The density 2 eta_h g rho_g d z |t_y| per unit of arc length [ours] integrates to it over a straight bar at any slope
that pierces the surface. There is no vertical force and no drag.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels import law, strips
from granular_contact.kernels.bar_statics import component_return, horizontal_force

TERMS = ("horizontal_static",)
RECORD = np.dtype(
    [("eta_h_g_rho", "f8"), ("friction", "i8"), ("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8")]  # N/m^3 and constants
)


@law.provide(law.strip_force, "m", RECORD)
@njit(cache=True)
def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the horizontal term; arguments as in `law.strip_force`."""
    horizontal_force(a, b, z0, z1, cy, v0x, v1x, e0x, e1x, m.eta_h_g_rho * run.width, m, f[0])


law.provide(law.drag_anchor, "m", RECORD)(component_return)
strips.line_law(RECORD, caps=False)
