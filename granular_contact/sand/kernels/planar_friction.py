"""Direction of a static resistance that opposes the motion as a vector, not by components.

The bristle of `friction`, in the plane: with the stretch p - anchor and the velocity v at the end of a step,

    e = (p - anchor) min(1, u_y / |p - anchor|)
    q = e + tau v,    u = q / |q|,    s = min(1, |q| / u_y)          elastoplastic
    q = v,            u = q / |q|,    s = tanh(|q| / v_eps)          smooth

u is the direction of motion that a law takes, s the mobilised share of its static force. Along a strip q varies
linearly between the bristles at its two stations, as e and v do; u and s follow from q. After a step the anchor is
dragged along the line of the bristle so that |p - anchor| <= u_y (radial return of perfect plasticity). Within a step h
the stretch e is limited to u_y, too. Without that limit p - anchor would be the path of the whole step, with the
direction of motion in its middle, and beside tau v the direction would come late by h^2 / (2 (h + tau)). At rest
nothing moves, and the force is continuous in p and v. A law whose force is not along -u has no potential inside the
yield surface: one closed path there may return up to u_y times its force. Sliding always dissipates energy.

Lengths are plain square roots: the care of `hypot` for very large and very small numbers takes longer than the law.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.friction import SMOOTH, sliding


@part
def factors(e, v, m):
    """Factors of e = p - anchor (2,) m and of the velocity v (2,) m/s in q: a number, and a time (s)."""
    if m.friction == SMOOTH:
        return 0.0, 1.0
    h, speed = math.sqrt(e[0] * e[0] + e[1] * e[1]), math.sqrt(v[0] * v[0] + v[1] * v[1])
    k, tau = m.u_y / h if h > m.u_y else 1.0, m.tau
    along, most = e[0] * v[0] + e[1] * v[1], h * speed
    if along > 0.0 and most > 0.0:
        tau += along / most * (sliding(k * h, m) - m.tau)
    return k, tau


@part
def drive(e, v, m):
    """Vector q (2,) of the direction of motion that a law takes: m, or m/s if smooth; arguments as in `factors`."""
    k, tau = factors(e, v, m)
    return k * e[0] + tau * v[0], k * e[1] + tau * v[1]


@part
def mobilised(q, m):
    """Direction u (2,) and mobilised share s in [0, 1] of a vector q as in `drive`, medium record m."""
    h = math.sqrt(q[0] * q[0] + q[1] * q[1])
    if h == 0.0:
        return (0.0, 0.0), 0.0
    return (q[0] / h, q[1] / h), (math.tanh(h / m.v_eps) if m.friction == SMOOTH else min(1.0, h / m.u_y))


@part
def radial_return(p, anchor, m):
    """Anchor after an accepted step that ended at p (2,) m: on the line to p, within u_y of it."""
    ex, ey = p[0] - anchor[0], p[1] - anchor[1]
    h = math.sqrt(ex * ex + ey * ey)
    if h <= m.u_y:
        return anchor
    return p[0] - ex * (m.u_y / h), p[1] - ey * (m.u_y / h)
