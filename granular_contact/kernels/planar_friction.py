"""Direction of a resistance that opposes the motion as a whole, not component by component.

The bristle of `friction`, in the plane: with the stretch p - anchor and the velocity v at the end of a step,

    e = (p - anchor) min(1, u_y / |p - anchor|)
    q = e + tau v,    u = q / |q|,    s = min(1, |q| / u_y)          elastoplastic
    q = v,            u = q / |q|,    s = tanh(|q| / v_eps)          smooth

u is the direction that the law sees as that of the motion, s the share of its static force that is mobilised. The
anchor is dragged along the line of the bristle so that |p - anchor| <= u_y (radial return of perfect plasticity), and
within the step h the bristle is no longer than that either: p - anchor is the way of the whole step, which points where
the body went in the middle of it, so that beside tau v the direction would come late by h^2 / 2 (h + tau). At rest
nothing moves, and the force is continuous in p and v. A law whose force is not along -u has no potential inside the
yield surface, so that one closed path there may return up to u_y times its force; sliding always takes energy.
"""

from __future__ import annotations

import math

from numba import njit

from granular_contact.kernels.friction import SMOOTH


@njit(cache=True)
def shortening(ex, ey, m):
    """Factor in (0, 1] that shortens p - anchor (m) to e."""
    h = math.hypot(ex, ey)
    return m.u_y / h if h > m.u_y else 1.0


@njit(cache=True)
def mobilised(ex, ey, vx, vy, m):
    """Direction u (2,) and mobilised share s in [0, 1]; p - anchor (m), velocity v (m/s), medium record m."""
    if m.friction == SMOOTH:
        h = math.hypot(vx, vy)
        if h == 0.0:
            return 0.0, 0.0, 0.0
        return vx / h, vy / h, math.tanh(h / m.v_eps)
    k = shortening(ex, ey, m)
    qx, qy = k * ex + m.tau * vx, k * ey + m.tau * vy
    h = math.hypot(qx, qy)
    if h == 0.0:
        return 0.0, 0.0, 0.0
    return qx / h, qy / h, min(1.0, h / m.u_y)


@njit(cache=True)
def mobilised_slopes(ex, ey, vx, vy, m):
    """What turns derivatives by u into derivatives by e and v.

    Returns ds/d|q|, s/|q| (1/m; s/m where smooth) and dq/dv (s), see `by_stretch` for dq/dp: for a force s S(u) that is

        d(s S)/dq = ds/d|q| S u^T + (s/|q|) dS/du (I - u u^T).
    """
    if m.friction == SMOOTH:
        h = math.hypot(vx, vy)
        t = math.tanh(h / m.v_eps)
        return (1.0 - t * t) / m.v_eps, (t / h if h > 0.0 else 1.0 / m.v_eps), 1.0
    k = shortening(ex, ey, m)
    h = math.hypot(k * ex + m.tau * vx, k * ey + m.tau * vy)
    if h < m.u_y:
        return 1.0 / m.u_y, 1.0 / m.u_y, m.tau
    return 0.0, 1.0 / h, m.tau


@njit(cache=True)
def by_stretch(by_qx, by_qy, ex, ey, m):
    """From a derivative by q (2,) to that by p - anchor (2,): times de/d(p - anchor), which is symmetric."""
    if m.friction == SMOOTH:
        return 0.0, 0.0
    h = math.hypot(ex, ey)
    if h <= m.u_y:
        return by_qx, by_qy
    along = (by_qx * ex + by_qy * ey) / h**2
    return m.u_y / h * (by_qx - along * ex), m.u_y / h * (by_qy - along * ey)


@njit(cache=True)
def radial_return(px, py, ax, ay, m):
    """Anchor after an accepted step that ended at p: on the line to p, within u_y of it (m)."""
    ex, ey = px - ax, py - ay
    h = math.hypot(ex, ey)
    if h <= m.u_y:
        return ax, ay
    return px - ex * (m.u_y / h), py - ey * (m.u_y / h)
