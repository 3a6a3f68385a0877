"""Laws with more numbers than a record holds: an array outside the record, whose address is in the record."""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import numbers_at

__all__ = ["interval", "numbers_at"]


@part
def interval(values, first, count, x):
    """Interval i of x in the rising values[first : first + count], and the share of x in it, clipped to [0, 1]."""
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if values[first + middle] <= x:
            low = middle
        else:
            high = middle
    a, b = values[first + low], values[first + high]
    return low, min(1.0, max(0.0, (x - a) / (b - a)))
