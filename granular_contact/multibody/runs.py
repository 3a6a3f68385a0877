"""A run: stations on one body, with the arrays that its kernels read; `kernels.runs` says what they are."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import runs as kernels
from granular_contact.kernels.law import TERMS
from granular_contact.media.kinds import Kind

Vector = NDArray[np.float64]
Memory = tuple[list[tuple[Vector, Vector]], float, float]


class Acting:
    """One medium at work on a run: its record, the anchors of its bristles and the totals (TERMS, 3) of its terms.

    columns: where its numbers stand in a history row, see `ledger.Ledger`.
    """

    def __init__(self, medium: NDArray[np.void], strips: int, columns: Vector) -> None:
        self.medium = medium
        self.anchors = np.zeros((strips, 2))
        self.totals = np.zeros((TERMS, 3))
        self.columns = columns


class Run:
    """One overlay: stations on the nodes of one body.

    kind: what the media meet there. After `accept`: depth of the deepest station (m, negative above the surface) and
    the greatest speed (m/s) at which one nears the surface.
    """

    def __init__(
        self, nodes: list[int], size: int, geometry: NDArray[np.void], kind: Kind, flags: dict[str, Any]
    ) -> None:
        self.nodes = nodes
        self.geometry = geometry
        self.kind = kind
        self.run = np.zeros(1, kernels.RUN)
        for name, value in flags.items():
            self.run[name] = value
        self.body = ""
        self.media: list[Acting] = []
        self.zeros = [0.0] * size
        self.awake = True
        self.depth, self.speed = -np.inf, 0.0
        self._out = np.zeros(size)
        self._scratch = np.zeros((TERMS, 3))
        self._matrix = np.zeros((size, size))
        self._no_matrix = _sparse(np.zeros((0, 3)), size)
        rows, columns = np.indices((size, size)).reshape(2, -1)
        self._triplets = np.column_stack([rows, columns, np.zeros(size * size)]).astype(float)

    def start(self, mbs: Any, q: Vector, v: Vector, profile: Vector) -> None:
        """Find the run's coordinates in the assembled system; rest the bristles where the strips are."""
        data = mbs.systemData
        where = np.array([i for node in self.nodes for i in data.GetNodeLTGODE2(node)], dtype=np.int64)
        reference = data.GetODE2Coordinates(exu.ConfigurationType.Reference)[where]
        self._where = (where, reference, self.geometry)
        self._body = (*self._where, self.run, profile)
        for acting in self.media:
            kernels.release(q, *self._where, acting.anchors)
        # Compiling, the first time on a machine, belongs to the start and not to the first step.
        self.force(q, v)
        self.jacobian(q, v, 1.0, 1.0)

    def force(self, q: Vector, v: Vector) -> list[float]:
        """Generalised forces on the run's coordinates."""
        self._out[:] = 0.0
        for acting in self.media:
            kernels.force(q, v, *self._body, acting.medium, acting.anchors, self._scratch, self._out)
        forces: list[float] = self._out.tolist()
        return forces

    def jacobian(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Any:
        """factor_q df/dq + factor_v df/dv as the engine's sparse matrix."""
        if not self.awake:
            return self._no_matrix
        self._matrix[:] = 0.0
        for acting in self.media:
            kernels.tangent(q, v, *self._body, acting.medium, acting.anchors, factor_q, factor_v, self._matrix)
        self._triplets[:, 2] = self._matrix.ravel()
        return _sparse(self._triplets, len(self.zeros))

    def accept(self, q: Vector, v: Vector, row: Vector) -> None:
        """End of a step at this state, added to a history row."""
        for acting in self.media:
            self.depth, self.speed = kernels.accept(
                q, v, *self._body, acting.medium, acting.anchors, acting.totals, row, acting.columns
            )

    def remember(self) -> Memory:
        """Copy of all that `accept` changes, for `recall`."""
        return [(acting.anchors.copy(), acting.totals.copy()) for acting in self.media], self.depth, self.speed

    def recall(self, memory: Memory) -> None:
        """Undo what `accept` did since `remember`."""
        kept, self.depth, self.speed = memory
        for acting, (anchors, totals) in zip(self.media, kept, strict=True):
            acting.anchors[:], acting.totals[:] = anchors, totals

    def wake(self, step: float) -> None:
        """Sleep through the next step (s) if at four times its speed the run could not touch the surface in it."""
        self.awake = self.depth + 4.0 * step * (self.speed + 10.0 * step) > -1e-3


def _sparse(triplets: Vector, size: int) -> Any:
    container = exu.MatrixContainer()
    container.SetWithSparseMatrix(triplets, size, size)
    return container


def named(runs: Iterable[Run]) -> tuple[str, ...]:
    """Names of the bodies that runs are on, in order, each once."""
    return tuple(dict.fromkeys(run.body for run in runs))
