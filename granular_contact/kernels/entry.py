"""Kernels called from Python without a look at the types of their arguments, or without any arguments at all.

Looking at a dozen arrays takes longer than the law on a few strips, so whoever calls a kernel with arguments of the
same types thousands of times looks once (`entry`). Even then each array is read anew in every call, some 0.1 us each;
where they are the very same arrays in every call, a function is made that has their places in it (`bound`).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import count
from typing import Any

import numpy as np
from llvmlite import ir
from numba import typeof, types
from numba.core import cgutils
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import cpu_target
from numba.np.arrayobj import make_array, populate_array

_numbers = count()


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """The kernel as compiled for arguments of these types; given others, it reads them as if they were of these."""
    types = tuple(_type_of(argument) for argument in arguments)
    if types not in kernel.overloads:  # compile() finds out too, in ten times the time
        kernel.compile(types)
    compiled: Callable[..., Any] = kernel.overloads[types].entry_point  # get_overload() reads the types once more
    return compiled


def bound(kernel: Any, *arguments: Any) -> Callable[[], Any]:
    """The kernel, or part of one, with all its arguments: arrays whose contents change, but neither place nor size.

    It returns nothing or a truth value. Other threads of Python run meanwhile.
    """
    kinds = tuple(_type_of(argument) for argument in arguments)
    kernel.compile(kinds)
    compiled = kernel.overloads[kinds]
    address = int(compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name))
    call, _ = _from_words(address, kinds, compiled.signature.return_type)
    words = np.array([word for argument in arguments for word in _words(argument)], np.int64)
    made = partial(call, words.ctypes.data)
    made.kept = words, compiled, arguments  # type: ignore[attr-defined]  # as long as it may be called
    return made


def _words(argument: Any) -> list[int]:
    """What `_from_words` takes of an argument."""
    if isinstance(argument, np.ndarray):
        return [argument.ctypes.data, *argument.shape, *argument.strides]
    return [int(np.array(argument, np.float64).view(np.int64)) if isinstance(argument, float) else int(argument)]


@lru_cache(maxsize=256)
def _from_words(address: int, kinds: tuple[Any, ...], result: Any) -> tuple[Any, Any]:
    """Function that takes all arguments of the one at an address from whole numbers of 8 bytes, and what keeps it.

    Of an array its place, shape and strides, of a number its bits.
    """
    context, name = cpu_target.target_context, f"bound_{next(_numbers)}"
    library, module = context.codegen().create_library(name), context.create_module(name)
    truth = ir.IntType(8)
    function = ir.Function(module, ir.FunctionType(truth, [cgutils.intp_t.as_pointer()]), name)
    builder = ir.IRBuilder(function.append_basic_block())
    places = count()

    def word() -> Any:
        return builder.load(builder.gep(function.args[0], [cgutils.intp_t(next(places))]))

    given = [_argument(context, builder, kind, word) for kind in kinds]
    python = context.get_python_api(builder)
    state = python.save_thread()
    callee = builder.inttoptr(cgutils.intp_t(address), context.call_conv.get_function_type(result, kinds).as_pointer())
    status, value = context.call_conv.call_function(builder, callee, result, kinds, given)
    python.restore_thread(state)
    with cgutils.if_unlikely(builder, status.is_error):
        python.err_set_string("PyExc_RuntimeError", "a compiled function failed")
        builder.ret(truth(0))
    builder.ret(builder.zext(value, truth) if result == types.boolean else truth(0))
    with global_compiler_lock:
        library.add_ir_module(module)
        library.finalize()
    made = ctypes.PYFUNCTYPE(ctypes.c_bool if result == types.boolean else None, ctypes.c_void_p)
    return made(library.get_pointer_to_function(name)), library


def _argument(context: Any, builder: Any, kind: Any, word: Callable[[], Any]) -> Any:
    """An argument as compiled code takes it, from whole numbers that come one after another."""
    if not isinstance(kind, types.Array):
        one = word()
        return builder.bitcast(one, context.get_value_type(kind)) if kind == types.float64 else one
    made, size = make_array(kind)(context, builder), context.get_abi_sizeof(context.get_data_type(kind.dtype))
    data = builder.inttoptr(word(), made.data.type)
    shape, strides = ([word() for _ in range(kind.ndim)] for _ in range(2))
    nothing = context.get_constant_null(types.voidptr)
    populate_array(made, data, shape, strides, cgutils.intp_t(size), nothing)
    return made._getvalue()


def _type_of(argument: Any) -> Any:
    """Type of an argument; numba makes that of an array of records anew each time, a third of the start of a run."""
    if type(argument) is np.ndarray:
        flags = argument.flags
        if flags.c_contiguous and flags.writeable and flags.aligned:
            return _type_of_array(argument.dtype, argument.ndim)
    return typeof(argument)


@lru_cache(maxsize=256)
def _type_of_array(dtype: np.dtype[Any], axes: int) -> Any:
    """Type of arrays that are laid out row by row."""
    return typeof(np.empty((1,) * axes, dtype))
