"""Exact depth integrals over the immersed part of a straight strip.

A strip runs from end 0 to end 1; its points are named by xi in [0, 1], and the depth below the surface varies linearly,
z(xi) = (1 - xi) z0 + xi z1, positive below. With N_0 = 1 - xi and N_1 = xi, the integrals

    J_e = int z^lam N_e dxi        over a part of the strip with z > 0

turn a force density proportional to z^lam into forces at the two ends. They are closed forms, so the point where the
strip crosses the surface costs no accuracy. lam = 1, which most laws have, needs no power.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

GAUSS_LOW = 0.5 - 0.5 / math.sqrt(3.0)
GAUSS_HIGH = 0.5 + 0.5 / math.sqrt(3.0)

# Below this relative difference of the end depths the closed forms cancel (to 1e-12), and three Gauss points are as
# accurate.
LEVEL = 0.01
TINY = 1e-90  # its third power does not underflow
FAR = 0.5 * math.sqrt(0.6)  # of the outer points from the middle; weights 5/18, 8/18, 5/18
THREE_POINTS = ((0.5 - FAR, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + FAR, 5.0 / 18.0))


@part
def immersed_interval(z0: float, z1: float) -> tuple[float, float]:
    """Part (a, b) of a strip with end depths z0, z1 (m) that lies below the surface; (0, 0) if there is none."""
    if z0 <= 0.0 and z1 <= 0.0:
        return 0.0, 0.0
    crossing = z0 / (z0 - z1) if z0 != z1 else 0.0
    return (crossing if z0 < 0.0 else 0.0), (crossing if z1 < 0.0 else 1.0)


@part
def inside(z0, z1, line):
    """Part (a, b) of a strip with end depths z0, z1 (m) that lies in the medium; (0, 0) if there is none.

    Strips are cut at the boundaries of a layer. Depths count from the free surface, so they include the pressure of the
    layers above as if these were the same medium.
    """
    if not line.layered:
        return immersed_interval(z0, z1)
    low, high = min(z0, z1), max(z0, z1)
    if high <= line.top or low >= line.bottom or high <= 0.0:
        return 0.0, 0.0
    a, b = 0.0, 1.0
    if low < line.top:
        cut = (line.top - z0) / (z1 - z0)
        a, b = (cut, b) if z0 < z1 else (a, cut)
    if high > line.bottom:
        cut = (line.bottom - z0) / (z1 - z0)
        a, b = (a, cut) if z0 < z1 else (cut, b)
    return a, b


@part
def part_integrals(a, b, z0, z1, lam):
    """Integrals J_0, J_1 of z^lam N_e (m^lam) over the part of a strip from a to b, which lies below the surface."""
    dz = z1 - z0
    j0, j1, _ = moments(max(0.0, z0 + a * dz), max(0.0, z0 + b * dz), lam)
    return (b - a) * ((1.0 - a) * j0 + (1.0 - b) * j1), (b - a) * (a * j0 + b * j1)


@part
def moments(z0, z1, lam):
    """Integrals of z^lam times 1 - xi, xi and xi^2 over a strip that is immersed from end to end, z0, z1 >= 0 (m^lam).

    All three share the powers, which take most of the time.
    """
    dz = z1 - z0
    if lam == 1.0:
        return z0 / 3.0 + z1 / 6.0, z0 / 6.0 + z1 / 3.0, z0 / 3.0 + dz / 4.0
    if abs(dz) <= LEVEL * (z0 + z1) or abs(dz) < TINY:
        j0, j1, k11 = 0.0, 0.0, 0.0
        for at, weight in THREE_POINTS:
            power = weight * (z0 + at * dz) ** lam
            j0 += (1.0 - at) * power
            j1 += at * power
            k11 += at * at * power
        return j0, j1, k11
    p0, p1 = z0 ** (lam + 1.0), z1 ** (lam + 1.0)
    i0, i1, i2 = (p1 - p0) / (lam + 1.0), (p1 * z1 - p0 * z0) / (lam + 2.0), (p1 * z1**2 - p0 * z0**2) / (lam + 3.0)
    j1 = (p1 - i1 / dz) / ((lam + 1.0) * dz)
    return i0 / dz - j1, j1, (i2 - 2.0 * z0 * i1 + z0 * z0 * i0) / dz**3


@part
def sign_change(a, b, w0, w1):
    """Position in [a, b] at which a quantity linear from w0 to w1 along the strip changes its sign; b if none."""
    c = w0 / (w0 - w1) if w0 * w1 < 0.0 else b
    return min(b, max(a, c))
