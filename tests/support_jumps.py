"""How far a force jumps on the way between two states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def jump(force: Callable[[Any], Array], a: Any, b: Any, halvings: int) -> float:
    """Greatest change of a force from a to b, after their difference was halved so often.

    Of both halves the one is kept in which the force changes more: a jump is kept to the last, while the change of a
    continuous force shrinks with the way. a, b: numbers or arrays.
    """
    at_a, at_b = force(a), force(b)
    for _ in range(halvings):
        middle = 0.5 * (a + b)
        between = force(middle)
        if np.abs(between - at_a).max() > np.abs(at_b - between).max():
            b, at_b = middle, between
        else:
            a, at_a = middle, between
    return float(np.abs(at_b - at_a).max())
