"""Direction of the static resistance: a regularised sign of the velocity, one component at a time.

Elastoplastic: the grains around a strip act as a bristle with one end on the strip (at p) and one end in the bed (the
anchor). The bristle is stretched by at most the yield displacement u_y; beyond it the anchor is dragged along. Inside a
step the anchor is fixed, so with p and v at the end of the step

    e = clip(p - anchor, -u_y, u_y),    sigma = clip((e + tau v) / u_y, -1, 1),    anchor <- p - e afterwards,

is the closed-form return mapping of one-dimensional perfect plasticity, with the bristle damping tau. Were p - anchor
to stand for e in sigma, the sign of a body that turns round within a step would be that of its way over the step, and
late. At rest the anchor does not move: no creep. Smooth: sigma = tanh(v / v_eps), which creeps under any load.

What the elastoplastic form costs. The stiffness B / u_y of a bristle follows the depth z with the bound B of its force,
so a closed loop below yield may gain up to B' u_y^2 where tau = 0, B' = dB/dz: 4e-9 J for the source's link at 14 mm.
The damping tau takes more than that out of loops faster than about u_y / (z tau), 0.7 rad/s there. And a strip has one
sign: where it turns about a point between its middle and the centre of its bound, at most a sixth of its length off,
its force works with the motion, with a power up to its bound times that sixth times its rate of turning. More strips
lessen it.
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
    return min(1.0, max(-1.0, (min(m.u_y, max(-m.u_y, stretch)) + m.tau * v) / m.u_y))


@njit(cache=True)
def direction_slopes(stretch: float, v: float, m) -> tuple[float, float]:
    """Derivatives of `direction` by stretch (1/m) and by v (s/m)."""
    if m.friction == SMOOTH:
        return 0.0, (1.0 - math.tanh(v / m.v_eps) ** 2) / m.v_eps
    if abs(min(m.u_y, max(-m.u_y, stretch)) + m.tau * v) >= m.u_y:
        return 0.0, 0.0
    return (1.0 / m.u_y if abs(stretch) < m.u_y else 0.0), m.tau / m.u_y


@njit(cache=True)
def drag_component(p: float, anchor: float, m) -> float:
    """One component of an anchor after an accepted step that ended at p: within u_y of p (m)."""
    return p - min(m.u_y, max(-m.u_y, p - anchor))
