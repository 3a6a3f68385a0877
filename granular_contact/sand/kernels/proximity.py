"""Proximity of lines and bodies to the surface: whether they may touch it within a step, and when at the earliest."""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import part

# Columns of proximity (n, 3), for each line, or for each body in space: depth of the deepest point (m, negative above
# the surface), greatest speed at which a point approaches the surface (m/s), in space upper bounds of both; greatest
# depth so far (m).
DEEPEST, APPROACH, GREATEST = 0, 1, 2


@part
def may_touch(depth, speed, step):
    """Return whether a point at a depth (m) may touch the surface in a step (s), at four times its speed (m/s)."""
    return depth + 4.0 * step * (speed + 10.0 * step) > -1e-3


@part
def touches_in(proximity):
    """Time (s) until the first line or body above the surface may touch it; infinite if none may."""
    least = np.inf
    for i in range(proximity.shape[0]):
        depth, speed = proximity[i, DEEPEST], proximity[i, APPROACH]
        if depth < 0.0 < speed:
            least = min(least, -depth / speed)
    return least
