"""The free surface behind a turning wheel (Agarwal et al. 2021), lowered by delta_h = r (r omega^2 / g).

On the rear half of its contact, seen the way in which it would roll. Within ROUND radii of the middle the surface goes
from one height to the other, so that forces stay continuous [ours].
"""

from __future__ import annotations

import math

from granular_contact.kernels.compiled import part

ROUND = 0.1


@part
def lowering(P, V, run):
    """delta_h (m) of the wheel that a run belongs to, x of its axle (m), and the sign of x the way that it rolls."""
    cx, cy = P[1, 0] - P[0, 0], P[1, 1] - P[0, 1]
    length = math.hypot(cx, cy)
    tx, ty = cx / length, cy / length
    omega = (tx * (V[1, 1] - V[0, 1]) - ty * (V[1, 0] - V[0, 0])) / length
    rim = run.radius * omega
    return run.behind * rim * rim, P[0, 0] + run.hub_along * tx - run.hub_left * ty, -math.copysign(1.0, omega)


@part
def lowered(x, drop, axle, ahead, run):
    """By how much (m) the surface is lowered at x (m); arguments as `lowering` has them."""
    return drop * min(1.0, max(0.0, 0.5 - ahead * (x - axle) / (ROUND * run.radius)))
