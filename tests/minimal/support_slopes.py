"""The matrix of Newton's method of a tree by differences, and its dense solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from support_parts import of_tree

from granular_contact.engines.tree.march import March


def slopes_of_residuals(
    march: March, parts: Sequence[Callable[[Any], None]], of_q: float, of_v: float, by: float
) -> np.ndarray:
    """Slopes (n, n) of R by the accelerations, with s and s' moved by of_q and of_v of them; by: change (rad/s2, m/s2).

    parts: kernels that fill R from coordinates, rates and accelerations.
    """
    w = march.arrays
    start, slopes = {name: w[name].copy() for name in ("s", "rates", "s2")}, []
    for j in range(len(w["s"])):
        ends = []
        for sign in (1.0, -1.0):
            for name, old in start.items():
                w[name][:] = old
            w["s"][j] += sign * by * of_q
            w["rates"][j] += sign * by * of_v
            w["s2"][j] += sign * by
            for part in parts:
                of_tree(part)(march._addresses)
            ends.append(w["residual"].copy())
        slopes.append((ends[0] - ends[1]) / (2.0 * by))
    return np.array(slopes).T


def solved_densely(matrix: np.ndarray, w: dict[str, np.ndarray]) -> tuple[np.ndarray, float]:
    """Change (n,) with matrix change = -R for all that is not prescribed, and the scale of its round-off."""
    free = w["prescribed"] == 0
    whole, change = matrix[np.ix_(free, free)], np.zeros(len(free))
    change[free] = np.linalg.solve(whole, -w["residual"][free])
    return change, np.abs(change).max(initial=0.0) * max(1.0, np.linalg.cond(whole) if free.any() else 0.0)
