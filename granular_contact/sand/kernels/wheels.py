"""The free surface behind a turning wheel (Agarwal et al. 2021), lowered by delta_h = r (r omega^2 / g).

On the rear half of its contact, seen in the direction in which it would roll. Within ROUND radii of the middle the
surface goes from one height to the other, so that forces stay continuous [ours].
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

ROUND = 0.1


@part
def lowering(P, V, i, line):
    """By how much (m) the surface is lowered at station i of the wheel that a line belongs to."""
    cx, cy = P[1, 0] - P[0, 0], P[1, 1] - P[0, 1]
    length = math.sqrt(cx * cx + cy * cy)
    tx, ty = cx / length, cy / length
    omega = (tx * (V[1, 1] - V[0, 1]) - ty * (V[1, 0] - V[0, 0])) / length
    rim = line.radius * omega
    ahead = -math.copysign(1.0, omega)  # sign of x in the direction of rolling
    axle = P[0, 0] + line.hub_along * tx - line.hub_left * ty
    return line.behind * rim * rim * min(1.0, max(0.0, 0.5 - ahead * (P[i, 0] - axle) / (ROUND * line.radius)))
