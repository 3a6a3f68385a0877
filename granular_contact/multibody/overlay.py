"""Massless object over the nodes of many bodies, through which generalised forces reach an Exudyn system.

The engine hands a user function all coordinates of its object in Python lists, and takes the forces back in one; for a
hundred bodies that costs more than the forces. So two objects share the work. The *bell* lies on one node only: its
force function tells that forces are due. The *carrier* lies on all nodes, without a force function: its constant force
vector is set anew each time. The engine asks objects in the order in which they were added, and the bell comes first.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]


class Overlay:
    """Overlay on nodes, each with its number of coordinates, which stand one after another in it.

    constant: generalised forces that act all the time, by node. `forces`: what is to be sent.
    """

    def __init__(self, mbs: Any, nodes: Mapping[int, int], constant: Mapping[int, ArrayLike]) -> None:
        self.mbs = mbs
        self.nodes = {int(node): int(size) for node, size in nodes.items()}
        for node, forces in constant.items():
            self.nodes.setdefault(int(node), len(np.atleast_1d(forces)))
        starts = np.concatenate([[0], np.cumsum(list(self.nodes.values()))]).astype(np.int64)
        self.size = int(starts[-1])
        self._starts = dict(zip(self.nodes, starts[:-1].tolist(), strict=True))
        self.constant = np.zeros(self.size)
        for node, forces in constant.items():
            self.constant[self.places([node])] += np.asarray(forces, float)
        self.forces = self.constant.copy()
        self.empty = self.matrix(np.zeros((0, 3)))

    def places(self, nodes: Sequence[int]) -> NDArray[np.int64]:
        """Where the coordinates of some nodes stand in the overlay."""
        return np.concatenate([self._starts[n] + np.arange(self.nodes[n]) for n in map(int, nodes)])

    def attach(
        self, due: Callable[[float], None] | None = None, jacobian: Callable[[float, float, float], Any] | None = None
    ) -> None:
        """Add the objects, with no more than the constant forces unless there is something to call.

        due: told the time whenever forces are needed, before they are taken. jacobian: told time and the engine's two
        factors, gives its sparse matrix (see `matrix`).
        """
        matrix = _silence(self.size)
        if due is not None:
            first, size = next(iter(self.nodes.items()))
            self._add([first], forceUserFunction=_bell(due, size), jacobianUserFunction=_silence(size))
        if jacobian is not None:
            matrix = _tangent(jacobian)
        self._carrier = self._add(list(self.nodes), forceVector=self.forces, jacobianUserFunction=matrix)

    def _add(self, nodes: list[int], **options: Any) -> Any:
        return self.mbs.AddObject(
            items.ObjectGenericODE2(
                nodeNumbers=[exu.NodeIndex(node) for node in nodes],
                visualization=items.VObjectGenericODE2(show=False),
                **options,
            )
        )

    def send(self) -> None:
        """Let `forces` act from now on."""
        self.mbs.SetObjectParameter(self._carrier, "forceVector", self.forces)

    def matrix(self, triplets: Vector) -> Any:
        """The engine's sparse matrix of rows (row, column, value) in overlay coordinates."""
        container = exu.MatrixContainer()
        container.SetWithSparseMatrix(triplets, self.size, self.size)
        return container


def _bell(due: Callable[[float], None], size: int) -> Callable[..., list[float]]:
    nothing = [0.0] * size

    def ring(mbs: Any, t: float, item: int, q: list[float], v: list[float]) -> list[float]:  # noqa: ARG001
        due(t)
        return nothing

    return ring


def _tangent(jacobian: Callable[[float, float, float], Any]) -> Callable[..., Any]:
    def matrix(
        mbs: Any,  # noqa: ARG001
        t: float,
        item: int,  # noqa: ARG001
        q: list[float],  # noqa: ARG001
        v: list[float],  # noqa: ARG001
        factor_q: float,
        factor_v: float,
    ) -> Any:
        return jacobian(t, factor_q, factor_v)

    return matrix


def _silence(size: int) -> Callable[..., Any]:
    nothing = exu.MatrixContainer()
    nothing.SetWithSparseMatrix(np.zeros((0, 3)), size, size)
    return lambda *_: nothing
