"""Views, room to work in and zeros, each a few instructions: numpy's general forms take a third of a second to compile.

They look at nothing: bounds are those that the caller knows to be good, arrays are contiguous (C).
"""

from __future__ import annotations

import math
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array


def _contiguous(kind: Any) -> None:
    if not isinstance(kind, types.Array) or kind.layout != "C":
        raise TypingError(f"got {kind}, allowed is a contiguous array")


def _view(context: Any, builder: Any, kind: Any, given: Any, place: Any, shape: list[Any]) -> Any:
    """Array of a kind with this shape whose numbers begin `place` rows after those of another."""
    first = cgutils.unpack_tuple(builder, given.strides)[0]
    at = builder.gep(builder.bitcast(given.data, cgutils.voidptr_t), [builder.mul(place, first)])
    made = make_array(kind)(context, builder)
    strides = cgutils.unpack_tuple(builder, given.strides)[-kind.ndim :]
    populate_array(
        made,
        builder.bitcast(at, made.data.type),
        shape,
        strides,
        given.itemsize,
        cgutils.get_null_value(made.meminfo.type),
    )
    return made._getvalue()


@intrinsic
def rows(typing_context, array, first, count):
    """array[first : first + count] of an array that outlives it, as an argument does."""
    _contiguous(array)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        shape = cgutils.unpack_tuple(builder, given.shape)
        return _view(context, builder, array, given, values[1], [values[2], *shape[1:]])

    return array(array, types.intp, types.intp), generate


@intrinsic
def piece(typing_context, array, i, count):
    """array[i, :count] of an array that outlives it, as an argument does."""
    _contiguous(array)
    kind = array.copy(ndim=array.ndim - 1)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        shape = cgutils.unpack_tuple(builder, given.shape)
        return _view(context, builder, kind, given, values[1], [values[2], *shape[2:]])

    return kind(array, types.intp, types.intp), generate


@intrinsic
def flat(typing_context, array):
    """array.ravel() of an array that outlives it, as an argument does."""
    _contiguous(array)
    kind = array.copy(ndim=1)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        made = make_array(kind)(context, builder)
        size, nothing = cgutils.intp_t(context.get_abi_sizeof(context.get_data_type(kind.dtype))), made.meminfo.type
        shape, strides = [given.nitems], [size]
        populate_array(made, given.data, shape, strides, size, cgutils.get_null_value(nothing))
        return made._getvalue()

    return kind(array), generate


@intrinsic
def borrowed(typing_context, array):
    """The array itself, of one that outlives it, as an argument does; nobody counts references to it.

    Numba counts who refers to an array by an instruction that all cores wait for, with every slice and every call that
    it goes through: half the time of a load on a few strips.
    """
    _contiguous(array)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        shape = cgutils.unpack_tuple(builder, given.shape)
        return _view(context, builder, array, given, cgutils.intp_t(0), shape)

    return array(array), generate


def _room(sizes: tuple[Any, ...]) -> Any:
    """Signature and code of an array of these sizes."""
    if not all(isinstance(size, types.IntegerLiteral) for size in sizes):
        raise TypingError(f"got the sizes {sizes}, allowed are constants")
    kind, shape = types.Array(types.float64, len(sizes), "C"), [size.literal_value for size in sizes]

    def generate(context, builder, signature, values):
        total = math.prod(shape)
        strides = [8 * math.prod(shape[i + 1 :]) for i in range(len(shape))]
        data = cgutils.alloca_once(builder, context.get_value_type(types.UniTuple(types.float64, total)))
        made = make_array(kind)(context, builder)
        whole = [[cgutils.intp_t(number) for number in numbers] for numbers in (shape, strides)]
        nothing = cgutils.get_null_value(made.meminfo.type)
        populate_array(made, builder.bitcast(data, made.data.type), *whole, cgutils.intp_t(8), nothing)
        return made._getvalue()

    return kind(*sizes), generate


@intrinsic(prefer_literal=True)
def room1(typing_context, n):
    """Array (n,) of numbers, not yet set, that lives as long as the function that asks for it; its size is constant."""
    return _room((n,))


@intrinsic(prefer_literal=True)
def room2(typing_context, n, m):
    """As `room1`, (n, m)."""
    return _room((n, m))


@intrinsic(prefer_literal=True)
def room3(typing_context, n, m, k):
    """As `room1`, (n, m, k)."""
    return _room((n, m, k))


@intrinsic
def clear(typing_context, array):
    """array[...] = 0."""
    _contiguous(array)

    def generate(context, builder, signature, values):
        given = make_array(array)(context, builder, values[0])
        cgutils.memset(builder, given.data, builder.mul(given.nitems, given.itemsize), 0)
        return context.get_dummy_value()

    return types.none(array), generate


@intrinsic
def copy(typing_context, to, given):
    """to[...] = given, of the same size and type."""
    _contiguous(to)
    _contiguous(given)
    if to.dtype != given.dtype:
        raise TypingError(f"got {given} for {to}, allowed are the same numbers")

    def generate(context, builder, signature, values):
        end, begin = (
            make_array(kind)(context, builder, value) for kind, value in zip(signature.args, values, strict=True)
        )
        cgutils.raw_memcpy(builder, end.data, begin.data, begin.nitems, begin.itemsize)
        return context.get_dummy_value()

    return types.none(to, given), generate
