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


def _view(getter: str, *configuration: Any) -> cached_property[Vector]:
    """Attribute of a vector that the engine is asked for once."""

    def view(of: Views) -> Vector:
        found: Vector = getattr(of.data, getter)(*configuration, copy=False)
        return found

    return cached_property(view)


class Views:
    """Vectors of the present state and, `_before`, of the start of the step; to be made anew for each part of a solve.

    q, v, a (m,): coordinates from their reference, rates and accelerations; multipliers (k,): of the constraints.
    """

    q, q_before = _view("GetODE2Coordinates"), _view("GetODE2Coordinates", START)
    v, v_before = _view("GetODE2Coordinates_t"), _view("GetODE2Coordinates_t", START)
    a, a_before = _view("GetODE2Coordinates_tt"), _view("GetODE2Coordinates_tt", START)
    multipliers, multipliers_before = _view("GetAECoordinates"), _view("GetAECoordinates", START)

    def __init__(self, mbs: Any) -> None:
        self.data = mbs.systemData

    @cached_property
    def where(self) -> tuple[int, int, int]:
        """Addresses of the two states and their size; while these stay, all vectors do."""
        now, before = (addressof(c_char.from_buffer(one.data)) for one in (self.q, self.q_before))
        return now, before, len(self.q)
