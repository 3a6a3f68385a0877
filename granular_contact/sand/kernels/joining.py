"""A law in plain Python -> a record type, and functions that kernels call.

Numba finds cached code on disk by the types of the arguments alone. So the record type of a law begins with a field
named after the class and the content of its file: a changed law has another type, wherever its file is.
"""

from __future__ import annotations

import hashlib
import sys
import uuid
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.chosen import provide
from granular_contact.jit.compiled import is_part, part
from granular_contact.jit.records import record_dtype
from granular_contact.sand.kernels import law, plates
from granular_contact.sand.kernels.bar_statics import component_return
from granular_contact.sand.kernels.planar_friction import radial_return
from granular_contact.sand.kernels.signatures import IN_PLANE, IN_SPACE

PARTS = {"constants", "by_component", *IN_PLANE, *IN_SPACE}  # attributes of a law that kernels depend on


def blank(owner: Any) -> NDArray[np.void]:
    """Record (1,) of a law with all numbers 0; owner as in `record_type`."""
    return np.zeros(1, record_type(owner))


@cache
def record_type(owner: Any) -> np.dtype:
    """Record type of a law; registers its functions for kernels.

    owner: class with `constants`, the names of its numbers, and static methods named as in `signatures.IN_PLANE`.
    A missing drag_anchor follows from `by_component`, a missing strip_force from the stress or the traction.
    """
    own = [(f"{owner.__name__}_{_content(owner)}", "f8"), *((name, "f8") for name in owner.constants)]
    dtype = record_dtype(own + law.FRICTION)
    if not owner.__module__.startswith(f"{__package__.partition('.')[0]}."):
        law.OWN_LAWS[dtype] = owner
    forces = {name: getattr(owner, name) for name in IN_PLANE if hasattr(owner, name)}
    if "drag_anchor" not in forces:
        forces["drag_anchor"] = component_return if owner.by_component else radial_return
    for name in sorted(forces, key=lambda name: name != "stress"):
        let_call_others(forces[name], inline=name == "stress")
    if "stress" in forces:
        provide(plates.stress, dtype, forces.pop("stress"))
        forces.setdefault("strip_force", plates.static_force)
    if "traction" in forces:
        provide(plates.traction, dtype, forces.pop("traction"))
        forces.setdefault("strip_force", plates.traction_force)
    law.LAWS[dtype] = forces
    return dtype


def _content(owner: Any) -> str:
    """Digest of the file of a class; another at each call if there is no file, as in a notebook or with `python -`."""
    file = getattr(sys.modules.get(owner.__module__), "__file__", None)
    if file is None or not Path(file).is_file():
        return uuid.uuid4().hex
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()[:12]


def let_call_others(function: Callable[..., Any], inline: bool = False) -> None:
    """Let kernels call the plain functions that a plain function calls; inline: always inlined."""
    if not isinstance(function, FunctionType) or is_part(function):  # compiled already
        return
    callers = [function]
    while callers:
        caller = callers.pop()
        others = map(caller.__globals__.get, caller.__code__.co_names)
        callers += [
            part(other, cache=False, inline=inline)
            for other in others
            if isinstance(other, FunctionType) and not is_part(other)
        ]
