"""A run: consecutive strips on one body, with the arrays that its kernels read; `kernels.runs` says what they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error
from granular_contact.kernels import kinematics
from granular_contact.kernels import runs as kernels

Vector = NDArray[np.float64]

# Most elements under one overlay. The engine copies all coordinates of an overlay into lists at every call, so a long
# beam is cheaper in pieces of which only those near the surface are evaluated; each piece costs a call of its own.
ELEMENTS_PER_RUN = 12


class Run:
    """One overlay: strips on the nodes of one body.

    After `accept`: depth of the deepest station (m, negative above the surface), greatest vertical speed (m/s) and
    totals (3, 3), the resultant x, y (N) and moment about the origin (N m) of each term.
    """

    def __init__(
        self, nodes: list[int], size: int, geometry: NDArray[np.void], diameter: float, flags: dict[str, Any]
    ) -> None:
        self.nodes = nodes
        self.geometry = geometry
        self.run = np.zeros(1, kernels.RUN)
        self.run["diameter"] = diameter
        for name, value in flags.items():
            self.run[name] = value
        self.anchors = np.zeros((len(geometry) - 1, 2))
        self.totals = np.zeros((3, 3))
        self.zeros = [0.0] * size
        self.awake = True
        self.depth, self.speed = -np.inf, 0.0
        self._out = np.zeros(size)
        self._scratch = np.zeros((3, 3))
        self._matrix = np.zeros((size, size))
        self._no_matrix = _sparse(np.zeros((0, 3)), size)
        rows, columns = np.indices((size, size)).reshape(2, -1)
        self._triplets = np.column_stack([rows, columns, np.zeros(size * size)]).astype(float)

    def start(self, mbs: Any, q: Vector, v: Vector, medium: NDArray[np.void]) -> None:
        """Find the run's coordinates in the assembled system; rest the bristles where the strips are."""
        data = mbs.systemData
        where = np.array([i for node in self.nodes for i in data.GetNodeLTGODE2(node)], dtype=np.int64)
        reference = data.GetODE2Coordinates(exu.ConfigurationType.Reference)[where]
        self._body = (where, reference, self.geometry)
        self._sand = (self.run, medium, self.anchors)
        kernels.release(q, *self._body, self.anchors)
        # Compiling, the first time on a machine, belongs to the start and not to the first step.
        self.force(q, v)
        self.jacobian(q, v, 1.0, 1.0)

    def force(self, q: Vector, v: Vector) -> list[float]:
        """Generalised forces on the run's coordinates."""
        kernels.force(q, v, *self._body, *self._sand, self._scratch, self._out)
        forces: list[float] = self._out.tolist()
        return forces

    def jacobian(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Any:
        """factor_q df/dq + factor_v df/dv as the engine's sparse matrix."""
        if not self.awake:
            return self._no_matrix
        kernels.tangent(q, v, *self._body, *self._sand, factor_q, factor_v, self._matrix)
        self._triplets[:, 2] = self._matrix.ravel()
        return _sparse(self._triplets, len(self.zeros))

    def accept(self, q: Vector, v: Vector, row: Vector) -> None:
        """End of a step at this state, added to a history row."""
        self.depth, self.speed = kernels.accept(q, v, *self._body, *self._sand, self.totals, row)

    def remember(self) -> tuple[Vector, Vector, float, float]:
        """Copy of all that `accept` changes, for `recall`."""
        return self.anchors.copy(), self.totals.copy(), self.depth, self.speed

    def recall(self, memory: tuple[Vector, Vector, float, float]) -> None:
        """Undo what `accept` did since `remember`."""
        self.anchors[:], self.totals[:], self.depth, self.speed = memory

    def wake(self, step: float) -> None:
        """Sleep through the next step (s) if at four times its speed the run could not touch the surface in it."""
        self.awake = self.depth + 4.0 * step * (self.speed + 10.0 * step) > -1e-3


def _sparse(triplets: Vector, size: int) -> Any:
    container = exu.MatrixContainer()
    container.SetWithSparseMatrix(triplets, size, size)
    return container


def rigid_run(
    mbs: Any, body: Any, start: Vector, end: Vector, diameter: float, strips: int, flags: dict[str, Any]
) -> Run:
    """Run on a cylinder of a RigidBody2D; see `GranularBed.add_rigid`."""
    item = mbs.GetObject(body)
    if item["objectType"] != "RigidBody2D":
        raise scene_error("bed.add_rigid", f"object {item['name']} is a {item['objectType']}, allowed is RigidBody2D")
    if not np.linalg.norm(end - start) > 0.0:
        raise scene_error("bed.add_rigid", f"start and end of the cylinder are the same point, {start.tolist()}")
    _check_diameter("bed.add_rigid", diameter)
    return Run([item["nodeNumber"]], 3, kinematics.rigid_stations(start, end, strips), diameter, flags)


def cable_run(mbs: Any, elements: Sequence[Any], diameter: float, strips: int, flags: dict[str, Any]) -> Run:
    """Run on consecutive ANCFCable2D elements; see `GranularBed.add_cables`."""
    nodes: list[int] = []
    lengths = []
    for element in elements:
        item = mbs.GetObject(element)
        if item["objectType"] != "ANCFCable2D":
            raise scene_error(
                "bed.add_cables", f"object {item['name']} is a {item['objectType']}, allowed is ANCFCable2D"
            )
        first, second = (int(node) for node in item["nodeNumbers"])
        if nodes and nodes[-1] != first:
            raise scene_error("bed.add_cables", f"{item['name']} does not start at the node where its neighbour ends")
        nodes += [second] if nodes else [first, second]
        lengths.append(item["length"])
    _check_diameter("bed.add_cables", diameter)
    return Run(nodes, 4 * len(nodes), kinematics.cable_stations(np.array(lengths), strips), diameter, flags)


def _check_diameter(where: str, diameter: float) -> None:
    if not (np.isfinite(diameter) and diameter > 0.0):
        raise scene_error(where, f"diameter: got {diameter}, allowed is a number above 0 (m)")
