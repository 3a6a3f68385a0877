"""Numbers of a law that are too many for its record: an array elsewhere, whose address is in the record."""

from __future__ import annotations

from granular_contact.jit.compiled import part
from granular_contact.jit.memory import numbers_at

__all__ = ["interval", "numbers_at"]


@part
def interval(values, first, count, x):
    """Place i and share in [0, 1] of x among values[first : first + count], which rise; beyond them those of an end."""
    low, high = 0, count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if values[first + middle] <= x:
            low = middle
        else:
            high = middle
    a, b = values[first + low], values[first + high]
    return low, min(1.0, max(0.0, (x - a) / (b - a)))
