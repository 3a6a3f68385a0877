"""Exact depth integrals over the immersed part of a straight strip.

A strip runs from end 0 to end 1; its points are named by xi in [0, 1], and the depth below the surface varies linearly,
z(xi) = (1 - xi) z0 + xi z1, positive below. With N_0 = 1 - xi and N_1 = xi, the integrals

    J_e = int z^lam N_e dxi        over the part of the strip with z > 0

are what turns a force density proportional to z^lam into forces at the two ends. They are closed forms, so the point
where the strip crosses the surface costs no accuracy. lam = 1, which most laws have, needs no power.
"""

from __future__ import annotations

import math

from numba import njit

GAUSS_LOW = 0.5 - 0.5 / math.sqrt(3.0)
GAUSS_HIGH = 0.5 + 0.5 / math.sqrt(3.0)

# Below this relative difference of the end depths the closed forms cancel (to 1e-12, their gradients to 1e-10), and
# three Gauss points are as accurate.
LEVEL = 0.01
FAR = 0.5 * math.sqrt(0.6)  # of the outer two from the middle; weights 5/18, 8/18, 5/18


@njit(cache=True)
def immersed_interval(z0: float, z1: float) -> tuple[float, float]:
    """Part (a, b) of a strip with end depths z0, z1 (m) that lies below the surface; (0, 0) when none does."""
    if z0 <= 0.0 and z1 <= 0.0:
        return 0.0, 0.0
    crossing = z0 / (z0 - z1) if z0 != z1 else 0.0
    return (crossing if z0 < 0.0 else 0.0), (crossing if z1 < 0.0 else 1.0)


@njit(cache=True)
def depth_integrals(z0: float, z1: float, lam: float) -> tuple[float, float]:
    """Integrals J_0, J_1 of z^lam N_e over the immersed part (m^lam); end depths z0, z1 (m), exponent lam >= 0."""
    if z0 > z1:
        j1, j0 = depth_integrals_rising(z1, z0, lam)
        return j0, j1
    return depth_integrals_rising(z0, z1, lam)


@njit(cache=True)
def depth_integrals_rising(z0: float, z1: float, lam: float) -> tuple[float, float]:
    """`depth_integrals` for z0 <= z1."""
    if z1 <= 0.0:
        return 0.0, 0.0
    if z0 <= 0.0:
        beta = z1 / (z1 - z0)  # immersed fraction
        p = z1 if lam == 1.0 else z1**lam
        total = beta * p / (lam + 1.0)
        j1 = beta * p * ((1.0 - beta) / (lam + 1.0) + beta / (lam + 2.0))
        return total - j1, j1
    if lam == 1.0:
        return z0 / 3.0 + z1 / 6.0, z0 / 6.0 + z1 / 3.0
    dz = z1 - z0
    if dz <= LEVEL * (z0 + z1):
        middle = 0.5 * (z0 + z1)
        low, high = 5.0 / 18.0 * (middle - FAR * dz) ** lam, 5.0 / 18.0 * (middle + FAR * dz) ** lam
        half = 0.5 * (low + 8.0 / 18.0 * middle**lam + high)
        return half - FAR * (high - low), half + FAR * (high - low)
    p0 = z0 ** (lam + 1.0)
    p1 = z1 ** (lam + 1.0)
    total = (p1 - p0) / ((lam + 1.0) * dz)
    j1 = (p1 - (p1 * z1 - p0 * z0) / ((lam + 2.0) * dz)) / ((lam + 1.0) * dz)
    return total - j1, j1


@njit(cache=True)
def depth_integral_gradients(z0: float, z1: float, lam: float) -> tuple[float, float, float, float]:
    """Derivatives dJ_0/dz0, dJ_0/dz1, dJ_1/dz0, dJ_1/dz1 of `depth_integrals` (m^(lam-1))."""
    if z0 > z1:
        g00, g01, g10, g11 = depth_integral_gradients_rising(z1, z0, lam)
        return g11, g10, g01, g00
    return depth_integral_gradients_rising(z0, z1, lam)


