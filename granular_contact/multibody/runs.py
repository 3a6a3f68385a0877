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
Memory = tuple[list[tuple[Vector, Vector]], float, float, float]


class Acting:
    """One medium at work on a run: its record, where it lies, anchors of its bristles, totals (TERMS, 3) of its terms.

    run: (1,) record of the run, with the layer that the medium lies in; profile: its surface (k, 2) m; columns: where
    its numbers stand in a history row, see `ledger.Ledger`.
    """

    def __init__(self, run: NDArray[np.void], profile: Vector, medium: NDArray[np.void], columns: Vector) -> None:
        self.run, self.profile, self.medium = run, profile, medium
        self.anchors = np.zeros((0, 2))
        self.totals = np.zeros((TERMS, 3))
        self.columns = columns

    def rest(self, strips: int) -> None:
        """Make room for the anchors of so many strips."""
        self.anchors = np.zeros((strips, 2))
        self.sand = (self.run, self.profile, self.medium, self.anchors)


class Run:
    """One overlay: stations on the nodes of one body.

    kind: what the media meet there. After `accept`: depth of the deepest station (m, negative above the surface), the
    greatest speed (m/s) at which one nears the surface, and the greatest depth so far (m).
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
        self.depth, self.speed, self.deepest = -np.inf, 0.0, -np.inf
        self._out = np.zeros(size)
        self._scratch = np.zeros((TERMS, 3))
        self._matrix = np.zeros((size, size))
        self._no_matrix = _sparse(np.zeros((0, 3)), size)
        rows, columns = np.indices((size, size)).reshape(2, -1)
        self._triplets = np.column_stack([rows, columns, np.zeros(size * size)]).astype(float)

    def start(self, mbs: Any, q: Vector, v: Vector) -> None:
        """Find the run's coordinates in the assembled system; rest the bristles where the strips are."""
        data = mbs.systemData
        where = np.array([i for node in self.nodes for i in data.GetNodeLTGODE2(node)], dtype=np.int64)
        reference = data.GetODE2Coordinates(exu.ConfigurationType.Reference)[where]
        self._body = (where, reference, self.geometry)
        self.deepest = -np.inf
        for acting in self.media:
            acting.rest(len(self.geometry) - 1)
            kernels.release(q, *self._body, acting.anchors)
        # Compiling, the first time on a machine, belongs to the start and not to the first step.
        self.force(q, v)
        self.jacobian(q, v, 1.0, 1.0)

    def force(self, q: Vector, v: Vector) -> list[float]:
        """Generalised forces on the run's coordinates."""
        self._out[:] = 0.0
        for acting in self.media:
            kernels.force(q, v, *self._body, *acting.sand, self._scratch, self._out)
        forces: list[float] = self._out.tolist()
        return forces

    def jacobian(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Any:
        """factor_q df/dq + factor_v df/dv as the engine's sparse matrix."""
        if not self.awake:
            return self._no_matrix
        self._matrix[:] = 0.0
        for acting in self.media:
            kernels.tangent(q, v, *self._body, *acting.sand, factor_q, factor_v, self._matrix)
        self._triplets[:, 2] = self._matrix.ravel()
        return _sparse(self._triplets, len(self.zeros))

    def accept(self, q: Vector, v: Vector, row: Vector) -> None:
        """End of a step at this state, added to a history row."""
        # In reverse, so that depth and speed are those under the free surface: a floor comes last.
        for acting in reversed(self.media):
            self.depth, self.speed = kernels.accept(q, v, *self._body, *acting.sand, acting.totals, row, acting.columns)
        self.deepest = max(self.deepest, self.depth)

    def remember(self) -> Memory:
        """Copy of all that `accept` changes, for `recall`."""
        kept = [(acting.anchors.copy(), acting.totals.copy()) for acting in self.media]
        return kept, self.depth, self.speed, self.deepest

    def recall(self, memory: Memory) -> None:
        """Undo what `accept` did since `remember`."""
        kept, self.depth, self.speed, self.deepest = memory
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
