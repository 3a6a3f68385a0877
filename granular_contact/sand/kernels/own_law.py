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
    """One sentence that says why a law can't be compiled; owner as of `joining.record_type`, dtype of its record.

    error: raised by the compilation, named if each function compiles by itself.
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
            yield f"{name}{_place(error)}: {_of_constant(owner, error) or _first_line(error)}"
            continue
        given = compiled.nopython_signatures[0].return_type
        if count and _shape(given) != ((2,) if count == 2 else ()) + (2 if name in IN_PLANE else 3,):
            yield f"{name} gives {given}, wanted is {wanted(name)}"


def _kinds(name: str, record: Any) -> tuple[Any, ...]:
    """Types of the arguments of a law's function."""
    if name in _SPACE_NAMES:
        found = space_law.SIGNATURES[_SPACE_NAMES[name]][0]
    elif name in law.SIGNATURES:
        found = law.SIGNATURES[name][0]
    else:
        vector = types.UniTuple(types.float64, 2 if name in IN_PLANE else 3)
        return (*(vector if one in VECTORS else types.float64 for one in arguments(name)[:-1]), record)
    return tuple(record if kind is OWN else kind for kind in found)


def _shape(given: Any) -> tuple[int, ...]:
    """Shape of a tuple of numbers or of such tuples, by its type; empty of anything else."""
    if not isinstance(given, types.BaseTuple) or len({_shape(one) for one in given}) != 1:
        return ()
    return (len(given), *_shape(given[0]))


def _of_constant(owner: Any, error: Exception) -> str | None:
    """Of a constant that the law does not have: Numba raises the KeyError of its own table."""
    if isinstance(error, KeyError) and isinstance(error.args[0], str):
        return f"m has no {error.args[0]!r}; the law's constants are {', '.join(owner.constants)}"
    return None


def _first_line(error: Exception) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    told = [line for line in lines if not line.startswith("Failed in nopython mode")]
    return told[0] if told else type(error).__name__


def _place(error: Exception) -> str:
    """File and line that Numba names last, in brackets; empty where it names none."""
    found = _LOCATION.findall(str(error))
    return f" ({found[-1][0]}:{found[-1][1]})" if found else ""
