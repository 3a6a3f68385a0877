"""Views of arrays, arrays and records on the stack, zeros and copies in compiled functions: a few instructions each.

Compiled functions neither count references to arrays nor make arrays on the heap (`compiled`). A view is an array at an
address, valid for as long as the viewed array lives. Nothing is checked: callers pass valid bounds and contiguous
arrays (C order).

The bodies of the functions define what they do, and run where nothing is compiled (NUMBA_DISABLE_JIT). Their compiled
code is written with numba's low-level interface (`numba.extending`), in place and without a call.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from ctypes import c_byte
from typing import Any

import numpy as np
from llvmlite import ir
from numba import from_dtype, types
from numba.extending import intrinsic, lower_builtin, type_callable
from numpy.typing import NDArray

from granular_contact.jit.compiled import COMPILES

NUMBERS = types.Array(types.float64, 1, "C")
_BYTE = ir.IntType(8).as_pointer()
_ALIGNED = 64  # bytes, the size of a cache line: records with arrays that are loaded into vector registers


def array_at(address: int, shape: tuple[int, ...], dtype: np.dtype) -> NDArray[Any]:
    """Array at an address, for Python; valid for as long as the memory there is kept alive."""
    size = int(math.prod(shape)) * dtype.itemsize
    if size == 0:
        return np.zeros(shape, dtype)
    return np.frombuffer(memoryview((c_byte * size).from_address(int(address))), dtype).reshape(shape)


def view_of(context: Any, builder: Any, kind: Any, data: Any, shape: Sequence[Any]) -> Any:
    """LLVM code of an array of a numba type that begins at a pointer; data, shape: LLVM values."""
    array, word = context.make_array(kind)(context, builder), types.intp
    sizes = [context.get_constant(word, context.get_abi_sizeof(context.get_data_type(kind.dtype)))]
    number = context.get_constant(word, 1)
    for size in reversed(shape):
        sizes.insert(0, builder.mul(sizes[0], size))
        number = builder.mul(number, size)
    axes = types.UniTuple(word, kind.ndim)
    array.shape, array.strides = (context.make_tuple(builder, axes, entries) for entries in (shape, sizes[1:]))
    array.data = builder.bitcast(data, array.data.type)
    array.itemsize, array.nitems = sizes[-1], number
    array.meminfo = context.get_constant_null(types.MemInfoPointer(kind.dtype))
    array.parent = context.get_constant_null(types.pyobject)
    return array._getvalue()


def _view_type(array: Any, axes: int) -> Any:
    """Type of views of an array with this number of axes; None if it is no array."""
    return types.Array(array.dtype, axes, "C") if isinstance(array, types.Array) else None


def _shape_and_part(context: Any, builder: Any, signature: Any, values: Any, *indices: int) -> tuple[list[Any], Any]:
    """Shape of the array that is the first argument, and pointer to its part at given indices.

    indices: positions of these indices among the arguments, the index of the first axis first.
    """
    array = context.make_array(signature.args[0])(context, builder, values[0])
    shape = [builder.extract_value(array.shape, axis) for axis in range(signature.args[0].ndim)]
    begin = builder.bitcast(array.data, _BYTE)
    for axis, position in enumerate(indices):
        index = context.cast(builder, values[position], signature.args[position], types.intp)
        begin = builder.gep(begin, [builder.mul(index, builder.extract_value(array.strides, axis))])
    return shape, begin


def numbers_at(address, count):
    """Array (count,) of float64 at an address, a whole number, which a record may hold as a float."""
    return array_at(int(address), (int(count),), np.dtype(np.float64))


@type_callable(numbers_at)
def _type_of_numbers(context):
    return lambda address, count: NUMBERS


@lower_builtin(numbers_at, types.Number, types.Integer)
def _numbers_at(context, builder, signature, values):
    address, count = (context.cast(builder, *pair, types.intp) for pair in zip(values, signature.args, strict=True))
    return view_of(context, builder, NUMBERS, builder.inttoptr(address, _BYTE), [count])


def rows(array, first, count):
    """View of `count` rows of an array, from row `first` on."""
    return array[first : first + count]


@type_callable(rows)
def _type_of_rows(context):
    return lambda array, first, count: _view_type(array, array.ndim)


@lower_builtin(rows, types.Array, types.Integer, types.Integer)
def _rows(context, builder, signature, values):
    shape, begin = _shape_and_part(context, builder, signature, values, 1)
    count = context.cast(builder, values[2], signature.args[2], types.intp)
    return view_of(context, builder, signature.return_type, begin, [count, *shape[1:]])


def piece(array, i, count, first=0):
    """View of `count` entries of array[i], from entry `first` on."""
    return array[i, first : first + count]


@type_callable(piece)
def _type_of_piece(context):
    return lambda array, i, count, first=0: _view_type(array, array.ndim - 1)


@lower_builtin(piece, types.Array, types.Integer, types.Integer)
@lower_builtin(piece, types.Array, types.Integer, types.Integer, types.Integer)
def _piece(context, builder, signature, values):
    shape, begin = _shape_and_part(context, builder, signature, values, 1, *range(3, len(values)))
    count = context.cast(builder, values[2], signature.args[2], types.intp)
    return view_of(context, builder, signature.return_type, begin, [count, *shape[2:]])


def flat(array):
    """View (n,) of all entries of an array, row by row."""
    return array.reshape(-1)


@type_callable(flat)
def _type_of_flat(context):
    return lambda array: _view_type(array, 1)


@lower_builtin(flat, types.Array)
def _flat(context, builder, signature, values):
    array = context.make_array(signature.args[0])(context, builder, values[0])
    return view_of(context, builder, signature.return_type, array.data, [array.nitems])


def room1(n):
    """Uninitialised array (n,) of float64 that lives as long as the call that makes it; n is a constant."""
    return np.empty(n)


def room2(n, m):
    """As `room1`, (n, m)."""
    return np.empty((n, m))


def room3(n, m, k):
    """As `room1`, (n, m, k)."""
    return np.empty((n, m, k))


def _room_type(*sizes: Any) -> Any:
    """Type of an array of constant sizes; None for other sizes, so that numba tries them as constants."""
    known = all(isinstance(size, types.IntegerLiteral) for size in sizes)
    return types.Array(types.float64, len(sizes), "C") if known else None


type_callable(room1)(lambda context: lambda n: _room_type(n))
type_callable(room2)(lambda context: lambda n, m: _room_type(n, m))
type_callable(room3)(lambda context: lambda n, m, k: _room_type(n, m, k))


@lower_builtin(room1, types.IntegerLiteral)
@lower_builtin(room2, types.IntegerLiteral, types.IntegerLiteral)
@lower_builtin(room3, types.IntegerLiteral, types.IntegerLiteral, types.IntegerLiteral)
def _room(context, builder, signature, values):
    shape = [size.literal_value for size in signature.args]
    with builder.goto_entry_block():
        begin = builder.alloca(ir.ArrayType(ir.DoubleType(), math.prod(shape)))
    return view_of(context, builder, signature.return_type, begin, [context.get_constant(types.intp, n) for n in shape])


def record_room(kind: np.dtype) -> Any:
    """Function for kernels: () -> uninitialised record of this type that lives as long as the call that makes it."""
    if not COMPILES:
        return lambda: np.zeros(1, kind)[0]
    record = from_dtype(kind)

    @intrinsic
    def room(typing_context):
        def generate(context, builder, signature, values):
            with builder.goto_entry_block():
                begin = builder.alloca(context.get_data_type(record))
            begin.align = _ALIGNED
            return begin

        return record(), generate

    return room


def as_records(kind: np.dtype) -> Any:
    """Function for kernels: array (n, columns) of float64 -> view (n,) of its rows as records of this type."""
    if not COMPILES:
        return lambda array: array.view(kind)[:, 0]
    records = types.Array(from_dtype(kind), 1, "C")

    @intrinsic
    def view(typing_context, array):
        def generate(context, builder, signature, values):
            rows = context.make_array(array)(context, builder, values[0])
            return view_of(context, builder, records, rows.data, [builder.extract_value(rows.shape, 0)])

        return records(array), generate

    return view


def clear(array):
    """Set all entries to 0."""
    array[...] = 0


@type_callable(clear)
def _type_of_clear(context):
    return lambda array: types.none if isinstance(array, types.Array) else None


@lower_builtin(clear, types.Array)
def _clear(context, builder, signature, values):
    begin, size = _bytes(context, builder, signature.args[0], values[0])
    fill = builder.module.declare_intrinsic("llvm.memset", [_BYTE, size.type])
    builder.call(fill, [begin, ir.IntType(8)(0), size, ir.IntType(1)(0)])
    return context.get_dummy_value()


def copy(to, source):
    """Set all entries of an array to the entries of another array of the same size and type."""
    to[...] = source


@type_callable(copy)
def _type_of_copy(context):
    return lambda to, source: types.none if to == source and isinstance(to, types.Array) else None


@lower_builtin(copy, types.Array, types.Array)
def _copy(context, builder, signature, values):
    (begin, size), (source, _) = (
        _bytes(context, builder, *array) for array in zip(signature.args, values, strict=True)
    )
    move = builder.module.declare_intrinsic("llvm.memcpy", [_BYTE, _BYTE, size.type])
    builder.call(move, [begin, source, size, ir.IntType(1)(0)])
    return context.get_dummy_value()


def _bytes(context: Any, builder: Any, kind: Any, value: Any) -> tuple[Any, Any]:
    """Pointer to the bytes of an array, and their number."""
    array = context.make_array(kind)(context, builder, value)
    return builder.bitcast(array.data, _BYTE), builder.mul(array.nitems, array.itemsize)
