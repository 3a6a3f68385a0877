"""Arrays of Newton's method as `anderson` goes on with it, the engine's own among them.

Of a view `w` of ITERATIONS (`jit.layout`):

    q, v, a             (m,) coordinates, rates and accelerations, and the multipliers (k,) of constraints, which are
    multipliers         moved: with a change of a go of[0] times as much of q and of[1] times as much of v
    v_before, a_before  rates, accelerations and multipliers at the start of the step
    multipliers_before
    lever               (m,) factors from rates to speeds
    kept                (3, m) of the iteration before
    kept_multipliers    (2, k)
    of                  (3,) two factors, see above, and the size (m/s2) of the change of the iteration before
    led, led_constraints  (m, DEPTH) and (k, DEPTH): how far from each other two iterations led,
    bent                (m, DEPTH) by how much their changes (in speeds) differed,
    products            (DEPTH, DEPTH) of these with each other
    number              (NUMBERS,) whole numbers, see below
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.layout import Layout
from granular_contact.mechanics.kernels.numerics import DEPTH

ITERATIONS = Layout(
    "iterations",
    **dict.fromkeys(("q", "v", "a", "multipliers", "v_before", "a_before", "multipliers_before", "lever"), (float, 1)),
    **dict.fromkeys(("kept", "kept_multipliers", "led", "led_constraints", "bent", "products"), (float, 2)),
    of=(float, 1),
    number=(np.int64, 1),
)
# Rows of `kept`, of which `kept_multipliers` has the first two: accelerations from which the iteration under way began,
# those that the one before led to, its change.
FROM, LED, CHANGE = 0, 1, 2
SIZE = 2  # of `of`
# Of `number`: pairs there are, column of the next one, Jacobians that were computed when the last one was kept, whether
# an iteration with the same Jacobian came before this one.
PAIRS, NEXT, JACOBIAN, FOLLOWS, NUMBERS = 0, 1, 2, 3, 4


def room(coordinates: int, constraints: int) -> dict[str, NDArray[Any]]:
    """Those arrays of so many coordinates and constraints that are neither the engine's nor stay as they are."""
    sizes = {"led": coordinates, "led_constraints": constraints, "bent": coordinates, "products": DEPTH}
    return {
        **{"kept": np.zeros((3, coordinates)), "kept_multipliers": np.zeros((2, constraints)), "of": np.zeros(3)},
        **{name: np.zeros((size, DEPTH)) for name, size in sizes.items()},
        "number": np.zeros(NUMBERS, np.int64),
    }
