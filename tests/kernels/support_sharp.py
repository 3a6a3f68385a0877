"""The laws of a surface element once more, with the true sign and a sharp leading edge, by a midpoint rule.

Nothing here comes from the laws but the stress of rft3d, whose published states have a test of their own.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from support_laws import TRUE_SIGN, Array, G, published_rft

from granular_contact.laws import rft3d

published_stress = njit(cache=True)(rft3d.Rft3d.stress)


@njit(cache=True)
def stresses(t: Array, u: Array, record: Any) -> Array:
    """Published stresses (n, 2) N/m3 on many elements."""
    out = np.empty_like(t)
    for i in range(len(t)):
        out[i, 0], out[i, 1] = published_stress((t[i, 0], t[i, 1]), (u[i, 0], u[i, 1]), record)
    return out


def stress(medium: Any, t: Array, u: Array) -> Array:
    """Stress per depth (n, 2) N/m3 on elements along t that move in the directions u, unit vectors (n, 2)."""
    if medium.name == "rft3d":
        record = medium.record(TRUE_SIGN, G)[0]
        return stresses(t, u, record)
    # The printed series holds for motion to the right, and for tangents to the right: the rest by symmetry.
    way = np.where(u[:, 0] < 0.0, -1.0, 1.0)
    beta = np.arctan2(t[:, 1] * np.where(way * t[:, 0] < 0.0, -1.0, 1.0), np.abs(t[:, 0]))
    gamma = np.arctan2(-u[:, 1], way * u[:, 0])
    alpha_x, alpha_z = published_rft(medium.coefficients, np.degrees(beta), np.degrees(gamma))
    return 1e6 * medium.zeta * np.column_stack([-way * alpha_x, alpha_z])


def cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def force(medium: Any, p: Array, t: Array, v: Array, area: Array, side: int) -> tuple[Array, Array]:
    """Force x, y and moment about the origin on elements at p, surface at y = 0, and sums of their magnitudes.

    area (n,) m2; side as of a run: 0 for a plate, +1 or -1 where the outward normal is to the left or right of t. The
    magnitudes, (3,) too, are those of a plate, both of whose faces can lead: all that could be loaded.
    """
    speed = np.linalg.norm(v, axis=1)
    w = cross(t, v)
    f = stress(medium, t, v / speed[:, None])
    f *= (np.maximum(0.0, -p[:, 1]) * area)[:, None]
    if medium.name == "drft":
        f += (medium.lam * medium.density * area * w * np.abs(w) * (p[:, 1] < 0.0))[:, None] * np.column_stack(
            [t[:, 1], -t[:, 0]]
        )
    magnitude = np.linalg.norm(f, axis=1)
    size = np.array([magnitude.sum(), magnitude.sum(), np.linalg.norm(p, axis=1) @ magnitude])
    if side:
        f[side * w <= 0.0] = 0.0
    return np.array([*f.sum(axis=0), cross(p, f).sum()]), size
