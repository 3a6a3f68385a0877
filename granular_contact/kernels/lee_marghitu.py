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
from granular_contact.kernels.bar_statics import (
    component_return,
    horizontal_force,
    horizontal_tangent,
    vertical_force,
    vertical_tangent,
)
from granular_contact.kernels.friction import direction, direction_slopes
from granular_contact.kernels.immersion import GAUSS_HIGH, GAUSS_LOW, kinked_interval

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
def strip_force(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """Add the three force terms at the two ends of a strip to f[term, end, component] (N).

    Arguments as in `law.strip_force`; run.width is the diameter d.
    """
    d = run.width
    if m.eta_d != 0.0:
        a, c, b = kinked_interval(z0, z1, cx * v0y - cy * v0x, cx * v1y - cy * v1x)
        for start, end in ((a, c), (c, b)):
            k = m.eta_d * m.rho * d * 0.5 * (end - start)
            if k == 0.0:
                continue
            for gauss in (GAUSS_LOW, GAUSS_HIGH):
                xi = start + (end - start) * gauss
                vx = (1.0 - xi) * v0x + xi * v1x
                vy = (1.0 - xi) * v0y + xi * v1y
                kw = k * abs(cx * vy - cy * vx)
                f[DRAG, 0, 0] -= (1.0 - xi) * kw * vx
                f[DRAG, 0, 1] -= (1.0 - xi) * kw * vy
                f[DRAG, 1, 0] -= xi * kw * vx
                f[DRAG, 1, 1] -= xi * kw * vy
    if m.eta_h != 0.0:
        horizontal_force(z0, z1, cy, v0x, v1x, ex, m.eta_h * m.g * m.rho * d, m, f[HORIZONTAL])
    sigma = direction(ey, 0.5 * (v0y + v1y), m)
    eta, lam = (m.eta_plunge, m.lam_plunge) if sigma < 0.0 else (m.eta_withdraw, m.lam_withdraw)
    if eta != 0.0:
        vertical_force(z0, z1, cx, cy, sigma, eta * m.g * m.rho * 0.25 * math.pi * d * d, lam, d, f[VERTICAL])


@law.provide(law.strip_tangent, "m", RECORD)
@njit(cache=True)
def strip_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """Add the derivatives of `strip_force` to kp, kz and kv; arguments as in `law.strip_tangent`."""
    d = run.width
    if m.eta_d != 0.0:
        _drag_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, d, m, kp, kz, kv)
    if m.eta_h != 0.0:
        horizontal_tangent(z0, z1, cy, v0x, v1x, ex, m.eta_h * m.g * m.rho * d, m, kp, kz, kv)
    vy = 0.5 * (v0y + v1y)
    sigma = direction(ey, vy, m)
    eta, lam = (m.eta_plunge, m.lam_plunge) if sigma < 0.0 else (m.eta_withdraw, m.lam_withdraw)
    if eta != 0.0:
        sigma_p, sigma_v = direction_slopes(ey, vy, m)
        k = eta * m.g * m.rho * 0.25 * math.pi * d * d
        vertical_tangent(z0, z1, cx, cy, sigma, sigma_p, sigma_v, k, lam, d, kp, kz, kv)


@njit(cache=True)
def _drag_tangent(z0, z1, cx, cy, v0x, v0y, v1x, v1y, d, m, kp, kz, kv):
    """Add the derivatives of the drag term to kp, kz, kv."""
    a, c, b = kinked_interval(z0, z1, cx * v0y - cy * v0x, cx * v1y - cy * v1x)
    k = m.eta_d * m.rho * d
    for start, end in ((a, c), (c, b)):
        if start == end:
            continue
        for gauss in (GAUSS_LOW, GAUSS_HIGH):
            xi = start + (end - start) * gauss
            vx = (1.0 - xi) * v0x + xi * v1x
            vy = (1.0 - xi) * v0y + xi * v1y
            w = cx * vy - cy * vx
            kq = 0.5 * (end - start) * k
            s = math.copysign(1.0, w)
            for row, n_e in ((0, 1.0 - xi), (2, xi)):
                ke = kq * n_e
                for i, v_i in ((0, vx), (1, vy)):
                    r = row + i
                    # c = p_1 - p_0 and dw/dc = (vy, -vx)
                    kp[r, 0] += ke * s * v_i * vy
                    kp[r, 1] -= ke * s * v_i * vx
                    kp[r, 2] -= ke * s * v_i * vy
                    kp[r, 3] += ke * s * v_i * vx
                    for col, n_f in ((0, 1.0 - xi), (2, xi)):
                        # dw/dv = (-cy, cx)
                        kv[r, col] += ke * n_f * s * v_i * cy
                        kv[r, col + 1] -= ke * n_f * s * v_i * cx
                        kv[r, col + i] -= ke * n_f * abs(w)
    if (z0 < 0.0) == (z1 < 0.0):
        return
    # The crossing point xi* = z0 / (z0 - z1) moves with the end depths, and the drag does not vanish there.
    dz = z1 - z0
    xi = -z0 / dz
    vx = (1.0 - xi) * v0x + xi * v1x
    vy = (1.0 - xi) * v0y + xi * v1y
    edge = k * abs(cx * vy - cy * vx) * (1.0 if z1 < 0.0 else -1.0)
    xi_z0 = -z1 / dz / dz  # the square of a small number may be none
    xi_z1 = z0 / dz / dz
    for row, n_e in ((0, 1.0 - xi), (2, xi)):
        for i, v_i in ((0, vx), (1, vy)):
            kz[row + i, 0] -= edge * n_e * v_i * xi_z0
            kz[row + i, 1] -= edge * n_e * v_i * xi_z1


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


@law.provide(law.cap_tangent, "m", RECORD)
@njit(cache=True)
def cap_tangent(cx, cy, vx, vy, run, m, kp, kv):
    """Add the derivatives of `cap_force` to kp, kv (4, 4)."""
    d, length = run.width, math.hypot(cx, cy)
    if length == 0.0:
        return
    tx, ty = cx / length, cy / length
    w = tx * vx + ty * vy
    k = m.eta_d * m.rho * 0.25 * math.pi * d * d
    s = k * math.copysign(1.0, w)
    for row, v_i in ((2, vx), (3, vy)):
        # dw/dc = (v - w t) / |c|
        kp[row, 0] += s * v_i * (vx - w * tx) / length
        kp[row, 1] += s * v_i * (vy - w * ty) / length
        kp[row, 2] -= s * v_i * (vx - w * tx) / length
        kp[row, 3] -= s * v_i * (vy - w * ty) / length
        kv[row, 2] -= s * v_i * tx
        kv[row, 3] -= s * v_i * ty
        kv[row, row] -= k * abs(w)


law.provide(law.drag_anchor, "m", RECORD)(component_return)
strips.line_law(RECORD)
