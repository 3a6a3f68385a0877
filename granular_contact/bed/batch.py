"""Runs on bodies, and groups of them with the arrays that the kernels read; `kernels.groups` says what they are."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels import groups as kernels
from granular_contact.kernels.entry import entry
from granular_contact.kernels.law import RUN
from granular_contact.kernels.spatial import SIZE, SPATIAL_STATION
from granular_contact.media.kinds import Kind
from granular_contact.multibody.overlay import Overlay

Vector = NDArray[np.float64]
Memory = tuple[Vector, Vector]


class Run:
    """Stations on the nodes of one body, `size` coordinates in all; kind: what the media meet there."""

    def __init__(
        self, nodes: list[int], size: int, geometry: NDArray[np.void], kind: Kind, flags: dict[str, Any]
    ) -> None:
        self.nodes = nodes
        self.size = size
        self.geometry = geometry
        self.kind = kind
        self.run = np.zeros(1, RUN)
        for name, value in flags.items():
            self.run[name] = value
        if kind in ("round", "ball"):  # the width of a plate or an outline is normal to the plane
            self.run["beside"] = 0.5 * self.run["width"]
        self.body = ""


class Group:
    """Runs on one kind of body (all stations of one type) in one medium, computed in one call.

    flags: record of each run, with the layer that the medium lies in; profile: surface (k, 2) m of the medium; columns:
    for each run, where its numbers stand in a history row, see `ledger.Ledger`.
    """

    def __init__(
        self,
        runs: Sequence[Run],
        flags: Sequence[NDArray[np.void]],
        profile: Vector,
        medium: NDArray[np.void],
        columns: Sequence[Vector],
    ) -> None:
        self.nodes = [run.nodes for run in runs]
        self.kinds = [run.kind for run in runs]
        self.profile, self.medium = profile, medium
        self.columns = np.array(columns)
        self.geometry = np.concatenate([run.geometry for run in runs])
        self.runs = np.concatenate(list(flags))
        sizes = [(len(run.geometry), run.size) for run in runs]
        self.ends = np.concatenate([np.zeros((1, 2), np.int64), np.cumsum(sizes, axis=0)])
        self.anchors = np.zeros((len(self.geometry), 2))
        self.reach = np.zeros((len(runs), 3))
        self.awake = np.ones(len(runs), dtype=bool)
        self.entries = sum(run.size**2 for run in runs)
        self._places = np.zeros((self.ends[-1, 1], 2), np.int64)
        self._compiled = False

    def lay(self, overlay: Overlay) -> None:
        """Find the coordinates in the overlay."""
        self._places[:, 1] = np.concatenate([overlay.places(nodes) for nodes in self.nodes])

    def start(self, mbs: Any, q: Vector, v: Vector) -> None:
        """Find the coordinates in the assembled system; rest the bristles where the strips are."""
        data = mbs.systemData
        self._places[:, 0] = [i for nodes in self.nodes for node in nodes for i in data.GetNodeLTGODE2(node)]
        where = (self.ends, self._places, self.geometry)
        reference = data.GetODE2Coordinates(exu.ConfigurationType.Reference)
        sand = (*where, self.runs, self.profile, self.medium, self.anchors)
        self._awake_sand, self._all_sand = (reference, self.awake, *sand), (reference, *sand)
        self.awake[:] = True
        self.reach[:, kernels.EVER] = -np.inf
        kernels.release(q, reference, *where, self.anchors)
        if self._compiled:
            return
        # Compiling, the first time on a machine, belongs to the start and not to the first step.
        self._force = entry(kernels.force, q, v, *self._awake_sand, v)
        self._tangent = entry(kernels.tangent, q, v, *self._awake_sand, 1.0, 1.0, np.zeros((0, 3)), 0)
        self._accept = entry(kernels.accept, q, v, *self._all_sand, v, self.columns, self.reach)
        entry(kernels.wake, self.reach, 0.0, self.awake)
        self._compiled = True

    @property
    def is_spatial(self) -> bool:
        """Whether its bodies could leave the plane."""
        return bool(self.geometry.dtype == SPATIAL_STATION)

    def leaning(self, q: Vector) -> float:
        """Of spatial bodies: sine of the greatest angle between a body's z axis and that of the world."""
        places = self._places[:, 0].reshape(-1, SIZE)[:, 3:]
        e = (q + self._all_sand[0])[places].T
        return float(2.0 * np.max(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3])))

    def force(self, q: Vector, v: Vector, out: Vector) -> None:
        """Add the generalised forces to those of the overlay."""
        self._force(q, v, *self._awake_sand, out)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float, triplets: Vector, count: int) -> int:
        """Append the entries of factor_q df/dq + factor_v df/dv to the first `count`; how many there are then."""
        return int(self._tangent(q, v, *self._awake_sand, factor_q, factor_v, triplets, count))

    def accept(self, q: Vector, v: Vector, row: Vector) -> None:
        """End of a step at this state, added to a history row."""
        self._accept(q, v, *self._all_sand, row, self.columns, self.reach)

    def widths(self) -> list[tuple[Kind, float]]:
        """Kinds and widths (m) of the runs that were ever immersed."""
        ever = self.reach[:, kernels.EVER] > 0.0
        widths = zip(self.kinds, self.runs["width"].tolist(), ever, strict=True)
        return [(kind, width) for kind, width, touched in widths if touched]

    def nearing(self) -> list[tuple[float, float]]:
        """Of each run after `accept`: depth of its deepest station (m), greatest speed at which one goes down (m/s)."""
        return [(float(depth), float(speed)) for depth, speed in self.reach[:, [kernels.DEEPEST, kernels.NEARING]]]

    def remember(self) -> Memory:
        """Copy of all that `accept` changes, for `recall`."""
        return self.anchors.copy(), self.reach.copy()

    def recall(self, memory: Memory) -> None:
        """Undo what `accept` did since `remember`."""
        self.anchors[:], self.reach[:] = memory

    def wake(self, step: float) -> bool:
        """Choose who sleeps through the next step (s); whether anybody wakes."""
        return bool(kernels.wake(self.reach, step, self.awake))


def named(runs: Iterable[Run]) -> tuple[str, ...]:
    """Names of the bodies that runs are on, in order, each once."""
    return tuple(dict.fromkeys(run.body for run in runs))
