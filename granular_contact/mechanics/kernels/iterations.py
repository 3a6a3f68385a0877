"""Arrays of Newton's method as `anderson` goes on with it, the engine's own among them.

They are found by their places (`lending`), in this order:

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

import numpy as np

from granular_contact.jit.lending import lender
from granular_contact.mechanics.kernels.numerics import DEPTH as DEPTH

Q, V, A, MULTIPLIERS, V_BEFORE, A_BEFORE, MULTIPLIERS_BEFORE, LEVER = 0, 1, 2, 3, 4, 5, 6, 7
KEPT, KEPT_MULTIPLIERS, OF, LED_APART, LED_CONSTRAINTS, BENT, PRODUCTS, NUMBER = 8, 9, 10, 11, 12, 13, 14, 15
GIVEN = LEVER + 1  # arrays that are the engine's, or stay as they are
row, rows = (lender(np.float64, axes) for axes in (1, 2))
numbers = lender(np.int64, 1)

# Rows of `kept`, of which `kept_multipliers` has the first two: accelerations from which the iteration under way began,
# those that the one before led to, its change.
FROM, LED, CHANGE = 0, 1, 2
SIZE = 2  # of `of`
# Of `number`: pairs there are, column of the next one, Jacobians that were computed when the last one was kept, whether
# an iteration with the same Jacobian came before this one.
PAIRS, NEXT, JACOBIAN, FOLLOWS, NUMBERS = 0, 1, 2, 3, 4
