"""Signals of drives as piecewise polynomials of degree five over common knots.

knots (k + 1,) s, rising; pieces (signals, k, 6): coefficients of each piece, lowest power first, in the time since its
knot. Before the first knot and after the last one the nearest piece is extrapolated.
"""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.records import fields, record_dtype
from granular_contact.sand.kernels.tables import interval

# Value of a signal, its rate and its acceleration, in SI units and s.
SIGNAL = record_dtype(fields("f8", "value", "rate", "acceleration"))


@part
def look_up(t, knots, pieces, signals):
    """Evaluate all signals at t (s) by Horner's method: fill signals, (signals,) records of SIGNAL."""
    index, _ = interval(knots, 0, knots.shape[0], t)
    tau = t - knots[index]
    for i in range(pieces.shape[0]):
        value, rate, acceleration = 0.0, 0.0, 0.0
        for power in range(5, -1, -1):
            acceleration = acceleration * tau + 2.0 * rate
            rate = rate * tau + value
            value = value * tau + pieces[i, index, power]
        signal = signals[i]
        signal.value, signal.rate, signal.acceleration = value, rate, acceleration
