"""Lowering of the free surface behind a turning wheel, delta_h = r (r omega^2 / g) (Agarwal et al. 2021).

It acts on the rear half of the contact, seen in the direction in which the wheel would roll. Over ROUND radii around
the axle the lowering goes from 0 to delta_h, so that forces stay continuous [ours].
"""

from __future__ import annotations

import math

from granular_contact.jit.compiled import part

ROUND = 0.1


@part
def lowering(P, V, i, line):
    """Lowering (m) of the surface at station i of a line of a wheel."""
    cx, cy = P[1, 0] - P[0, 0], P[1, 1] - P[0, 1]
    length = math.sqrt(cx * cx + cy * cy)
    tx, ty = cx / length, cy / length
    omega = (tx * (V[1, 1] - V[0, 1]) - ty * (V[1, 0] - V[0, 0])) / length
    rim = line.radius * omega
    ahead = -math.copysign(1.0, omega)  # sign of x in the direction of rolling
    axle = P[0, 0] + line.hub_along * tx - line.hub_left * ty
    return line.behind * rim * rim * min(1.0, max(0.0, 0.5 - ahead * (P[i, 0] - axle) / (ROUND * line.radius)))
