"""Dynamic resistive force theory (Agarwal et al. 2021): the stress of `rft`, and the inertia of the grains pushed away.

    traction = z S(t, u) - lam rho v_n |v_n| n

with the true velocity v and its part v_n normal to the element; on a one-sided outline only where n . v > 0. The free
surface may be lowered by delta_h. With c = p_1 - p_0, t = c / |c| and w = t x v = v_n, n ds = (-c_y, c_x) dxi, so
that on either side of the zero of w the inertial term is a cubic in xi, which two Gauss points integrate exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from granular_contact.kernels import law, plates, rft, strips
from granular_contact.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, kinked_interval
from granular_contact.kernels.planar_friction import radial_return

INERTIAL = 1
TERMS = ("static", "inertial")
# Its own fields first: where one record begins with all fields of another, numba takes the one for the other.
RECORD = np.dtype([("lam_rho", "f8"), ("delta_h", "f8"), *rft.RECORD.descr])


@njit(cache=True)
def strip_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """Add the static and the inertial term; arguments as in `law.strip_force`."""
    z0, z1 = z0 - m.delta_h, z1 - m.delta_h
    if z0 <= 0.0 and z1 <= 0.0:
        return
    plates.static_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f)
    length = math.hypot(cx, cy)
    if length == 0.0:
        return
    tx, ty = cx / length, cy / length
    w0, w1 = tx * v0y - ty * v0x, tx * v1y - ty * v1x
    a, c, b = kinked_interval(z0, z1, w0, w1)
    k = m.lam_rho * run.width
    d0, d1 = 0.0, 0.0
    for start, end in ((a, c), (c, b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            w = (1.0 - xi) * w0 + xi * w1
            if run.side * w < 0.0:
                continue
            density = 0.5 * (end - start) * w * abs(w)
            d0 += (1.0 - xi) * density
            d1 += xi * density
    f[INERTIAL, 0, 0] += k * d0 * cy
    f[INERTIAL, 0, 1] -= k * d0 * cx
    f[INERTIAL, 1, 0] += k * d1 * cy
    f[INERTIAL, 1, 1] -= k * d1 * cx


@njit(cache=True)
def strip_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of `strip_force`; arguments as in `law.strip_tangent`."""
    z0, z1 = z0 - m.delta_h, z1 - m.delta_h
    if z0 <= 0.0 and z1 <= 0.0:
        return
    plates.static_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv)
    inertial_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, run, m, kp, kz, kv)


@njit(cache=True)
def inertial_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, run, m, kp, kz, kv):
    """Add the derivatives of the inertial term."""
    length = math.hypot(cx, cy)
    if length == 0.0:
        return
    tx, ty = cx / length, cy / length
    w0, w1 = tx * v0y - ty * v0x, tx * v1y - ty * v1x
    a, c, b = kinked_interval(z0, z1, w0, w1)
    k = m.lam_rho * run.width
    for start, end in ((a, c), (c, b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            vx, vy = (1.0 - xi) * v0x + xi * v1x, (1.0 - xi) * v0y + xi * v1y
            w = tx * vy - ty * vx
            if run.side * w < 0.0:
                continue
            d = 0.5 * (end - start) * k * w * abs(w)
            d_w = (end - start) * k * abs(w)
            for row, n_e in ((0, 1.0 - xi), (2, xi)):
                # f = d (cy, -cx) with d ~ w |w| and |c| dw/dc = (vy, -vx) - w t
                by_cx, by_cy = d_w * vy - 2.0 * d * tx, -d_w * vx - 2.0 * d * ty
                for i, lever, lever_cx, lever_cy in ((0, ty, 0.0, d), (1, -tx, -d, 0.0)):
                    r = row + i
                    kx, ky = n_e * (by_cx * lever + lever_cx), n_e * (by_cy * lever + lever_cy)
                    kp[r, 0] -= kx
                    kp[r, 1] -= ky
                    kp[r, 2] += kx
                    kp[r, 3] += ky
                    for col, n_f in ((0, 1.0 - xi), (2, xi)):
                        # |c| dw/dv = (-cy, cx)
                        kv[r, col] -= n_e * n_f * d_w * cy * lever
                        kv[r, col + 1] += n_e * n_f * d_w * cx * lever
    if (z0 < 0.0) == (z1 < 0.0):
        return
    # The crossing xi* = z0 / (z0 - z1) moves with the end depths, and the term does not vanish there.
    dz = z1 - z0
    xi = -z0 / dz
    w = (1.0 - xi) * w0 + xi * w1
    if run.side * w < 0.0:
        return
    edge = k * w * abs(w) * (1.0 if z1 < 0.0 else -1.0)
    xi_z0, xi_z1 = -z1 / dz / dz, z0 / dz / dz
    for row, n_e in ((0, 1.0 - xi), (2, xi)):
        for i, lever in ((0, cy), (1, -cx)):
            kz[row + i, 0] += edge * n_e * lever * xi_z0
            kz[row + i, 1] += edge * n_e * lever * xi_z1


law.provide(plates.stress, "m", RECORD)(rft.stress)
law.provide(plates.stress_slopes, "m", RECORD)(rft.stress_slopes)
law.provide(law.strip_force, "m", RECORD)(strip_force)
law.provide(law.strip_tangent, "m", RECORD)(strip_tangent)
law.provide(law.drag_anchor, "m", RECORD)(radial_return)
strips.line_law(RECORD, caps=False)
