"""Arrays that a compiled function takes by their places, all from one array of whole numbers.

To hand one array over from Python takes some 0.1 us and an instruction that all cores wait for, so that a dozen of
them cost more than the law on a few strips. Where the same arrays come with each call, their places are written down
once (`places`), and the function finds the arrays there (what `lender` makes).
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numba import carray, from_dtype
from numba.extending import overload
from numpy.typing import DTypeLike, NDArray

from granular_contact.jit.compiled import COMPILES
from granular_contact.jit.memory import array_at, pointer_to

WORDS = 4  # for each array: where it begins, and its size along up to three axes


def places(*arrays: NDArray[Any]) -> NDArray[np.int64]:
    """Where contiguous arrays are, (WORDS * arrays,); good for as long as somebody keeps them."""
    found = np.zeros((len(arrays), WORDS), np.int64)
    for words, array in zip(found, arrays, strict=True):
        if not (array.flags.c_contiguous and array.flags.writeable and array.flags.aligned):
            raise ValueError("allowed are contiguous arrays that can be written to")
        words[: 1 + array.ndim] = array.ctypes.data, *array.shape
    return found.ravel()


def lender(dtype: DTypeLike, axes: int) -> Any:
    """Function for kernels, (words, number) -> the array that was given to `places` as that number.

    dtype: of its numbers or records; axes: how many it has. One function for each kind of arrays, compiled once.
    """
    return _lender(np.dtype(dtype), axes)


@cache
def _lender(kind: np.dtype, axes: int) -> Any:
    """The function that `lender` gives."""
    size = WORDS

    def lend(words, number):
        if COMPILES:
            raise NotImplementedError("arrays are found by their places in compiled functions alone")
        begin = size * number
        return array_at(words[begin], tuple(words[begin + 1 : begin + 1 + axes]), kind)

    at = pointer_to(from_dtype(kind))

    @overload(lend)
    def _lend(words, number):
        if axes == 1:
            return lambda words, number: carray(at(words[size * number]), (words[size * number + 1],))
        if axes == 2:
            return lambda words, number: carray(
                at(words[size * number]), (words[size * number + 1], words[size * number + 2])
            )
        return lambda words, number: carray(
            at(words[size * number]), (words[size * number + 1], words[size * number + 2], words[size * number + 3])
        )

    return lend
