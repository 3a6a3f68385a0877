"""A law in plain Python -> what kernels call: a record type, and its forces in place of the stubs of `law`.

numba compiles the functions of a law into the kernels that call them, when it compiles those; what it keeps on disk it
finds again by the types of the arguments alone. So the record type of a law begins with a field named after the file of
the law and its content: a law that was changed has another type, wherever its file is.
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
from numba.extending import register_jitable
from numpy.typing import NDArray

from granular_contact.kernels import balls, law, plates, strips
from granular_contact.kernels.bar_statics import component_return
from granular_contact.kernels.planar_friction import radial_return

STUBS = {one.__name__: one for one in (law.strip_force, law.cap_force, law.ball_force, law.drag_anchor, plates.stress)}
PARTS = {"constants", "by_component", *STUBS}  # of a law, that make it another one for the kernels
FRICTION = [("friction", "i8"), ("u_y", "f8"), ("tau", "f8"), ("v_eps", "f8")]
_called: set[FunctionType] = set()


def blank(owner: Any) -> NDArray[np.void]:
    """Record (1,) of a law with all numbers 0; owner as in `record_type`."""
    return np.zeros(1, record_type(owner))


@cache
def record_type(owner: Any) -> np.dtype:
    """Record type of a law, which the kernels know from then on.

    owner: class with `constants`, the names of its numbers, and static methods named as STUBS; what it leaves out of
    anchors and static forces follows from `by_component` and from its stress.
    """
    own = [(f"{owner.__name__}_{_content(owner)}", "f8"), *((name, "f8") for name in owner.constants)]
    dtype = np.dtype(own + FRICTION)
    forces = {name: getattr(owner, name) for name in STUBS if hasattr(owner, name)}
    if "drag_anchor" not in forces:
        forces["drag_anchor"] = component_return if owner.by_component else radial_return
    if "stress" in forces:
        forces.setdefault("strip_force", plates.static_force)
    for name, function in forces.items():
        _let_call_others(function)
        law.provide(STUBS[name], "m", dtype)(function)
    if "ball_force" in forces:
        balls.ball_law(dtype)
    else:
        strips.line_law(dtype, caps="cap_force" in forces)
    return dtype


def _content(owner: Any) -> str:
    """Digest of the file of a class; another one every time where there is no file, as in a notebook."""
    file = getattr(sys.modules.get(owner.__module__), "__file__", None)
    return uuid.uuid4().hex if file is None else hashlib.sha256(Path(file).read_bytes()).hexdigest()[:12]


def _let_call_others(function: Callable[..., Any]) -> None:
    """Let compiled code call the plain functions that a plain function calls."""
    if not isinstance(function, FunctionType):  # compiled already
        return
    for name in function.__code__.co_names:
        other = function.__globals__.get(name)
        if isinstance(other, FunctionType) and other not in _called:
            _called.add(other)
            register_jitable(other)
            _let_call_others(other)
