"""Compiling in three quarters of numba's own time, by what it repeats.

Numba finds the type of each sum, product and element anew among all functions that an operator may stand for, of
strings, lists and sets, too: a sixth of its time. Here those of numbers and arrays are remembered. And Python's
collector of garbage looks again and again at all that is loaded, as compiling makes many small objects that live on: a
tenth. Neither changes what is compiled. Where numba has no such place any more, it takes its own time.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba import types
from numba.core.compiler_lock import global_compiler_lock
from numba.core.types.functions import BaseFunction

KINDS = (types.Number, types.Boolean, types.Array, types.BaseTuple)  # constants, whose types are their own, are numbers
_known: dict[tuple[int, tuple[Any, ...]], tuple[Any, Any]] = {}  # by function and arguments: that function, signature
_own: Any = getattr(BaseFunction, "get_call_type", None)
_depth = 0


@contextmanager
def hurried() -> Iterator[None]:
    """Compile faster inside; threads that compile wait for each other, as numba asks."""
    global _depth
    with global_compiler_lock:
        collects = _depth == 0 and gc.isenabled()
        if _depth == 0:
            gc.disable()
            if _own is not None:
                BaseFunction.get_call_type = _remembered
        _depth += 1
        try:
            yield
        finally:
            _depth -= 1
            if _depth == 0 and _own is not None:
                BaseFunction.get_call_type = _own
            if collects:
                gc.enable()


def _remembered(function: Any, context: Any, args: Any, kws: Any) -> Any:
    """Signature of a function of numba for arguments of these types, as `get_call_type` gives it."""
    if kws or not all(isinstance(kind, KINDS) for kind in args):
        return _own(function, context, args, kws)
    key = id(function), tuple(args)
    if key not in _known:
        _known[key] = function, _own(function, context, args, kws)
    return _known[key][1]
