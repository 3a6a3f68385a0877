"""How functions are compiled: `kernel` for those that Python calls, `part` for those that kernels call.

A kernel is numba's `njit`. A part stays the function of Python that it is, of which kernels take a compiled form
(`numba.extending.register_jitable`): what turns arguments of Python into those of compiled code would be compiled with
each part, a tenth of all compiling. Python would run a part as it is written; one that calls by address (`calls`) it
can't. Both are kept on disk. A division by zero gives an infinite number or none, as in numpy, and no exception, whose
text and branches would be compiled with every quotient. Neither is a C function as well, which would be compiled with
each of them, a tenth of all compiling: what is called by address is one (`calls`).

Each product and each sum is rounded. Were both rounded as one where the processor can (LLVM's "contract"), runs in
space would take 6 to 8 % less; but copies of one function within several compiled ones would be rounded otherwise, and
the process that compiles would have other numbers than those that read its code, by round-off.

Nobody counts references to arrays (numba's option `_nrt`), as arrays outlive the call that they are passed to. Counted,
a run of a tree takes 8 to 12 % longer. So a function that makes arrays has to say so, and none gives an array back.

With NUMBA_DISABLE_JIT=1 in the environment both leave the function as it is, and Python runs all of it: to follow a
run in a debugger, a hundred times as slow. What has to differ then is in this room alone, and goes by COMPILES.
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
BY_KERNELS = {"no_cfunc_wrapper": True}  # of what kernels call
_parts: set[Any] = set()
compiling.listen()


def kernel(function: Callable[..., Any] | None = None, *, nogil: bool = False, allocates: bool = False) -> Any:
    """Compile a function for each kind of arguments when it first comes.

    nogil: other threads of Python run meanwhile; allocates: whether it makes arrays.
    """
    if function is None:
        return lambda function: kernel(function, nogil=nogil, allocates=allocates)
    return njit(function, cache=True, nogil=nogil, **BY_KERNELS, **options(allocates))


def part(
    function: Callable[..., Any] | None = None, *, cache: bool = True, inline: bool = False, allocates: bool = False
) -> Any:
    """Let kernels call a function, compiled for each kind of arguments; cache: keep that on disk.

    inline: always within its callers, so that loops over it can become vector instructions; allocates: whether it makes
    arrays, none of which it gives back.
    """
    if function is None:
        return lambda function: part(function, cache=cache, inline=inline, allocates=allocates)
    _parts.add(function)
    return register_jitable(cache=cache, forceinline=inline, **BY_KERNELS, **options(allocates))(function)


def from_outside(function: Callable[..., Any]) -> bool:
    """Whether a function is none of this package, as that of a user's law: it may make arrays."""
    return not str(function.__module__).startswith("granular_contact.")


def options(allocates: bool = False) -> dict[str, Any]:
    """Options of numba for a function; allocates: as of `kernel`."""
    return {**PLAIN, "_nrt": allocates}


def is_part(function: Callable[..., Any]) -> bool:
    """Whether kernels can call a function of Python already."""
    return function in _parts


def ready(function: Any, *arguments: Any) -> Any:
    """The kernel itself, compiled for arguments of these types: compiling is no part of the first step of a solve."""
    if COMPILES:
        function.compile(tuple(map(typeof, arguments)))
    return function


def bound(function: Any, *arguments: Any, keep: object = None) -> Callable[[], Any]:
    """The kernel with all its arguments, compiled for them: arrays whose contents change from call to call.

    keep: what has to live as long as this function, as the arrays whose addresses a kernel is given.
    """
    found = partial(ready(function, *arguments), *arguments)
    vars(found)["keep"] = keep
    return found
