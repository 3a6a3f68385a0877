"""Kernels called from Python without a look at the types of their arguments.

Looking at a dozen arrays takes longer than the law on a few strips, so whoever calls a kernel with arguments of the
same types thousands of times looks once.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numba import typeof


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """The kernel as compiled for arguments of these types; given others, it reads them as if they were of these."""
    types = tuple(_type_of(argument) for argument in arguments)
    if types not in kernel.overloads:  # compile() finds out too, in ten times the time
        kernel.compile(types)
    compiled: Callable[..., Any] = kernel.get_overload(types)
    return compiled


def bound(kernel: Any, *arguments: Any) -> Callable[[], Any]:
    """The kernel with all its arguments, arrays whose contents change from call to call."""
    return partial(entry(kernel, *arguments), *arguments)


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