@njit(cache=True)
def depth_integral_gradients_rising(z0: float, z1: float, lam: float) -> tuple[float, float, float, float]:
    """`depth_integral_gradients` for z0 <= z1."""
    if z1 <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    dz = z1 - z0
    if z0 <= 0.0:
        beta = z1 / dz
        p = z1 if lam == 1.0 else z1**lam
        beta_z0 = beta / dz
        beta_z1 = -z0 / dz / dz
        p_z1 = lam * p / z1
        total_beta = p / (lam + 1.0)
        total_p = beta / (lam + 1.0)
        j1_beta = p * ((1.0 - 2.0 * beta) / (lam + 1.0) + 2.0 * beta / (lam + 2.0))
        j1_p = beta * ((1.0 - beta) / (lam + 1.0) + beta / (lam + 2.0))
        g10 = j1_beta * beta_z0
        g11 = j1_beta * beta_z1 + j1_p * p_z1
        return total_beta * beta_z0 - g10, total_beta * beta_z1 + total_p * p_z1 - g11, g10, g11
    if lam == 1.0:
        return 1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0
    if dz <= LEVEL * (z0 + z1):
        middle = 0.5 * (z0 + z1)
        k = 5.0 / 18.0 * lam
        low, high = k * (middle - FAR * dz) ** (lam - 1.0), k * (middle + FAR * dz) ** (lam - 1.0)
        quarter = 0.25 * 8.0 / 18.0 * lam * middle ** (lam - 1.0)
        g01 = (low + high) * (0.25 - FAR * FAR) + quarter
        g00 = low * (0.5 + FAR) ** 2 + high * (0.5 - FAR) ** 2 + quarter
        g11 = low * (0.5 - FAR) ** 2 + high * (0.5 + FAR) ** 2 + quarter
        return g00, g01, g01, g11
    j0, j1 = depth_integrals_rising(z0, z1, lam)
    total = j0 + j1
    g10 = (2.0 * j1 - total) / dz
    g11 = (z1**lam - 2.0 * j1) / dz
    return (total - z0**lam) / dz - g10, (z1**lam - total) / dz - g11, g10, g11


@njit(cache=True)
def pressure_integrals(z0: float, z1: float) -> tuple[float, float]:
    """`depth_integrals` for lam = 1 (m), where they are plain polynomials."""
    if z0 >= 0.0 and z1 >= 0.0:
        return (2.0 * z0 + z1) / 6.0, (z0 + 2.0 * z1) / 6.0
    if z0 <= 0.0 and z1 <= 0.0:
        return 0.0, 0.0
    deep, beta = (z1, z1 / (z1 - z0)) if z1 > 0.0 else (z0, z0 / (z0 - z1))  # beta: immersed fraction
    far = deep * beta * beta / 6.0  # at the end above the surface
    near = 0.5 * deep * beta - far
    return (far, near) if z1 > 0.0 else (near, far)


@njit(cache=True)
def pressure_integral_gradients(z0: float, z1: float) -> tuple[float, float, float, float]:
    """`depth_integral_gradients` for lam = 1 (-)."""
    if z0 >= 0.0 and z1 >= 0.0:
        return 1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0
    if z0 <= 0.0 and z1 <= 0.0:
        return 0.0, 0.0, 0.0, 0.0
    beta = z1 / (z1 - z0) if z1 > 0.0 else z0 / (z0 - z1)
    # far = z^3 / (6 dz^2) and near = z^2 / (2 dz) - far, with the deep end's z and dz = z - z_dry.
    far_deep = beta * beta * (0.5 - beta / 3.0)
    far_dry = beta**3 / 3.0
    near_deep = beta - 0.5 * beta * beta - far_deep
    near_dry = 0.5 * beta * beta - far_dry
    if z1 > 0.0:
        return far_dry, far_deep, near_dry, near_deep
    return near_deep, near_dry, far_deep, far_dry


@njit(cache=True)
def kinked_interval(z0: float, z1: float, w0: float, w1: float) -> tuple[float, float, float]:
    """Immersed part (a, b) of a strip and the point c in it where w changes its sign (c = b when it does not).

    z0, z1 end depths (m); w0, w1 values at the ends of what varies linearly along the strip.
    """
    a, b = immersed_interval(z0, z1)
    c = w0 / (w0 - w1) if w0 * w1 < 0.0 else b
    return a, min(b, max(a, c)), b
