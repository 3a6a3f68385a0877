"""Functions chosen by the record type of an argument, as methods are chosen by the class of an object.

Kernels of surfaces call `stress(t, u, m)`: each law provides its own stress for its record type. In compiled code the
choice is made when the caller is compiled (`numba.extending.overload`) and costs nothing at run time; where nothing is
compiled it is made at each call.
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

_RECORD_TYPES: dict[np.dtype, str] = {}  # record types, each with the name of its first function
_PROVIDED: dict[tuple[Any, np.dtype], Any] = {}  # where nothing is compiled: functions by stub and record type


def chosen_by(argument: str) -> Callable[[Any], Any]:
    """Decorate a stub, for which `provide` gives functions; argument: name of the argument that is a record."""

    def decorate(stub: Any) -> Any:
        names = tuple(inspect.signature(stub).parameters)
        index = names.index(argument)

        @wraps(stub)
        def choose(*arguments):
            if COMPILES:
                raise NotImplementedError("chosen in compiled functions alone")
            return _PROVIDED[choose, arguments[index].dtype](*arguments)

        choose.index = index  # type: ignore[attr-defined]
        return choose

    return decorate


def provide(stub: Any, dtype: np.dtype, function: Any, *, inline: bool = False) -> None:
    """Let a function, plain or compiled, stand for a stub where the choosing argument has this record type.

    inline: always inlined into its callers.

    Raises
    ------
    TypeError
        This record type begins with all fields of another one, or another one with all of its fields.
    """
    plain = getattr(function, "py_func", function)
    _keep_apart(dtype, f"{plain.__module__}.{plain.__name__}")
    _PROVIDED[stub, dtype] = plain
    expected, index = from_dtype(dtype), stub.index

    def choose(*arguments):
        record = arguments[index]
        return plain if getattr(record, "dtype", record) == expected else None

    choose.__signature__ = inspect.signature(stub)  # type: ignore[attr-defined]
    chosen = {"forceinline": inline, **BY_KERNELS, **options(from_outside(plain))}
    overload(stub, jit_options=chosen)(choose)


def _fields(dtype: np.dtype) -> list[tuple[str, Any]]:
    """Names of the fields of a record type, with their types and offsets."""
    return [(name, dtype.fields[name]) for name in dtype.names]  # type: ignore[index, union-attr]


def _keep_apart(dtype: np.dtype, name: str) -> None:
    """Refuse a record type that numba would confuse with another: one of them begins with all fields of the other."""
    for other, known in _RECORD_TYPES.items():
        fields, their_fields = _fields(dtype), _fields(other)
        if dtype != other and all(a == b for a, b in zip(fields, their_fields, strict=False)):
            names, others = ([field for field, _ in both] for both in (fields, their_fields))
            raise TypeError(
                f"the records of {name}, {names}, and of {known}, {others}, begin alike to the "
                "end of the shorter one, so kernels would take one for the other: let them begin with different fields"
            )
    _RECORD_TYPES.setdefault(dtype, name)
