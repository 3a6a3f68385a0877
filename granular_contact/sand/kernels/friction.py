"""Direction of the static resistance: a regularised sign of the velocity, one component at a time.

Elastoplastic: the grains around a link act as bristles, each with one end on the link (at p) and one end in the bed
(the anchor). A bristle is stretched by at most the yield displacement u_y; beyond it the anchor is dragged along.
Inside a step the anchor is fixed, so with p and v at the end of the step

    e = clip(p - anchor, -u_y, u_y),    s = (e + tau v) / u_y,    sigma = clip(s, -1, 1),    anchor <- p - e afterwards,

is the closed-form return mapping of one-dimensional perfect plasticity, with the bristle damping tau. Were p - anchor
to stand for e in s, the sign of a body that turns round within a step would be that of its path over the step, and
late. At rest the anchor does not move: no creep. Smooth: s = v / v_eps and sigma = tanh(s), which creeps under any
load.

Bristles stand at the stations of a run; along the strip between two of them s varies linearly, as e and v do, so that
a strip that turns about a point within it resists on both sides of that point, and sigma is integrated exactly where it
changes (`bar_statics`).

What the elastoplastic form costs. The stiffness B / u_y of a bristle follows the depth z with the bound B of its force,
so a closed loop below yield may gain up to B' u_y^2 where tau = 0, B' = dB/dz: 4e-9 J for the source's link at 14 mm.
The damping tau takes more than that out of loops faster than about u_y / (z tau), 0.7 rad/s there.

Along the strip about which a body turns, e is no straight line between its ends: it is at the yield everywhere but near
the point that rests. So at a bristle that yields and slides on, tau v counts as T v with T = SWITCH: there sigma is 1
either way, but the zero of s along the strip comes to lie where that of v is, and |s| < 1 only near it.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

ELASTOPLASTIC = 0
SMOOTH = 1
SWITCH = 0.01  # s, the time T


@part
def drive(stretch: float, v: float, m) -> float:
    """What the sign is taken of: s, of a bristle with stretch = p - anchor (m) and velocity component v (m/s)."""
    if m.friction == SMOOTH:
        return v / m.v_eps
    e = min(m.u_y, max(-m.u_y, stretch))
    return (e + (sliding(abs(e), m) if e * v > 0.0 else m.tau) * v) / m.u_y


@part
def sliding(e: float, m) -> float:
    """What stands for tau (s) where a bristle stretched by e >= 0 (m) is stretched on: T from the yield on."""
    yields = min(1.0, max(0.0, 2.0 * e / m.u_y - 1.0))
    return m.tau + yields * max(0.0, SWITCH - m.tau)


@part
def direction(s: float, m) -> float:
    """Regularised sign sigma in [-1, 1] of s, medium record m."""
    return math.tanh(s) if m.friction == SMOOTH else min(1.0, max(-1.0, s))


@part
def drag_component(p: float, anchor: float, m) -> float:
    """One component of an anchor after an accepted step that ended at p: within u_y of p (m)."""
    return p - min(m.u_y, max(-m.u_y, p - anchor))
