"""How near lines and bodies are to the surface: whether they may touch it within a step, and when at the soonest."""

from __future__ import annotations

import numpy as np

from granular_contact.jit.compiled import part

# Of proximity (n, 3), of each line, or of each body in space: depth of the deepest point (m, negative above the
# surface), speed at which one approaches the surface (m/s), in space bounds of both; greatest depth so far (m).
DEEPEST, APPROACH, EVER = 0, 1, 2


@part
def may_touch(depth, speed, step):
    """Whether what is so deep (m) and so fast (m/s) may touch the surface in a step (s), at four times its speed."""
    return depth + 4.0 * step * (speed + 10.0 * step) > -1e-3


@part
def touches_in(proximity):
    """Time (s) until the first of what is above the surface may touch it; infinite of none."""
    least = np.inf
    for i in range(proximity.shape[0]):
        depth, speed = proximity[i, DEEPEST], proximity[i, APPROACH]
        if depth < 0.0 < speed:
            least = min(least, -depth / speed)
    return least
