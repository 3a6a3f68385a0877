"""The engine's vectors in its own memory.

The engine takes about a microsecond to hand one out, and a step asks for a dozen. They stay where they are for as long
as a solve goes on, so that each is asked for once.
"""

from __future__ import annotations

from collections.abc import Iterable
from ctypes import addressof, c_char
from functools import cached_property
from typing import Any

import exudyn as exu

from granular_contact.scene.types import Vector

START = exu.ConfigurationType.StartOfStep


def reference(mbs: Any, nodes: Iterable[int], origin: Vector) -> Vector:
    """Reference coordinates (m,) of a system; those of the nodes, which begin with x and y, in the world frame.

    origin (2,) m, world frame: that of the engine's coordinates.
    """
    found: Vector = mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference)
    for node in {int(node) for node in nodes}:
        found[mbs.systemData.GetNodeLTGODE2(node)[:2]] += origin
    return found


class Views:
    """Vectors of the present state and, `_before`, of the start of the step; to be made anew for each part of a solve.

    q, v, a (m,): coordinates from their reference, rates and accelerations; multipliers (k,): of the constraints.
    where: addresses of the two states and their size; while these stay, all vectors do.
    """

    def __init__(self, mbs: Any) -> None:
        self._data = mbs.systemData

    def _view(self, getter: str, *configuration: Any) -> Vector:
        view: Vector = getattr(self._data, getter)(*configuration, copy=False)
        return view

    @cached_property
    def where(self) -> tuple[int, int, int]:
        now, before = (addressof(c_char.from_buffer(one.data)) for one in (self.q, self.q_before))
        return now, before, len(self.q)

    @cached_property
    def q(self) -> Vector:
        return self._view("GetODE2Coordinates")

    @cached_property
    def v(self) -> Vector:
        return self._view("GetODE2Coordinates_t")

    @cached_property
    def a(self) -> Vector:
        return self._view("GetODE2Coordinates_tt")

    @cached_property
    def multipliers(self) -> Vector:
        return self._view("GetAECoordinates")

    @cached_property
    def q_before(self) -> Vector:
        return self._view("GetODE2Coordinates", START)

    @cached_property
    def v_before(self) -> Vector:
        return self._view("GetODE2Coordinates_t", START)

    @cached_property
    def a_before(self) -> Vector:
        return self._view("GetODE2Coordinates_tt", START)

    @cached_property
    def multipliers_before(self) -> Vector:
        return self._view("GetAECoordinates", START)
