"""Arrays of Newton's method as `anderson` and `line_search` go on with it, the engine's own among them.

They are found by their places (`lending`), in this order:

    q, v, a             (m,) coordinates, rates and accelerations, and the multipliers (k,) of constraints, which are
    multipliers         moved: with a change of a go of[0] times as much of q and of[1] times as much of v
    v_before, a_before  rates, accelerations and multipliers at the start of the step
    multipliers_before
    lever               (m,) factors from rates to speeds
    kept                (4, m) of the iteration before
    kept_multipliers    (2, k)
    of                  (2,)
    led, led_constraints  (m, DEPTH) and (k, DEPTH): how far from each other two iterations led,
    bent                (m, DEPTH) by how much their changes (in speeds) differed,
    products            (DEPTH, DEPTH) of these with each other
    number              (NUMBERS,) whole numbers, see below
    line                (LINE,) numbers of the line that the iteration goes along, see below
    way                 (2, m) where that line begins, and how far it leads
    way_of_multipliers  (2, k)
"""

from __future__ import annotations

import numpy as np

from granular_contact.jit.lending import lender

Q, V, A, MULTIPLIERS, V_BEFORE, A_BEFORE, MULTIPLIERS_BEFORE, LEVER = 0, 1, 2, 3, 4, 5, 6, 7
KEPT, KEPT_MULTIPLIERS, OF, LED_APART, LED_CONSTRAINTS, BENT, PRODUCTS, NUMBER = 8, 9, 10, 11, 12, 13, 14, 15
ON_LINE, WAY, WAY_OF_MULTIPLIERS = 16, 17, 18
GIVEN = LEVER + 1  # arrays that are the engine's, or stay as they are
row, rows = (lender(np.float64, axes) for axes in (1, 2))
numbers = lender(np.int64, 1)

DEPTH = 6  # pairs of iterations that are kept
# Rows of `kept`, of which `kept_multipliers` has the first two: accelerations from which the iteration under way began,
# those that the one before led to, its change, how much further the next one begins.
FROM, LED, CHANGE, FURTHER = 0, 1, 2, 3
# Of `number`: pairs there are, column of the next one, Jacobians that were computed when the last one was kept, whether
# an iteration with the same Jacobian came before this one.
PAIRS, NEXT, JACOBIAN, FOLLOWS = 0, 1, 2, 3
# Whether steps are fixed, what is known of the line, places tried on it; iterations of the step, fewest of a step with
# this Jacobian, how many more than these there were, and Jacobians when the step began.
FIXED, STAGE, TRIES, COUNT, FEWEST, MORE, SINCE, NUMBERS = 4, 5, 6, 7, 8, 9, 10, 11
# Of number[STAGE]: no line yet, the one that the last iteration went along, one on which a place is sought.
NOWHERE, ALONG, SEEKS = 0, 1, 2
# Of `line`: square of its length (m2/s4); place of the iteration under way, and of the one before it; places between
# which the one sought is, and what a change from there has along the line, as shares of its length.
SQUARE, AT, LAST, LOW, HIGH, OF_LOW, OF_HIGH, LINE = 0, 1, 2, 3, 4, 5, 6, 7
