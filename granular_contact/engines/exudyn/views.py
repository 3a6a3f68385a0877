"""The engine's vectors in its own memory.

The engine takes about a microsecond to hand one out, and a step asks for a dozen. They stay where they are for as long
as a solve goes on, so that each is asked for once. Where they do not (`engine_checks`) each is asked for every time.
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
    """Reference coordinates (m,) of a system; those of the nodes, which begin with x and y, in the world frame.

    origin (2,) m, world frame: that of the engine's coordinates.
    """
    found: Vector = mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Reference)
    for node in {int(node) for node in nodes}:
        found[mbs.systemData.GetNodeLTGODE2(node)[:2]] += origin
    return found


class EngineCoordinates:
    """How an Exudyn system numbers its coordinates, as `mechanics.system.Coordinates` asks."""

    def __init__(self, mbs: Any) -> None:
        self.mbs = mbs

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.mbs.systemData.ODE2Size())

    def places(self, node: int) -> list[int]:
        """Places of the coordinates of a node."""
        return list(self.mbs.systemData.GetNodeLTGODE2(node))

    def reference(self, node: int) -> list[float]:
        """Reference values of a node."""
        return [float(x) for x in self.mbs.GetNode(node)["referenceCoordinates"]]


class _View:
    """Attribute of a vector that the engine is asked for once, or each time where vectors do not stay."""

    def __init__(self, getter: str, *configuration: Any) -> None:
        self.getter, self.configuration = getter, configuration

    def __set_name__(self, _: type, name: str) -> None:
        self.name = name

    def __get__(self, of: Views, _: type | None = None) -> Vector:
        found: Vector = getattr(of.data, self.getter)(*self.configuration, copy=False)
        if of.stay:
            vars(of)[self.name] = found  # found there from now on
        return found


class Views:
    """Vectors of the present state and, `_before`, of the start of the step; to be made anew for each part of a solve.

    q, v, a (m,): coordinates from their reference, rates and accelerations; multipliers (k,): of the constraints.
    stay: whether they are the engine's memory and stay where they are; else they are of the instant, to be read only.
    """

    q, q_before = _View("GetODE2Coordinates"), _View("GetODE2Coordinates", START)
    v, v_before = _View("GetODE2Coordinates_t"), _View("GetODE2Coordinates_t", START)
    a, a_before = _View("GetODE2Coordinates_tt"), _View("GetODE2Coordinates_tt", START)
    multipliers, multipliers_before = _View("GetAECoordinates"), _View("GetAECoordinates", START)

    def __init__(self, mbs: Any) -> None:
        self.data, self.stay = mbs.systemData, abilities(mbs).views

    @cached_property
    def where(self) -> tuple[int, int, int]:
        """Addresses of the two states and their size; while these stay, all vectors do."""
        now, before = (addressof(c_char.from_buffer(one.data)) for one in (self.q, self.q_before))
        return now, before, len(self.q)
