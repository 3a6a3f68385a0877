"""Signals of drives as polynomials of degree five in pieces, all over the same knots.

knots (k + 1,) s, rising; pieces (signals, k, 6): coefficients over each piece, lowest power first, of the time since
its knot. Before the first knot and after the last one a signal goes on as its nearest piece does.
"""

from __future__ import annotations

from granular_contact.kernels.compiled import part


@part
def look_up(t, knots, pieces, found):
    """Fill found (signals, 3) with values at t (s), their rates and accelerations."""
    low, high = 0, knots.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= t:
            low = middle
        else:
            high = middle
    tau = t - knots[low]
    for i in range(pieces.shape[0]):
        value, rate, acceleration = 0.0, 0.0, 0.0
        for power in range(5, -1, -1):
            acceleration = acceleration * tau + 2.0 * rate
            rate = rate * tau + value
            value = value * tau + pieces[i, low, power]
        found[i, 0], found[i, 1], found[i, 2] = value, rate, acceleration
