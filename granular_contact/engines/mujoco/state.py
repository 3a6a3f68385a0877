"""Saved state of a bed with one MjData, and its recorded history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class BedState:
    """Saved state of a bed with one MjData: with MuJoCo's own state, all that later steps depend on.

    `BedData.state` gives it; `MujocoBed.restore` and `BedData.restore` return to it.

    Attributes
    ----------
    time : float or None
        Time (s) of the last call; None before the first.
    accepted : int
        Number of accepted steps.
    arrays : tuple of arrays
        Friction state, loads, twists and work, see `Step.kept`.
    rows : (n, columns) array
        Rows of the history; none without `record`.
    """

    time: float | None
    accepted: int
    arrays: tuple[NDArray[Any], ...]
    rows: Vector


@dataclass(frozen=True)
class History:
    """History of a bed with one MjData, one entry for each step (`MujocoBed(..., record=True)`).

    Attributes
    ----------
    time : (n,) array
        Time (s) at the start of the step.
    work : (n,) array
        Work (J) of the sand on all bodies up to that time.
    depth : (n,) array
        Depth (m) of the deepest point at that time; negative above the surface.
    bodies : (n, bodies, 6) array
        Force (N) and moment about the world origin (N m) on each body during the step, world frame.
    body_names : tuple of str
        Names of the bodies.
    """

    time: Vector
    work: Vector
    depth: Vector
    bodies: Vector
    body_names: tuple[str, ...]
