"""Massless objects on the nodes of many bodies, through which generalised forces reach an Exudyn system.

The engine passes all coordinates of an object to its force function in Python lists, and takes the forces from a list;
for a hundred bodies that costs more than the forces themselves. So two objects share the work. The *trigger object*
lies on one node only: the engine calls its force function when it needs forces. The *force object* lies on all nodes
and has no force function: its constant force vector is set anew in each call of the trigger. This relies on the engine
evaluating objects in the order in which they were added, with the trigger first. If `engine_checks` finds another
order, one object on all nodes does the work of both.
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
    """Overlay on nodes of a system; the coordinates of its nodes are numbered one after another.

    nodes: places of the coordinates of each node in the overlay. size: number m of coordinates. forces (m,):
    generalised forces that `send` passes to the engine, constant ones included. constant (m,): forces that always act.
    no_force: forces of the trigger object, all zero. zero_matrix: tangent of an overlay without forces.
    """

    def __init__(self, mbs: Any) -> None:
        self.mbs = mbs
        self.nodes: dict[int, NDArray[np.int64]] = {}
        self.size = 0
        self.no_force: list[float] = []

    def coordinates(self, nodes: Sequence[int], size: int) -> NDArray[np.int64]:
        """Places (nodes, size) of the coordinates of nodes; nodes that the overlay does not have yet are added."""
        for node in nodes:
            if node not in self.nodes:
                self.nodes[node] = self.size + np.arange(size)
                self.size += size
        return np.array([self.nodes[node] for node in nodes])

    def attach(
        self,
        constant: Mapping[int, ArrayLike],
        trigger: Callable[..., list[float]] | None = None,
        jacobian: Callable[[float, float, float], Any] | None = None,
    ) -> None:
        """Add the objects to the system, with constant forces alone unless functions are given.

        constant: generalised forces that always act, by node. trigger: force function of the trigger object, called
        with system, time, object, coordinates and rates whenever the engine needs forces and before it reads them; it
        sends the forces and returns `no_force`. jacobian: called with the time and the engine's two factors, returns
        the engine's sparse matrix (see `matrix`).
        """
        places = {node: self.coordinates([int(node)], np.size(forces))[0] for node, forces in constant.items()}
        self.constant = np.zeros(self.size)
        for node, forces in constant.items():
            self.constant[places[node]] += np.asarray(forces, float)
        self.forces = self.constant.copy()
        self.zero_matrix = self.matrix(np.zeros((0, 3)))
        self.set_parameter = self.mbs.SetObjectParameter
        if trigger is not None and not abilities(self.mbs).order:
            self._attach_one_object(trigger, jacobian)
            return
        if trigger is not None:
            first, first_places = next(iter(self.nodes.items()))
            count = len(first_places)
            self.no_force = [0.0] * count
            self._trigger = trigger
            tangent = _no_tangent(count)
            self._trigger_object = self._add([first], forceUserFunction=trigger, jacobianUserFunction=tangent)
        tangent = _no_tangent(self.size) if jacobian is None else _tangent(jacobian)
        self.force_object = self._add(list(self.nodes), forceVector=self.forces, jacobianUserFunction=tangent)

    def _attach_one_object(self, trigger: Callable[..., list[float]], jacobian: Callable[..., Any] | None) -> None:
        """Add one object on all nodes, whose force function returns the forces in a list."""

        def force_function(*arguments: Any) -> list[float]:
            trigger(*arguments)
            forces: list[float] = self.forces.tolist()
            return forces

        self._trigger, self.set_parameter = force_function, _ignore
        tangent = _no_tangent(self.size) if jacobian is None else _tangent(jacobian)
        self.force_object = self._trigger_object = self._add(
            list(self.nodes), forceUserFunction=force_function, jacobianUserFunction=tangent
        )

    def _add(self, nodes: list[int], **options: Any) -> Any:
        """Add a massless object on nodes; returns its number."""
        return self.mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[exu.NodeIndex(node) for node in nodes],
                visualization=items.VObjectGenericODE2(show=False),
                **options,
            )
        )

    @contextmanager
    def untriggered(self) -> Iterator[None]:
        """Context within which the engine does not call the trigger: the caller sends forces before each residual."""
        if self.force_object == self._trigger_object:  # this one object has to return the forces
            yield
            return
        self.mbs.SetObjectParameter(self._trigger_object, "forceUserFunction", 0)
        try:
            yield
        finally:
            self.mbs.SetObjectParameter(self._trigger_object, "forceUserFunction", self._trigger)

    def send(self) -> None:
        """Pass `forces` to the engine; they act until the next call."""
        self.set_parameter(self.force_object, "forceVector", self.forces)

    def matrix(self, triplets: Vector) -> Any:
        """The engine's sparse matrix of triplets (k, 3): row, column (in overlay coordinates) and value."""
        return _sparse(triplets, self.size)


def _ignore(*_: Any) -> None:
    """Stands in place of `SetObjectParameter` if the force function returns the forces."""


def _tangent(jacobian: Callable[[float, float, float], Any]) -> Callable[..., Any]:
    """Jacobian function with the arguments that the engine passes."""
    return lambda _mbs, t, _item, _q, _v, factor_q, factor_v: jacobian(t, factor_q, factor_v)


def _sparse(triplets: Vector, size: int) -> Any:
    container = exu.MatrixContainer()
    container.SetWithSparseMatrix(triplets, size, size)
    return container


def _no_tangent(size: int) -> Callable[..., Any]:
    """Jacobian function of an object without stiffness and damping."""
    zero = _sparse(np.zeros((0, 3)), size)
    return lambda *_: zero
