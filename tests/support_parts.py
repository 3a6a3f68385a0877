"""Parts of kernels as tests call them: compiled, with the arguments of Python."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, cast

import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels.tree_arrays import view
from granular_contact.sand.kernels.kinematics import curved_stations


# Compiled code is kept on disk in the folder of conftest.py, which is another one after a change of any part. Functions
# of tests are compiled anew: numba would not notice that they have changed.
def _is_kept(part: Callable[..., Any]) -> bool:
    return part.__module__.startswith("granular_contact")


@cache
def called(part: Callable[..., Any]) -> Callable[..., Any]:
    """A part as kernels have it: it takes records, overflows and finds arrays as compiled code does."""
    compiled: Callable[..., Any] = njit(cache=_is_kept(part))(lambda *arguments: part(*arguments))
    return compiled


@cache
def of_tree(part: Callable[..., Any]) -> Callable[..., Any]:
    """A part that takes a view of a tree's arrays as its last argument, which here is where they are."""
    compiled = njit(cache=_is_kept(part))(lambda *arguments: part(*arguments[:-1], view(arguments[-1])))
    return cast(Callable[..., Any], compiled)


def rigid_stations(points: NDArray[np.float64], strips: int) -> NDArray[np.void]:
    """Stations of strips along straight sides, from their ends (k, 2) m."""
    ((stations, _),) = curved_stations(points, np.zeros(len(points) - 1), strips)
    return stations
