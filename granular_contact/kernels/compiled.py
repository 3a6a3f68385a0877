"""The two ways in which functions are compiled: `kernel` for callers in Python, `part` for other kernels.

What turns Python's arguments into those of compiled code is itself compiled, for every function anew, and takes as long
as the function: so only a kernel has it. Both are kept on disk. A division by zero gives an infinite number or none, as
in numpy, and no exception, whose text and branches would be compiled with every quotient. A constant among the
arguments is a number like any other, or a function would be compiled for each constant anew.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit, types
from numba.core.registry import CPUDispatcher

from granular_contact.kernels.hurry import hurried

PLAIN = {"nopython": True, "boundscheck": None, "error_model": "numpy", "no_cfunc_wrapper": True}


class _Kernel(CPUDispatcher):  # type: ignore[misc]  # numba has no types
    """A compiled function."""

    def compile(self, signature: Any) -> Any:
        """Compile it for arguments of these types, or find it on the disk."""
        with hurried():
            return super().compile(signature)

    def get_call_template(self, arguments: Any, named: Any) -> Any:
        """As called by a kernel: numba asks for the signature."""
        plain = {name: types.unliteral(kind) for name, kind in named.items()}
        return super().get_call_template(tuple(types.unliteral(kind) for kind in arguments), plain)


def kernel(function: Callable[..., Any] | None = None, *, nogil: bool = False) -> Any:
    """Compile a function that Python calls, for each kind of arguments when it first comes.

    nogil: other threads of Python run meanwhile.
    """
    if function is None:
        return lambda function: kernel(function, nogil=nogil)
    compiled = _Kernel(function, locals={}, targetoptions={"nogil": nogil, **PLAIN})
    compiled.enable_caching()
    return compiled


class _Part(_Kernel):
    """A compiled function without what callers in Python need, which it gets when one comes, at the cost of compiling.

    Without it such a call would end the process.
    """

    _called: Any = None

    def __call__(self, *arguments: Any) -> Any:
        if self._called is None:
            part = self
            self._called = njit(lambda *arguments: part(*arguments))
        return self._called(*arguments)


def part(function: Callable[..., Any] | None = None, *, cache: bool = True, inline: bool = False) -> Any:
    """Compile a function that kernels call, and Python only now and then; cache: keep it on disk.

    inline: always within its callers, so that loops over it can become vector instructions.
    """
    if function is None:
        return lambda function: part(function, cache=cache, inline=inline)
    options = {"no_cpython_wrapper": True, **PLAIN}
    if inline:
        options["forceinline"] = True
    compiled = _Part(function, locals={}, targetoptions=options)
    if cache:
        compiled.enable_caching()
    return compiled
