"""Compiled functions that a granular load calls."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.jit.compiled import ready

Vector = NDArray[np.float64]


class CompiledLoad(NamedTuple):
    """Compiled functions of `planar_sand` or `space_sand`, see there."""

    force: Callable[..., None]
    tangent: Callable[..., int]
    accept: Callable[..., None]
    update_active: Callable[..., bool]
    soonest: Callable[..., float]


@cache
def compiled_load(kernels: Any) -> CompiledLoad:
    """Compiled functions of a module of kernels, looked up once for all loads, which takes as long as some steps.

    Parameters
    ----------
    kernels : module
        `planar_sand`, `space_sand` or `space_watched`.
    """
    sand, q, triplets = np.zeros((1, 1), np.int64), np.zeros(1), np.zeros((1, 3))
    return CompiledLoad(
        ready(kernels.force, sand, q, q, q),
        ready(kernels.tangent, sand, q, q, 1.0, 1.0, triplets),
        ready(kernels.accept, sand, q, q, q, True),
        ready(kernels.update_active, sand, 0.0),
        ready(kernels.soonest, sand),
    )


def add_nothing(q: Vector, v: Vector, out: Vector) -> None:
    """Add no forces: `add_forces` of a load without contact lines.

    Parameters
    ----------
    q, v : (m,) array
        Coordinates and rates.
    out : (m,) array
        Generalised forces.
    """
