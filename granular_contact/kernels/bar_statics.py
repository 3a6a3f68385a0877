"""Static resistance of a round bar along its axis, by components; what several laws are made of.

With depth z, unit tangent t, and the regularised signs sigma of `friction`, per unit of arc length:

    dF_x/ds = -2 k z |t_y| sigma_x                       over a bar that pierces the surface: -k z_T^2 sigma_x
    dF_y/ds = -(lam + 1) k (z/l)^lam sigma_y             likewise: -k (z_T/l)^lam L_i sigma_y

A strip has c = p_1 - p_0, so that |t_y| ds = |c_y| dxi and ds = |c| dxi.
"""

from __future__ import annotations

import math

from numba import njit

from granular_contact.kernels.friction import direction, direction_slopes, drag_component
from granular_contact.kernels.immersion import (
    depth_integral_gradients,
    depth_integrals,
    pressure_integral_gradients,
    pressure_integrals,
)


@njit(cache=True)
def horizontal_force(z0, z1, cy, v0x, v1x, ex, k, m, f):
    """Add the horizontal term to f[end, xy] (N); k in N/m^2, other arguments as in `law.strip_force`."""
    j0, j1 = pressure_integrals(z0, z1)
    k *= 2.0 * abs(cy) * direction(ex, 0.5 * (v0x + v1x), m)
    f[0, 0] -= k * j0
    f[1, 0] -= k * j1


@njit(cache=True)
def horizontal_tangent(z0, z1, cy, v0x, v1x, ex, k, m, kp, kz, kv):
    """Add the derivatives of `horizontal_force`."""
    vx = 0.5 * (v0x + v1x)
    sigma = direction(ex, vx, m)
    sigma_p, sigma_v = direction_slopes(ex, vx, m)
    j0, j1 = pressure_integrals(z0, z1)
    g00, g01, g10, g11 = pressure_integral_gradients(z0, z1)
    k *= 2.0
    kcy = k * math.copysign(1.0, cy) * sigma
    k *= abs(cy)
    for row, j, gz0, gz1 in ((0, j0, g00, g01), (2, j1, g10, g11)):
        kp[row, 0] -= 0.5 * k * sigma_p * j
        kp[row, 2] -= 0.5 * k * sigma_p * j
        kv[row, 0] -= 0.5 * k * sigma_v * j
        kv[row, 2] -= 0.5 * k * sigma_v * j
        kp[row, 1] += kcy * j
        kp[row, 3] -= kcy * j
        kz[row, 0] -= k * sigma * gz0
        kz[row, 1] -= k * sigma * gz1


@njit(cache=True)
def vertical_force(z0, z1, cx, cy, sigma, k, lam, scale, f):
    """Add the vertical term to f[end, xy] (N); sigma direction, k in N/m, scale the length l (m)."""
    j0, j1 = depth_integrals(z0 / scale, z1 / scale, lam)
    k *= (lam + 1.0) * math.hypot(cx, cy) * sigma
    f[0, 1] -= k * j0
    f[1, 1] -= k * j1


@njit(cache=True)
def vertical_tangent(z0, z1, cx, cy, sigma, sigma_p, sigma_v, k, lam, scale, kp, kz, kv):
    """Add the derivatives of `vertical_force`; sigma_p, sigma_v those of sigma by place and velocity of mid-strip."""
    j0, j1 = depth_integrals(z0 / scale, z1 / scale, lam)
    g00, g01, g10, g11 = depth_integral_gradients(z0 / scale, z1 / scale, lam)
    length = math.hypot(cx, cy)
    if length == 0.0:
        return
    tx, ty = cx / length, cy / length
    k *= lam + 1.0
    for row, j, gz0, gz1 in ((1, j0, g00, g01), (3, j1, g10, g11)):
        stretch = k * sigma * j
        kp[row, 0] += stretch * tx
        kp[row, 2] -= stretch * tx
        kp[row, 1] += stretch * ty - 0.5 * k * length * sigma_p * j
        kp[row, 3] += -stretch * ty - 0.5 * k * length * sigma_p * j
        kz[row, 0] -= k * length * sigma * gz0 / scale
        kz[row, 1] -= k * length * sigma * gz1 / scale
        kv[row, 1] -= 0.5 * k * length * sigma_v * j
        kv[row, 3] -= 0.5 * k * length * sigma_v * j


@njit(cache=True)
def component_return(px, py, ax, ay, m):
    """Anchor after an accepted step: each component within u_y of the strip."""
    return drag_component(px, ax, m), drag_component(py, ay, m)
