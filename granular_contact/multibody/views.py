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

    @cached_property
    def where(self) -> tuple[int, int, int]:  # noqa: D102
        return (
            addressof(c_char.from_buffer(self.q.data)),
            addressof(c_char.from_buffer(self.q_before.data)),
            len(self.q),
        )

    @cached_property
    def q(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates(copy=False)  # type: ignore[no-any-return]

    @cached_property
    def v(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates_t(copy=False)  # type: ignore[no-any-return]

    @cached_property
    def a(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates_tt(copy=False)  # type: ignore[no-any-return]

    @cached_property
    def multipliers(self) -> Vector:  # noqa: D102
        return self._data.GetAECoordinates(copy=False)  # type: ignore[no-any-return]

    @cached_property
    def q_before(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates(START, copy=False)  # type: ignore[no-any-return]

    @cached_property
    def v_before(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates_t(START, copy=False)  # type: ignore[no-any-return]

    @cached_property
    def a_before(self) -> Vector:  # noqa: D102
        return self._data.GetODE2Coordinates_tt(START, copy=False)  # type: ignore[no-any-return]

    @cached_property
    def multipliers_before(self) -> Vector:  # noqa: D102
        return self._data.GetAECoordinates(START, copy=False)  # type: ignore[no-any-return]
