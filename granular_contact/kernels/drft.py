"""Dynamic resistive force theory (Agarwal et al. 2021): the stress of `rft`, and the inertia of the grains pushed away.

    traction = z S(t, u) - lam rho v_n |v_n| n

with the true velocity v and its part v_n normal to the element; on a one-sided outline only where n . v > 0. The free
surface may be lowered by delta_h. With w = t x v = v_n and n = (-t_y, t_x), the inertial term of a straight strip is a
cubic in xi on either side of the zero of w, which two Gauss points integrate exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from granular_contact.kernels import law, plates, rft, strips
from granular_contact.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, immersed_interval, sign_change
from granular_contact.kernels.planar_friction import radial_return

INERTIAL = 1
TERMS = ("static", "inertial")
# Its own fields first: where one record begins with all fields of another, numba takes the one for the other.
RECORD = np.dtype([("lam_rho", "f8"), ("delta_h", "f8"), *rft.RECORD.descr])


@njit(cache=True)
def strip_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f):
    """Add the static and the inertial term; arguments as in `law.strip_force`."""
    z0, z1 = z0 - m.delta_h, z1 - m.delta_h
    low, high = immersed_interval(z0, z1)
    a, b = max(a, low), min(b, high)
    length = math.hypot(cx, cy)
    if a >= b or length == 0.0:
        return
    plates.static_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, e0x, e0y, e1x, e1y, run, m, f)
    tx, ty = cx / length, cy / length
    t0x, t0y = plates.tangent_at(tx, ty, run.turn, 0.0)
    t1x, t1y = plates.tangent_at(tx, ty, run.turn, 1.0)
    c = sign_change(a, b, t0x * v0y - t0y * v0x, t1x * v1y - t1y * v1x)
    k = m.lam_rho * run.width * length
    for start, end in ((a, c), (c, b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            sx, sy = plates.tangent_at(tx, ty, run.turn, xi)
            w = sx * ((1.0 - xi) * v0y + xi * v1y) - sy * ((1.0 - xi) * v0x + xi * v1x)
            if run.side * w < 0.0:
                continue
            density = 0.5 * (end - start) * k * w * abs(w)
            f[INERTIAL, 0, 0] += (1.0 - xi) * density * sy
            f[INERTIAL, 0, 1] -= (1.0 - xi) * density * sx
            f[INERTIAL, 1, 0] += xi * density * sy
            f[INERTIAL, 1, 1] -= xi * density * sx


law.provide(plates.stress, "m", RECORD)(rft.stress)
law.provide(law.strip_force, "m", RECORD)(strip_force)
law.provide(law.drag_anchor, "m", RECORD)(radial_return)
strips.line_law(RECORD, caps=False)
