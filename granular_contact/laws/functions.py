"""Check that the functions of a law are what the kernels call, before anything is compiled."""

from __future__ import annotations

import dis
import inspect
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.sand.kernels.signatures import IN_PLANE, IN_SPACE, OF_BALLS, OF_SURFACES, arguments, wanted
from granular_contact.values.strict import listed

if TYPE_CHECKING:
    from granular_contact.laws.law import Law

MOST_TERMS = 3
_CHECKED: set[Any] = set()  # classes without a fault
_POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


def check_law(law: type[Law]) -> None:
    """Check that the class of a law is complete, and that kernels can call its functions.

    Parameters
    ----------
    law : type of Law
        The class. A class that passed is not checked again.

    Raises
    ------
    TypeError
        With one line for each fault.
    """
    if law in _CHECKED:
        return
    faults = [f"{law.__name__}{fault}" for fault in (*_faults(law), *_faults_of_functions(law))]
    if faults:
        raise TypeError("\n".join(faults))
    _CHECKED.add(law)


def _faults(law: type[Law]) -> Iterator[str]:
    """Faults of the attributes of a law."""
    missing = [name for name in ("equation", "terms", "takes", "constants") if not hasattr(law, name)]
    if missing:
        yield f" has no {', '.join(missing)}; every law defines them"
        return
    for name in ("terms", "constants"):
        value = getattr(law, name)
        if not isinstance(value, tuple | list) or not all(isinstance(item, str) for item in value):
            yield f".{name}: got {value!r}, allowed is a tuple of names"
    if len(law.terms) not in range(1, MOST_TERMS + 1):
        yield f".terms: got {len(law.terms)}, allowed are 1 to {MOST_TERMS}"
    unknown = [kind for kind in law.takes if kind not in SHAPE_NAMES]
    if unknown or not law.takes:
        got = listed(sorted(map(str, unknown))) or "nothing"
        yield f".takes: got {got}, allowed are {listed(list(SHAPE_NAMES))}"
    for kinds, forces in (({"round", "flat", "outline"}, OF_SURFACES), ({"ball"}, OF_BALLS)):
        taken = sorted(kinds & set(law.takes))
        if taken and not any(hasattr(law, name) for name in forces):
            yield f" takes {listed(taken)}, but has no {wanted(forces[0])} (or another of {', '.join(forces[1:])})"


def _faults_of_functions(law: type[Law]) -> Iterator[str]:
    """Faults of the functions of a law."""
    for name in (*IN_PLANE, *IN_SPACE):
        if hasattr(law, name) and (fault := _fault(name, getattr(law, name))):
            yield f".{name}: {fault}; wanted is a static method {wanted(name)}"


def _fault(name: str, attribute: Any) -> str | None:
    """Describe what is wrong with a function of a law; None if it is right."""
    function = getattr(attribute, "py_func", attribute)  # the plain function, if numba has compiled it already
    if not inspect.isfunction(function):
        return f"got {type(function).__name__}, which is no plain function"
    parameters, expected = inspect.signature(function).parameters, arguments(name)
    signature = inspect.Signature([p.replace(annotation=inspect.Parameter.empty) for p in parameters.values()])
    if any(p.kind not in _POSITIONAL for p in parameters.values()) or len(parameters) != len(expected):
        return f"got the arguments {signature}"
    if any(instruction.opname == "RAISE_VARARGS" for instruction in dis.get_instructions(function)):
        return "it raises or asserts, of which nobody would hear, as it is compiled to be called by its address"
    misplaced = [name for i, name in enumerate(parameters) if name in expected and expected.index(name) != i]
    return f"got the arguments {signature}, with {listed(misplaced)} at another place" if misplaced else None
