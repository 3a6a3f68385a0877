"""Arrays that a compiled function takes by their places, all from one array of whole numbers.

To hand one array over from Python takes some 0.1 us and an instruction that all cores wait for, so that a dozen of
them cost more than the law on a few strips. Where the same arrays come with each call, their places are written down
once (`places`), and the function finds the arrays there (what `lender` makes).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array
from numpy.typing import NDArray

WORDS = 4  # for each array: where it begins, and its size along up to three axes


def places(*arrays: NDArray[Any]) -> NDArray[np.int64]:
    """Where contiguous arrays are, (WORDS * arrays,); good for as long as somebody keeps them."""
    found = np.zeros((len(arrays), WORDS), np.int64)
    for words, array in zip(found, arrays, strict=True):
        if not (array.flags.c_contiguous and array.flags.writeable and array.flags.aligned):
            raise ValueError("allowed are contiguous arrays that can be written to")
        words[: 1 + array.ndim] = array.ctypes.data, *array.shape
    return found.ravel()


def lender(kind: types.Array) -> Any:
    """Function for kernels, (words, number) -> the array of this kind that was given to `places` as that number."""

    @intrinsic
    def lend(typing_context, words, number):
        def generate(context, builder, signature, values):
            given = make_array(signature.args[0])(context, builder, values[0])
            first = builder.mul(values[1], cgutils.intp_t(WORDS))

            def word(i: int) -> Any:
                return builder.load(builder.gep(given.data, [builder.add(first, cgutils.intp_t(i))]))

            made, size = make_array(kind)(context, builder), context.get_abi_sizeof(context.get_data_type(kind.dtype))
            shape = [word(1 + axis) for axis in range(kind.ndim)]
            strides = [cgutils.intp_t(size)]
            for length in shape[:0:-1]:
                strides.insert(0, builder.mul(strides[0], length))
            nothing = context.get_constant_null(types.voidptr)
            data = builder.inttoptr(word(0), made.data.type)
            populate_array(made, data, shape, strides, cgutils.intp_t(size), nothing)
            return made._getvalue()

        return kind(words, types.intp), generate

    return lend
