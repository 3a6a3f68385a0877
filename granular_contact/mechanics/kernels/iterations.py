"""Arrays that Anderson acceleration (`anderson`) works on: the unknowns of Newton's method and its last iterations.

Of a view `w` of ITERATIONS (`jit.layout`), with m coordinates and k constraints. The engine's own arrays:

    q, v, a             (m,) coordinates, rates and accelerations at the end of the step
    multipliers         (k,) Lagrange multipliers of the constraints
    a_before            accelerations and multipliers at the end of the last step
    multipliers_before
    lever               (m,) factors from rates of coordinates to speeds of points (m/s)

Arrays that `room` makes. An iteration moves the accelerations and multipliers from x to x + g(x):

    start, start_multipliers  (m,), (k,) x of the iteration under way
    end, end_multipliers      (m,), (k,) x + g of the last iteration
    g                         (m,) its change g of accelerations, times lever (m/s2)
    G                         (m, DEPTH) differences of g between two successive iterations, one column a pair
    E, E_multipliers          (m, DEPTH), (k, DEPTH) the same of x + g
    GTG                       (DEPTH, DEPTH) G^T G
    progress                  (1,) record of PROGRESS
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.layout import Layout
from granular_contact.jit.records import fields, record_dtype
from granular_contact.mechanics.kernels.numerics import DEPTH

# dq_da (s2), dv_da (s): how much a coordinate and its rate change with its acceleration at the end of the step; change
# (m/s2): size of g of the last iteration, infinite before the first; pairs: columns of G and E that are filled; column:
# the one that is filled next; jacobian: number of the Jacobian of the last iteration; follows: whether an iteration
# with the same Jacobian came before.
PROGRESS = record_dtype(
    [*fields("f8", "dq_da", "dv_da", "change"), *fields("i8", "pairs", "column", "jacobian", "follows")]
)
ITERATIONS = Layout(
    "iterations",
    **dict.fromkeys(("q", "v", "a", "multipliers", "a_before", "multipliers_before", "lever"), (float, 1)),
    **dict.fromkeys(("start", "start_multipliers", "end", "end_multipliers", "g"), (float, 1)),
    **dict.fromkeys(("G", "E", "E_multipliers", "GTG"), (float, 2)),
    progress=(PROGRESS, 1),
)


def room(coordinates: int, constraints: int) -> dict[str, NDArray[Any]]:
    """Arrays of the iterations that are not the engine's, by name, for so many coordinates and constraints."""
    m, k = coordinates, constraints
    sizes = {"start": m, "start_multipliers": k, "end": m, "end_multipliers": k, "g": m}
    rows = {"G": m, "E": m, "E_multipliers": k, "GTG": DEPTH}
    return {
        **{name: np.zeros(size) for name, size in sizes.items()},
        **{name: np.zeros((size, DEPTH)) for name, size in rows.items()},
        "progress": np.zeros(1, PROGRESS),
    }
