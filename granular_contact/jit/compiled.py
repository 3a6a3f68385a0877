"""Decorators of compiled functions: `kernel` for functions that Python calls, `part` for functions that kernels call.

A kernel is numba's `njit`. A part remains a Python function, and kernels call a compiled form of it
(`numba.extending.register_jitable`): this saves the wrapper that converts Python arguments, a tenth of all compilation.
Python can run a part as it is written, unless it calls by address (`calls`). Both are cached on disk.

Division by zero gives inf or nan, as in numpy, and no exception, whose text and branches would be compiled with each
division. Neither gets a C wrapper, which is a tenth of all compilation, too: functions called by address get one in
`calls`.

Products and sums are rounded separately. With fused multiply-add (LLVM's "contract") runs in space would take 6 to 8 %
less time. But copies of a function inlined into several callers would round differently, and the process that compiles
would get other numbers, by round-off, than processes that read its code from the cache.

References to arrays are not counted (numba's option `_nrt`), as arrays outlive the call that takes them. Reference
counts would make a run of a tree 8 to 12 % longer. So a function that makes arrays has to declare it (`allocates`), and
no function returns an array.

With NUMBA_DISABLE_JIT=1 in the environment both leave the function as it is, and Python runs all code: to follow a run
in a debugger, a hundred times slower. Code that has to differ then is in this room alone, and tests COMPILES.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from numba import config, njit, typeof
from numba.extending import register_jitable

from granular_contact.jit import compiling

COMPILES = not config.DISABLE_JIT
PLAIN = {"error_model": "numpy"}
BY_KERNELS = {"no_cfunc_wrapper": True}  # no C wrapper
_parts: set[Any] = set()
compiling.listen()


def kernel(function: Callable[..., Any] | None = None, *, nogil: bool = False, allocates: bool = False) -> Any:
    """Compile a function for each combination of argument types at its first call.

    nogil: release Python's lock, so that other threads run meanwhile; allocates: the function makes arrays.
    """
    if function is None:
        return lambda function: kernel(function, nogil=nogil, allocates=allocates)
    return njit(function, cache=True, nogil=nogil, **BY_KERNELS, **options(allocates))


def part(
    function: Callable[..., Any] | None = None, *, cache: bool = True, inline: bool = False, allocates: bool = False
) -> Any:
    """Let kernels call a function, compiled for each combination of argument types; cache: keep the code on disk.

    inline: always inlined into its callers, so that loops over it can become vector instructions; allocates: the
    function makes arrays, none of which it returns.
    """
    if function is None:
        return lambda function: part(function, cache=cache, inline=inline, allocates=allocates)
    _parts.add(function)
    return register_jitable(cache=cache, forceinline=inline, **BY_KERNELS, **options(allocates))(function)


def from_outside(function: Callable[..., Any]) -> bool:
    """Return whether a function is from outside the package, such as one of a user's law: it may make arrays."""
    return not str(function.__module__).startswith("granular_contact.")


def options(allocates: bool = False) -> dict[str, Any]:
    """Options of numba for a function; allocates: as in `kernel`."""
    return {**PLAIN, "_nrt": allocates}


def is_part(function: Callable[..., Any]) -> bool:
    """Return whether a Python function is a part already."""
    return function in _parts


def ready(function: Any, *arguments: Any) -> Any:
    """The kernel, compiled for arguments of these types, so that the first step of a solve does not compile it."""
    if COMPILES:
        function.compile(tuple(map(typeof, arguments)))
    return function


def bound(function: Any, *arguments: Any, keep: object = None) -> Callable[[], Any]:
    """The kernel bound to its arguments and compiled for them: arrays whose contents change from call to call.

    keep: objects that have to live as long as the bound kernel, as the arrays whose addresses it takes.
    """
    call = partial(ready(function, *arguments), *arguments)
    vars(call)["keep"] = keep
    return call
