"""Massless object over the nodes of many bodies, through which generalised forces reach an Exudyn system.

The engine hands a user function all coordinates of its object in Python lists, and takes the forces back in one; for a
hundred bodies that costs more than the forces. So two objects share the work. The *trigger object* lies on one node
only: its force function is called when forces are needed. The *force object* lies on all nodes, without a force
function: its constant force vector is set anew each time. The engine asks objects in the order in which they were
added, and the trigger comes first. Where it does not (`engine_checks`), one object on all nodes does the work of both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import ArrayLike, NDArray

from granular_contact.engines.exudyn.engine_checks import abilities

Vector = NDArray[np.float64]


class Overlay:
    """Overlay on nodes, with their coordinates one after another; forces: what `send` applies next."""

    def __init__(self, mbs: Any) -> None:
        self.mbs = mbs
        self.nodes: dict[int, NDArray[np.int64]] = {}  # with the places of their coordinates
        self.size = 0
        self.nothing: list[float] = []  # forces of the trigger object

    def coordinates(self, nodes: Sequence[int], each: int) -> NDArray[np.int64]:
        """Indices of the coordinates of nodes, (nodes, each); adds nodes that are not in the overlay yet."""
        for node in nodes:
            if node not in self.nodes:
                self.nodes[node] = self.size + np.arange(each)
                self.size += each
        return np.array([self.nodes[node] for node in nodes])

    def attach(
        self,
        constant: Mapping[int, ArrayLike],
        due: Callable[..., list[float]] | None = None,
        jacobian: Callable[[float, float, float], Any] | None = None,
    ) -> None:
        """Add the objects, with constant forces only unless functions are given.

        constant: generalised forces that act all the time, by node. due: what the engine calls as a force function
        (system, time, object, coordinates, rates) whenever forces are needed, before they are read; it returns
        `nothing`. jacobian: called with the time and the engine's two factors, returns its sparse
        matrix (see `matrix`).
        """
        places = {node: self.coordinates([int(node)], np.size(forces))[0] for node, forces in constant.items()}
        self.constant = np.zeros(self.size)
        for node, forces in constant.items():
            self.constant[places[node]] += np.asarray(forces, float)
        self.forces = self.constant.copy()
        self.empty = self.matrix(np.zeros((0, 3)))
        self.set_forces = self.mbs.SetObjectParameter
        if due is not None and not abilities(self.mbs).order:
            self._attach_whole(due, jacobian)
            return
        if due is not None:
            first, of_first = next(iter(self.nodes.items()))
            self.nothing = [0.0] * len(of_first)
            self._due = due
            self._trigger = self._add([first], forceUserFunction=due, jacobianUserFunction=_no_tangent(len(of_first)))
        matrix = _no_tangent(self.size) if jacobian is None else _tangent(jacobian)
        # The object whose constant forces are set anew.
        self.sink = self._add(list(self.nodes), forceVector=self.forces, jacobianUserFunction=matrix)

    def _attach_whole(self, due: Callable[..., list[float]], jacobian: Callable[..., Any] | None) -> None:
        """Add one object on all nodes that is asked for forces, and hands them back in a list."""

        def forces(*asked: Any) -> list[float]:
            due(*asked)
            found: list[float] = self.forces.tolist()
            return found

        self._due, self.set_forces = forces, _leave
        matrix = _no_tangent(self.size) if jacobian is None else _tangent(jacobian)
        self.sink = self._trigger = self._add(list(self.nodes), forceUserFunction=forces, jacobianUserFunction=matrix)

    def _add(self, nodes: list[int], **options: Any) -> Any:
        return self.mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[exu.NodeIndex(node) for node in nodes],
                visualization=items.VObjectGenericODE2(show=False),
                **options,
            )
        )

    @contextmanager
    def unasked(self) -> Iterator[None]:
        """Within it the engine does not call `due`: somebody else sees to the forces wherever they are needed."""
        if self.sink == self._trigger:  # which hands the forces over
            yield
            return
        self.mbs.SetObjectParameter(self._trigger, "forceUserFunction", 0)
        try:
            yield
        finally:
            self.mbs.SetObjectParameter(self._trigger, "forceUserFunction", self._due)

    def send(self) -> None:
        """Let `forces` act from now on."""
        self.set_forces(self.sink, "forceVector", self.forces)

    def matrix(self, triplets: Vector) -> Any:
        """The engine's sparse matrix of rows (row, column, value) in overlay coordinates."""
        return _sparse(triplets, self.size)


def _leave(*_: Any) -> None:
    """In place of setting a force vector where forces are handed over in lists."""


def _tangent(jacobian: Callable[[float, float, float], Any]) -> Callable[..., Any]:
    """As the engine calls it, with its system, the object, and coordinates and rates besides."""
    return lambda _mbs, t, _item, _q, _v, factor_q, factor_v: jacobian(t, factor_q, factor_v)


def _sparse(triplets: Vector, size: int) -> Any:
    container = exu.MatrixContainer()
    container.SetWithSparseMatrix(triplets, size, size)
    return container


def _no_tangent(size: int) -> Callable[..., Any]:
    nothing = _sparse(np.zeros((0, 3)), size)
    return lambda *_: nothing
