"""Functions that are chosen by the record type of an argument, as methods are by the class of an object.

Kernels of surfaces call `stress(t, u, m)`: each law has one of its own, and gives it for its record type.
Compiled, the choice is made when the caller is compiled (`numba.extending.overload`) and costs nothing; where nothing
is compiled it is made at each call.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np
from numba import from_dtype
from numba.extending import overload

from granular_contact.jit.compiled import BY_KERNELS, COMPILES, from_outside, options

_KNOWN: dict[np.dtype, str] = {}  # record types, with the function that came first
_GIVEN: dict[tuple[Any, np.dtype], Any] = {}  # where nothing is compiled: functions, by what they stand for


def chosen_by(argument: str) -> Callable[[Any], Any]:
    """Decorate a function without a body, that stands for those given to it by `provide`; argument: a record's name."""

    def decorate(stub: Any) -> Any:
        names = tuple(inspect.signature(stub).parameters)
        place = names.index(argument)

        @wraps(stub)
        def choose(*arguments):
            if COMPILES:
                raise NotImplementedError("chosen in compiled functions alone")
            return _GIVEN[choose, arguments[place].dtype](*arguments)

        choose.place = place  # type: ignore[attr-defined]
        return choose

    return decorate


def provide(stub: Any, dtype: np.dtype, function: Any, *, inline: bool = False) -> None:
    """Let a function, plain or compiled, be what `stub` means where the argument it is chosen by has a record type.

    inline: always within its callers.

    Raises
    ------
    TypeError
        One record type begins with all the fields of another.
    """
    plain = getattr(function, "py_func", function)
    _keep_apart(dtype, f"{plain.__module__}.{plain.__name__}")
    _GIVEN[stub, dtype] = plain
    expected, place = from_dtype(dtype), stub.place

    def choose(*arguments):
        given = arguments[place]
        return plain if getattr(given, "dtype", given) == expected else None

    choose.__signature__ = inspect.signature(stub)  # type: ignore[attr-defined]
    told = {"forceinline": inline, **BY_KERNELS, **options(from_outside(plain))}
    overload(stub, jit_options=told)(choose)


def _fields(dtype: np.dtype) -> list[tuple[str, Any]]:
    """Names of the fields of a record type, with their types and places."""
    return [(name, dtype.fields[name]) for name in dtype.names]  # type: ignore[index, union-attr]


def _keep_apart(dtype: np.dtype, name: str) -> None:
    """Refuse a record type that numba would take for another: one that begins with all the fields of the other."""
    for other, known in _KNOWN.items():
        one, two = _fields(dtype), _fields(other)
        if dtype != other and all(a == b for a, b in zip(one, two, strict=False)):
            names, others = ([field for field, _ in each] for each in (one, two))
            raise TypeError(
                f"the records of {name}, {names}, and of {known}, {others}, begin alike to the "
                "end of the shorter one, so kernels would take one for the other: let them begin with different fields"
            )
    _KNOWN.setdefault(dtype, name)
