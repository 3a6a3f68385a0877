"""Numbers of a law that are too many for its record: an array elsewhere, whose address is in the record."""

from __future__ import annotations

import numpy as np
from numba import carray, types
from numba.core import cgutils
from numba.extending import intrinsic

from granular_contact.kernels.compiled import part


@intrinsic
def _pointer(typing_context, address):
    def generate(context, builder, signature, values):
        return builder.inttoptr(values[0], cgutils.voidptr_t)

    return types.voidptr(types.int64), generate


@part
def numbers_at(address, count):
    """Array (count,) of what lies at an address, a whole number that a record has as a float."""
    return carray(_pointer(np.int64(address)), (count,), np.float64)


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
