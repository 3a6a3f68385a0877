"""Views of arrays, arrays on the stack, zeros and copies in compiled functions: a few instructions each.

Numba counts references to each slice of an array, and takes `np.empty` from the heap. By slices in place of these views
a run of the runner takes 12 % longer, by `np.empty` 6 % more. A view is an array at an address (`numba.carray`), which
has no count of references: good for as long as the array that it is a view of. Nothing is checked: bounds are those
that the caller knows to be good, arrays are contiguous (C).

The bodies of the functions are what they mean, and what runs where nothing is compiled (NUMBA_DISABLE_JIT).
"""

from __future__ import annotations

import math
from ctypes import c_byte
from typing import Any

import numpy as np
from llvmlite import ir
from numba import carray, types
from numba.extending import intrinsic, overload
from numpy.typing import NDArray


def array_at(address: int, shape: tuple[int, ...], dtype: np.dtype) -> NDArray[Any]:
    """Array of what lies at an address, for Python; good for as long as somebody keeps that."""
    size = int(math.prod(shape)) * dtype.itemsize
    if size == 0:
        return np.zeros(shape, dtype)
    return np.frombuffer(memoryview((c_byte * size).from_address(int(address))), dtype).reshape(shape)


def pointer_to(number: Any) -> Any:
    """Function for kernels: address, a whole number -> pointer to numbers or records of this type of numba's."""
    kind = types.CPointer(number)

    @intrinsic
    def pointer(typing_context, address):
        def generate(context, builder, signature, values):
            return builder.inttoptr(values[0], context.get_value_type(kind))

        return kind(types.intp), generate

    return pointer


def numbers_at(address, count):
    """Array (count,) of the float64 that lie at an address, a whole number."""
    return array_at(int(address), (int(count),), np.dtype(np.float64))


@overload(numbers_at)
def _numbers_at(address, count):
    at = pointer_to(types.float64)
    return lambda address, count: carray(at(address), (count,))


@intrinsic(prefer_literal=True)
def _stack(typing_context, size):
    """Pointer to so many float64 on the stack of the function it is called in; the size is a constant."""
    kind = types.CPointer(types.float64)

    def generate(context, builder, signature, values):
        with builder.goto_entry_block():
            room = builder.alloca(ir.ArrayType(ir.DoubleType(), size.literal_value))
        return builder.bitcast(room, context.get_value_type(kind))

    return kind(size), generate


def rows(array, first, count):
    """View of so many rows of an array, from one on."""
    return array[first : first + count]


@overload(rows)
def _rows(array, first, count):
    at = pointer_to(array.dtype)
    if array.ndim == 1:
        return lambda array, first, count: carray(at(array.ctypes.data + first * array.strides[0]), (count,))
    if array.ndim == 2:
        return lambda array, first, count: carray(
            at(array.ctypes.data + first * array.strides[0]), (count, array.shape[1])
        )
    return lambda array, first, count: carray(
        at(array.ctypes.data + first * array.strides[0]), (count, array.shape[1], array.shape[2])
    )


def piece(array, i, count):
    """View of the first `count` entries of array[i]."""
    return array[i, :count]


@overload(piece)
def _piece(array, i, count):
    at = pointer_to(array.dtype)
    if array.ndim == 2:
        return lambda array, i, count: carray(at(array.ctypes.data + i * array.strides[0]), (count,))
    return lambda array, i, count: carray(at(array.ctypes.data + i * array.strides[0]), (count, array.shape[2]))


def flat(array):
    """View of all entries of an array, row by row."""
    return array.reshape(-1)


@overload(flat)
def _flat(array):
    at = pointer_to(array.dtype)
    return lambda array: carray(at(array.ctypes.data), (array.size,))


def borrowed(array):
    """View of a whole array, whose references nobody counts."""
    return array


@overload(borrowed)
def _borrowed(array):
    at = pointer_to(array.dtype)
    return lambda array: carray(at(array.ctypes.data), array.shape)


def room1(n):
    """Array (n,) of float64, not yet set, that lives as long as the call it is made in; its size is a constant."""
    return np.empty(n)


@overload(room1, prefer_literal=True, inline="always")
def _room1(n):
    size = n.literal_value
    return lambda n: carray(_stack(size), (size,))


def room2(n, m):
    """As `room1`, (n, m)."""
    return np.empty((n, m))


@overload(room2, prefer_literal=True, inline="always")
def _room2(n, m):
    shape = n.literal_value, m.literal_value
    size = math.prod(shape)
    return lambda n, m: carray(_stack(size), shape)


def room3(n, m, k):
    """As `room1`, (n, m, k)."""
    return np.empty((n, m, k))


@overload(room3, prefer_literal=True, inline="always")
def _room3(n, m, k):
    shape = n.literal_value, m.literal_value, k.literal_value
    size = math.prod(shape)
    return lambda n, m, k: carray(_stack(size), shape)


def clear(array):
    """Set all entries to 0."""
    array[...] = 0


@overload(clear)
def _clear(array):
    zero = array.dtype(0)

    def fill(array):
        entries = flat(array)
        for i in range(entries.size):
            entries[i] = zero

    return fill


def copy(to, given):
    """Set all entries of an array to those of another of its size."""
    flat(to)[...] = flat(given)


@overload(copy)
def _copy(to, given):
    def fill(to, given):
        entries, others = flat(to), flat(given)
        for i in range(entries.size):
            entries[i] = others[i]

    return fill
