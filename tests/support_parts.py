"""Parts of kernels as tests call them: compiled, with the arguments of Python."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from granular_contact.engines.tree.kernels.tree_arrays import view
from granular_contact.sand.kernels.kinematics import curved_stations


@cache
def called(part: Callable[..., Any]) -> Callable[..., Any]:
    """A part as kernels have it: it takes records, overflows and finds arrays as compiled code does."""
    compiled: Callable[..., Any] = njit(lambda *arguments: part(*arguments))
    return compiled


@cache
def of_tree(part: Callable[..., Any]) -> Callable[..., Any]:
    """A part that takes a view of a tree's arrays as its last argument, which here is where they are."""
    compiled: Callable[..., Any] = njit(lambda *arguments: part(*arguments[:-1], view(arguments[-1])))
    return compiled


def rigid_stations(points: NDArray[np.float64], strips: int) -> NDArray[np.void]:
    """Stations of strips along straight sides, from their ends (k, 2) m."""
    ((stations, _),) = curved_stations(points, np.zeros(len(points) - 1), strips)
    return stations
