"""Error of a law from outside the package that can't be compiled, in one sentence instead of a page of Numba's."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from numba import from_dtype, njit, types

from granular_contact.jit.calls import OWN
from granular_contact.jit.compiled import PLAIN
from granular_contact.sand.kernels import law, space_law
from granular_contact.sand.kernels.signatures import IN_PLANE, IN_SPACE, VECTORS, arguments, wanted

_SPACE_NAMES = {"bar_force": "bar", "bar_cap": "cap", "space_ball_force": "ball"}
_LOCATION = re.compile(r'File "([^"]+)", line (\d+)')


def why_not(owner: Any, dtype: np.dtype, error: Exception) -> str:
    """One sentence that says why a law can't be compiled; owner as in `joining.record_type`, dtype of its record.

    error: exception of the compilation, which is quoted if each function compiles by itself.
    """
    reasons = "; ".join(_reasons(owner, from_dtype(dtype))) or _first_line(error)
    return f"the law {owner.__name__} can't be compiled: {reasons}"


def _reasons(owner: Any, record: Any) -> Iterator[str]:
    for name, (_, count) in (IN_PLANE | IN_SPACE).items():
        if (function := getattr(owner, name, None)) is None:
            continue
        kinds = _kinds(name, record)
        try:
            compiled = njit(getattr(function, "py_func", function), **PLAIN)
            compiled.compile(kinds)
        except Exception as error:
            yield f"{name}{_place(error)}: {_unknown_constant(owner, error) or _first_line(error)}"
            continue
        returned = compiled.nopython_signatures[0].return_type
        if count and _shape(returned) != ((2,) if count == 2 else ()) + (2 if name in IN_PLANE else 3,):
            yield f"{name} gives {returned}, wanted is {wanted(name)}"


def _kinds(name: str, record: Any) -> tuple[Any, ...]:
    """Types of the arguments of a law's function."""
    if name in _SPACE_NAMES:
        kinds = space_law.SIGNATURES[_SPACE_NAMES[name]][0]
    elif name in law.SIGNATURES:
        kinds = law.SIGNATURES[name][0]
    else:
        vector = types.UniTuple(types.float64, 2 if name in IN_PLANE else 3)
        return (*(vector if argument in VECTORS else types.float64 for argument in arguments(name)[:-1]), record)
    return tuple(record if kind is OWN else kind for kind in kinds)


def _shape(kind: Any) -> tuple[int, ...]:
    """Shape of a tuple of numbers or of such tuples, from its type; empty for any other type."""
    if not isinstance(kind, types.BaseTuple) or len({_shape(entry) for entry in kind}) != 1:
        return ()
    return (len(kind), *_shape(kind[0]))


def _unknown_constant(owner: Any, error: Exception) -> str | None:
    """Message for a constant that the law does not have, for which Numba raises a KeyError; else None."""
    if isinstance(error, KeyError) and isinstance(error.args[0], str):
        return f"m has no {error.args[0]!r}; the law's constants are {', '.join(owner.constants)}"
    return None


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    messages = [line for line in lines if not line.startswith("Failed in nopython mode")]
    return messages[0] if messages else type(error).__name__


def _place(error: Exception) -> str:
    """Last file and line that Numba names, in brackets; empty if it names none."""
    locations = _LOCATION.findall(str(error))
    return f" ({locations[-1][0]}:{locations[-1][1]})" if locations else ""
