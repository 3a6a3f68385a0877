"""Regularised sign of the velocity, by components: direction of the static resistance.

Elastoplastic: the grains around a link act as bristles, each with one end on the link (at p) and one end in the bed
(the anchor). The stretch of a bristle is at most the yield displacement u_y; beyond it the anchor is dragged along.
Within a step the anchor is fixed, so with p and v at the end of the step

    e = clip(p - anchor, -u_y, u_y),    s = (e + tau v) / u_y,    sigma = clip(s, -1, 1),    anchor <- p - e afterwards,

is the closed-form return mapping of one-dimensional perfect plasticity, with the bristle damping tau. If s had
p - anchor instead of e, the sign of a body that reverses within a step would follow its path over the whole step, and
come late. At rest the anchor does not move: no creep. Smooth: s = v / v_eps and sigma = tanh(s), which creeps under any
load.

Bristles stand at the stations of a line. Along the strip between two stations s varies linearly, as e and v do: so a
strip that turns about a point within it resists on both sides of this point, and sigma is integrated exactly also where
it changes (`bar_statics`).

Error of the elastoplastic form: the stiffness B / u_y of a bristle depends on the depth z, as the bound B of its force
does, so a closed loop below the yield may gain up to B' u_y^2 if tau = 0, with B' = dB/dz: 4e-9 J for the source's link
at 14 mm. The damping tau dissipates more in loops faster than about u_y / (z tau), 0.7 rad/s there.

Along a strip about which a body turns, e does not vary linearly between the ends: it is at the yield everywhere except
near the point at rest. So for a bristle that yields and slides on, tau v is replaced by T v with T = SWITCH: sigma is 1
there in either case, but the zero of s along the strip moves to the zero of v, and |s| < 1 only near it.
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

ELASTOPLASTIC = 0
SMOOTH = 1
SWITCH = 0.01  # s, the time T


@part
def drive(stretch: float, v: float, m) -> float:
    """Argument s of the sign, for a bristle with stretch = p - anchor (m) and velocity component v (m/s)."""
    if m.friction == SMOOTH:
        return v / m.v_eps
    e = min(m.u_y, max(-m.u_y, stretch))
    return (e + (sliding(abs(e), m) if e * v > 0.0 else m.tau) * v) / m.u_y


@part
def sliding(e: float, m) -> float:
    """Damping time (s) of a bristle whose stretch e >= 0 (m) grows: tau, rising to T at the yield."""
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
