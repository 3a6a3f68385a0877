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
def drive(e, v, m):
    """Vector q (3,) as in `planar_friction.drive`: p - anchor e (m), velocity v (m/s); and the factor of v in it."""
    if m.friction == SMOOTH:
        return v, 1.0
    return stretched(e, v, m)


@part(inline=True)
def stretched(e, v, m):
    """`drive` of a bristle, without a branch, so that compilers make one of several of them at once."""
    (ex, ey, ez), (vx, vy, vz) = e, v
    h, square = math.sqrt(ex * ex + ey * ey + ez * ez), vx * vx + vy * vy + vz * vz
    along = ex * vx + ey * vy + ez * vz
    k = m.u_y / h if h > m.u_y else 1.0
    slides = max(0.0, along) / max(TINY, h * math.sqrt(square))  # cosine
    yields = sliding(min(h, m.u_y), m) - m.tau
    tau = m.tau + (slides * yields if along > 0.0 and h > 0.5 * m.u_y and square > 0.0 else 0.0)
    return (k * ex + tau * vx, k * ey + tau * vy, k * ez + tau * vz), tau


@part
def mobilised(q, m):
    """Direction u (3,) and mobilised share s in [0, 1] of a vector q as in `drive`, medium record m."""
    h = math.sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])
    if h == 0.0:
        return (0.0, 0.0, 0.0), 0.0
    one = 1.0 / h
    share = math.tanh(h / m.v_eps) if m.friction == SMOOTH else min(1.0, h / m.u_y)
    return (one * q[0], one * q[1], one * q[2]), share


@part
def whole_return(p, anchor, m):
    """Anchor after an accepted step that ended at p (3,) m: on the line to p, within u_y of it."""
    ex, ey, ez = p[0] - anchor[0], p[1] - anchor[1], p[2] - anchor[2]
    h = math.sqrt(ex * ex + ey * ey + ez * ez)
    if h <= m.u_y:
        return anchor
    k = m.u_y / h
    return p[0] - k * ex, p[1] - k * ey, p[2] - k * ez


@part
def parted_return(p, anchor, m):
    """Anchor after an accepted step that ended at p (3,) m: across by radial return, upward within u_y of it."""
    x, y = radial_return((p[0], p[1]), (anchor[0], anchor[1]), m)
    return x, y, drag_component(p[2], anchor[2], m)
