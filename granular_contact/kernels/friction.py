"""Direction of the static resistance: a regularised sign of the velocity, one component at a time.

Elastoplastic: the grains around a strip act as a bristle with one end on the strip (at p) and one end in the bed (the
anchor). The bristle is stretched by at most the yield displacement u_y; beyond it the anchor is dragged along. Inside a
step the anchor is fixed, so with p and v at the end of the step

    sigma = clip((p - anchor + tau v) / u_y, -1, 1),          anchor <- p - clip(p - anchor, -u_y, u_y) afterwards,

is the closed-form return mapping of one-dimensional perfect plasticity, with the bristle damping tau. At rest the
anchor does not move: no creep. What the form costs: the bristle's stiffness B / u_y follows the depth with its bound B, so
a closed loop below yield can gain up to B' u_y^2 per strip where tau = 0 (4e-9 J for the source's link), B' the slope of
the bound; the damping takes more than that from any loop faster than u_y / (z tau), 0.7 rad/s at z = 14 mm by default. And
a strip has one sign: where it turns about a point within, off its middle by less than a third of a half, the force of the
smaller side works with the motion; that is at most a sixth of B times its length times its rate, and falls with strips. Smooth: sigma = tanh(v / v_eps), which creeps under any load.
"""

from __future__ import annotations

import math

from numba import njit

ELASTOPLASTIC = 0
SMOOTH = 1


@njit(cache=True)
def direction(stretch: float, v: float, m) -> float:
    """Regularised sign of a velocity component v (m/s), in [-1, 1]; stretch = p - anchor (m), medium record m."""
    if m.friction == SMOOTH:
        return math.tanh(v / m.v_eps)
    return min(1.0, max(-1.0, (stretch + m.tau * v) / m.u_y))


@njit(cache=True)
def direction_slopes(stretch: float, v: float, m) -> tuple[float, float]:
    """Derivatives of `direction` by stretch (1/m) and by v (s/m)."""
    if m.friction == SMOOTH:
        return 0.0, (1.0 - math.tanh(v / m.v_eps) ** 2) / m.v_eps
    if abs(stretch + m.tau * v) >= m.u_y:
        return 0.0, 0.0
    return 1.0 / m.u_y, m.tau / m.u_y


@njit(cache=True)
def drag_component(p: float, anchor: float, m) -> float:
    """One component of an anchor after an accepted step that ended at p: within u_y of p (m)."""
    return p - min(m.u_y, max(-m.u_y, p - anchor))
