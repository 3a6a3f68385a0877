"""The bristle of `planar_friction` in space: direction of the static resistance, and where anchors go.

Stretch, velocity and direction have three components; all equations are those of the plane, where the third is zero.
A law that opposes the components of the motion one by one has two bristles in space: one in the horizontal plane, by
radial return, and one along the vertical.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.friction import SMOOTH, drag_component, sliding
from granular_contact.sand.kernels.planar_friction import radial_return

TINY = 1e-300  # so that nothing is divided by zero where nothing is stretched, or at rest


@part
def drive(ex, ey, ez, vx, vy, vz, m):
    """Vector q (3,) as in `planar_friction.drive`: p - anchor e (m), velocity v (m/s); and the factor of v in it."""
    if m.friction == SMOOTH:
        return vx, vy, vz, 1.0
    return stretched(ex, ey, ez, vx, vy, vz, m)


@part(inline=True)
def stretched(ex, ey, ez, vx, vy, vz, m):
    """`drive` of a bristle, without a branch, so that compilers make one of several of them at once."""
    h, square = math.sqrt(ex * ex + ey * ey + ez * ez), vx * vx + vy * vy + vz * vz
    along = ex * vx + ey * vy + ez * vz
    k = m.u_y / h if h > m.u_y else 1.0
    slides = max(0.0, along) / max(TINY, h * math.sqrt(square))  # cosine
    yields = sliding(min(h, m.u_y), m) - m.tau
    tau = m.tau + (slides * yields if along > 0.0 and h > 0.5 * m.u_y and square > 0.0 else 0.0)
    return k * ex + tau * vx, k * ey + tau * vy, k * ez + tau * vz, tau


@part
def mobilised(qx, qy, qz, m):
    """Direction u (3,) and mobilised share s in [0, 1] of a vector q as in `drive`, and 1 / |q|; medium record m."""
    h = math.sqrt(qx * qx + qy * qy + qz * qz)
    if h == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    one = 1.0 / h
    share = math.tanh(h / m.v_eps) if m.friction == SMOOTH else min(1.0, h / m.u_y)
    return one * qx, one * qy, one * qz, share, one


@part
def whole_return(px, py, pz, ax, ay, az, m):
    """Anchor after an accepted step that ended at p: on the line to p, within u_y of it (m)."""
    ex, ey, ez = px - ax, py - ay, pz - az
    h = math.sqrt(ex * ex + ey * ey + ez * ez)
    if h <= m.u_y:
        return ax, ay, az
    k = m.u_y / h
    return px - k * ex, py - k * ey, pz - k * ez


@part
def parted_return(px, py, pz, ax, ay, az, m):
    """Anchor after an accepted step: horizontally by radial return, vertically within u_y of p."""
    x, y = radial_return(px, py, ax, ay, m)
    return x, y, drag_component(pz, az, m)
