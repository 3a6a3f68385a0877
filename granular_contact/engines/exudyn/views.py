"""Views of the engine's state vectors, in the engine's own memory.

The engine takes about a microsecond to return a vector, and a step needs a dozen. Each vector stays at its address
during a solve, so it is fetched once. If `engine_checks` finds that it does not, it is fetched at each use.
"""

from __future__ import annotations

from collections.abc import Iterable
from ctypes import addressof, c_char
from functools import cached_property
from typing import Any

import exudyn as exu

from granular_contact.engines.exudyn.engine_checks import abilities
from granular_contact.scene.types import Vector

START = exu.ConfigurationType.StartOfStep


def reference(mbs: Any, nodes: Iterable[int], origin: Vector) -> Vector:
    """Reference coordinates (m,) of a system, with those of the given nodes in the world frame.

    nodes: their first two coordinates are x and y. origin (2,) m: origin of the engine's coordinates in the world
    frame.
    """
    coordinates: Vector = mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference)
    for node in {int(node) for node in nodes}:
        coordinates[mbs.systemData.GetNodeLTGODE2(node)[:2]] += origin
    return coordinates


class EngineCoordinates:
    """Numbering of the coordinates of an Exudyn system; implements `mechanics.system.Coordinates`."""

    def __init__(self, mbs: Any) -> None:
        self.mbs = mbs

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.mbs.systemData.ODE2Size())

    def places(self, node: int) -> list[int]:
        """Places of the coordinates of a node in those of the system."""
        return list(self.mbs.systemData.GetNodeLTGODE2(node))

    def reference(self, node: int) -> list[float]:
        """Reference coordinates of a node, in the frame of the engine."""
        return [float(x) for x in self.mbs.GetNode(node)["referenceCoordinates"]]


class _View:
    """Attribute that fetches a vector from the engine: once, or at each use if vectors do not stay in place."""

    def __init__(self, getter: str, *configuration: Any) -> None:
        self.getter, self.configuration = getter, configuration

    def __set_name__(self, _: type, name: str) -> None:
        self.name = name

    def __get__(self, views: Views, _: type | None = None) -> Vector:
        vector: Vector = getattr(views.data, self.getter)(*self.configuration, copy=False)
        if views.live:
            vars(views)[self.name] = vector  # hides this attribute from now on
        return vector


class Views:
    """State vectors of a system, at present and (names with `_before`) at the start of the step.

    They serve for one part of a solve; each part makes new ones. q, v, a (m,): coordinates from their reference values,
    rates and accelerations. multipliers (k,): Lagrange multipliers of the constraints. live: whether the vectors are
    the engine's memory at a fixed address. Otherwise they are copies of the present values and must not be written.
    """

    q, q_before = _View("GetODE2Coordinates"), _View("GetODE2Coordinates", START)
    v, v_before = _View("GetODE2Coordinates_t"), _View("GetODE2Coordinates_t", START)
    a, a_before = _View("GetODE2Coordinates_tt"), _View("GetODE2Coordinates_tt", START)
    multipliers, multipliers_before = _View("GetAECoordinates"), _View("GetAECoordinates", START)

    def __init__(self, mbs: Any) -> None:
        self.data, self.live = mbs.systemData, abilities(mbs).views

    @cached_property
    def memory(self) -> tuple[int, int, int]:
        """Addresses of `q` and `q_before`, and their size; while these are the same, no vector has moved."""
        present, before = (addressof(c_char.from_buffer(vector.data)) for vector in (self.q, self.q_before))
        return present, before, len(self.q)
