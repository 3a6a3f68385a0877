"""Whether the functions of a law are what kernels call: looked at before anything is compiled."""

from __future__ import annotations

import dis
import inspect
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from granular_contact.laws.kinds import WORDS
from granular_contact.sand.kernels.signatures import IN_PLANE, IN_SPACE, OF_BALLS, OF_SURFACES, arguments, wanted
from granular_contact.values.strict import listed

if TYPE_CHECKING:
    from granular_contact.laws.law import Law

MOST_TERMS = 3
_SOUND: set[Any] = set()  # classes that were looked at
_POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)


def refuse_faulty(law: type[Law]) -> None:
    """Raise TypeError, one line for each fault, where a law lacks what its runs need or kernels can't call it."""
    if law in _SOUND:
        return
    faults = [f"{law.__name__}{fault}" for fault in (*_faults(law), *_faults_of_functions(law))]
    if faults:
        raise TypeError("\n".join(faults))
    _SOUND.add(law)


def _faults(law: type[Law]) -> Iterator[str]:
    lacking = [name for name in ("equation", "terms", "takes", "constants") if not hasattr(law, name)]
    if lacking:
        yield f" has no {', '.join(lacking)}; every law defines them"
        return
    for name in ("terms", "constants"):
        value = getattr(law, name)
        if not isinstance(value, tuple | list) or not all(isinstance(one, str) for one in value):
            yield f".{name}: got {value!r}, allowed is a tuple of names"
    if len(law.terms) not in range(1, MOST_TERMS + 1):
        yield f".terms: got {len(law.terms)}, allowed are 1 to {MOST_TERMS}"
    unknown = [kind for kind in law.takes if kind not in WORDS]
    if unknown or not law.takes:
        got = listed(sorted(map(str, unknown))) or "nothing"
        yield f".takes: got {got}, allowed are {listed(list(WORDS))}"
    for kinds, needed in (({"round", "flat", "outline"}, OF_SURFACES), ({"ball"}, OF_BALLS)):
        meant = sorted(kinds & set(law.takes))
        if meant and not any(hasattr(law, name) for name in needed):
            yield f" takes {listed(meant)}, but has no {wanted(needed[0])} (or another of {', '.join(needed[1:])})"


def _faults_of_functions(law: type[Law]) -> Iterator[str]:
    for name in (*IN_PLANE, *IN_SPACE):
        if hasattr(law, name) and (fault := _fault(name, getattr(law, name))):
            yield f".{name}: {fault}; wanted is a static method {wanted(name)}"


def _fault(name: str, found: Any) -> str | None:
    """What is wrong with a function of a law; None if nothing is."""
    function = getattr(found, "py_func", found)  # of one that is compiled already
    if not inspect.isfunction(function):
        return f"got {type(function).__name__}, which is no plain function"
    given, right = inspect.signature(function).parameters, arguments(name)
    shown = inspect.Signature([one.replace(annotation=inspect.Parameter.empty) for one in given.values()])
    if any(one.kind not in _POSITIONAL for one in given.values()) or len(given) != len(right):
        return f"got the arguments {shown}"
    if any(instruction.opname == "RAISE_VARARGS" for instruction in dis.get_instructions(function)):
        return "it raises or asserts, of which nobody would hear, as it is compiled to be called by its address"
    moved = [one for i, one in enumerate(given) if one in right and right.index(one) != i]
    return f"got the arguments {shown}, with {listed(moved)} at another place" if moved else None
