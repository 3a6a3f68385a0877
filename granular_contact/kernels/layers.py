"""A law that acts between two depths only: strips are clipped at the boundaries of the layer.

The part of a strip between xi_a and xi_b is a strip of its own, whose end forces f' act at those points:

    f_0 = (1 - xi_a) f'_0 + (1 - xi_b) f'_1,        f_1 = xi_a f'_0 + xi_b f'_1.

Depths stay those below the free surface, so the pressure of what lies above is in them as if it were the same medium.
The clip points move with the end depths, which the tangent takes along exactly. The bristle is that of the whole strip.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from granular_contact.kernels import law


@njit(cache=True)
def inside(z0, z1, run):
    """Part (xi_a, xi_b) of a strip with end depths z0, z1 (m) that lies in the layer; (0, 0) when none does."""
    low, high = min(z0, z1), max(z0, z1)
    if high <= run.top or low >= run.bottom:
        return 0.0, 0.0
    a, b = 0.0, 1.0
    if low < run.top and run.top > 0.0:
        cut = (run.top - z0) / (z1 - z0)
        a, b = (cut, b) if z0 < z1 else (a, cut)
    if high > run.bottom:
        cut = (run.bottom - z0) / (z1 - z0)
        a, b = (a, cut) if z0 < z1 else (cut, b)
    return a, b


@njit(cache=True)
def clipped_force(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, f):
    """`law.strip_force` of the part (a, b) of a strip."""
    part = np.zeros_like(f)
    dz, dvx, dvy, share = z1 - z0, v1x - v0x, v1y - v0y, b - a
    law.strip_force(
        z0 + a * dz, z0 + b * dz, share * cx, share * cy,
        v0x + a * dvx, v0y + a * dvy, v0x + b * dvx, v0y + b * dvy, ex, ey, run, m, part,
    )  # fmt: skip
    for term in range(law.TERMS):
        for i in range(2):
            f[term, 0, i] += (1.0 - a) * part[term, 0, i] + (1.0 - b) * part[term, 1, i]
            f[term, 1, i] += a * part[term, 0, i] + b * part[term, 1, i]


@njit(cache=True)
def clipped_tangent(a, b, z0, z1, cx, cy, v0x, v0y, v1x, v1y, ex, ey, run, m, kp, kz, kv):
    """`law.strip_tangent` of the part (a, b) of a strip."""
    dz, dvx, dvy, share = z1 - z0, v1x - v0x, v1y - v0y, b - a
    z = np.array([z0 + a * dz, z0 + b * dz])
    v = np.array([v0x + a * dvx, v0y + a * dvy, v0x + b * dvx, v0y + b * dvy])
    part, pp, pz, pv = np.zeros((law.TERMS, 2, 2)), np.zeros((4, 4)), np.zeros((4, 2)), np.zeros((4, 4))
    c = (share * cx, share * cy)
    law.strip_force(z[0], z[1], c[0], c[1], v[0], v[1], v[2], v[3], ex, ey, run, m, part)
    law.strip_tangent(z[0], z[1], c[0], c[1], v[0], v[1], v[2], v[3], ex, ey, run, m, pp, pz, pv)
    # d(a, b) by the end depths; an end that is not clipped stays.
    moves = np.zeros((2, 2))
    for k, xi in ((0, a), (1, b)):
        if 0.0 < xi < 1.0:
            moves[k, 0], moves[k, 1] = -(1.0 - xi) / dz, -xi / dz
    weight = np.array([[1.0 - a, 1.0 - b], [a, b]])
    for i in range(2):
        for end in range(2):
            row = 2 * end + i
            for k in range(2):  # end forces of the part
                w, r = weight[end, k], 2 * k + i
                for j in range(2):
                    # pp by the ends of the part holds what comes from its chord and what comes from the bristle.
                    stretch, chord = pp[r, j] + pp[r, 2 + j], 0.5 * (pp[r, 2 + j] - pp[r, j])
                    kp[row, j] += w * (0.5 * stretch - share * chord)
                    kp[row, 2 + j] += w * (0.5 * stretch + share * chord)
                    kv[row, j] += w * ((1.0 - a) * pv[r, j] + (1.0 - b) * pv[r, 2 + j])
                    kv[row, 2 + j] += w * (a * pv[r, j] + b * pv[r, 2 + j])
                by_a = -(0.5 * (pp[r, 2] - pp[r, 0])) * cx - (0.5 * (pp[r, 3] - pp[r, 1])) * cy
                by_b = -by_a + pz[r, 1] * dz + pv[r, 2] * dvx + pv[r, 3] * dvy
                by_a += pz[r, 0] * dz + pv[r, 0] * dvx + pv[r, 1] * dvy
                for j in range(2):
                    kz[row, j] += w * (by_a * moves[0, j] + by_b * moves[1, j])
                kz[row, 0] += w * ((1.0 - a) * pz[r, 0] + (1.0 - b) * pz[r, 1])
                kz[row, 1] += w * (a * pz[r, 0] + b * pz[r, 1])
                force = part[0, k, i] + part[1, k, i] + part[2, k, i]
                for j in range(2):
                    kz[row, j] += (1.0 if end == 1 else -1.0) * force * moves[k, j]
