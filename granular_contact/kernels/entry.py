"""Kernels called from Python without a look at the types of their arguments.

Looking at a dozen arrays takes longer than the law on a few strips, so whoever calls a kernel with arguments of the
same types thousands of times looks once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import typeof


def entry(kernel: Any, *arguments: Any) -> Callable[..., Any]:
    """The kernel as compiled for arguments of these types; given others, it reads them as if they were of these."""
    types = tuple(typeof(argument) for argument in arguments)
    kernel.compile(types)
    compiled: Callable[..., Any] = kernel.get_overload(types)
    return compiled
