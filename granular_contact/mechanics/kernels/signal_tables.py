"""Signals of drives as polynomials of degree five in pieces, all over the same knots.

knots (k + 1,) s, rising; pieces (signals, k, 6): coefficients over each piece, lowest power first, of the time since
its knot. Before the first knot and after the last one a signal goes on as its nearest piece does.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.sand.kernels.tables import interval


@part
def look_up(t, knots, pieces, found):
    """Fill found (signals, 3) with values at t (s), their rates and accelerations."""
    at, _ = interval(knots, 0, knots.shape[0], t)
    tau = t - knots[at]
    for i in range(pieces.shape[0]):
        value, rate, acceleration = 0.0, 0.0, 0.0
        for power in range(5, -1, -1):
            acceleration = acceleration * tau + 2.0 * rate
            rate = rate * tau + value
            value = value * tau + pieces[i, at, power]
        found[i, 0], found[i, 1], found[i, 2] = value, rate, acceleration
