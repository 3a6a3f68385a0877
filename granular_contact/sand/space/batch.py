"""Elements of one kind in one medium, on all bodies that have some, with the arrays that kernels read."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.sand.kernels.ground import PLANE
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import DEEPEST, EVER
from granular_contact.sand.kernels.space_joining import space_record
from granular_contact.sand.kernels.space_law import BODIES, BODY
from granular_contact.sand.space.elements import Elements
from granular_contact.sand.space.triangles import around

Vector = NDArray[np.float64]
# Those of its arrays that kernels know by the same names.
OWN = (
    *("places", "bodies", "turn", "clusters", "elements", "anchors", "active", "ground", "poses", "proximity"),
    *("columns", "asked", "wrenches", "reference"),
)


class SpatialBatch:
    """Elements of one kind in one medium, computed in one call.

    law: class of the medium, with its record (1,) for the planar kernels; ground (4,): see `kernels.space_law`; turn
    (3, 3): from the world to the frame of the bed; columns: for each element set, as of `history.HistoryTable`. anchors
    (rows, 3) m: the friction state, with `paths` more columns, see `kernels.space_law`; layer: depths (m) that the
    medium lies between, None if it fills the bed; active (clusters,): what may touch the surface in this step; poses,
    proximity, asked, wrenches: see `kernels.space_bodies`.
    """

    def __init__(
        self,
        sets: Sequence[Elements],
        law: type,
        own: NDArray[np.void],
        ground: Vector,
        turn: Vector,
        columns: Sequence[NDArray[np.int64]],
        paths: int = 0,
        layer: tuple[float, float] | None = None,
    ) -> None:
        self.ground, self.turn = ground, turn
        mapped = len(ground) > PLANE
        self._record = partial(space_record, law, own, sets[0].meets, layer, paths=paths > 0, heights=mapped)
        grouped: dict[Any, list[Elements]] = {}
        of_bodies = []
        for one, at in zip(sets, columns, strict=True):
            if one.body.identity not in grouped:
                of_bodies.append(at)
            grouped.setdefault(one.body.identity, []).append(one)
        self.columns = np.array(of_bodies)
        self._groups = list(grouped.values())
        ordered = [one for group in self._groups for one in group]
        self.elements = np.concatenate([one.rows for one in ordered])
        self.clusters = _counted(ordered)
        self.bodies = _bodies(self._groups)
        coordinates = np.concatenate([np.asarray(group[0].body.coordinates, np.int64) for group in self._groups])
        self.places = np.column_stack([coordinates, coordinates])
        self.anchors = np.zeros((len(self.elements), 3 + paths))
        self.active = np.ones(len(self.clusters), dtype=bool)
        self.poses = np.zeros((len(self.bodies), 6, 3))
        self.proximity = np.zeros((len(self.bodies), 3))
        self.asked = np.full((len(self.bodies), 2, 7), np.nan)
        self.wrenches = np.zeros((len(self.bodies), TERMS, 6))
        self.entries = int(np.sum(self.bodies["places"] ** 2))  # most that a tangent has

    @cached_property
    def medium(self) -> NDArray[np.void]:
        """The medium as kernels read it; its law is compiled, the first time on a machine."""
        return self._record()

    @cached_property
    def _for_bodies(self) -> NDArray[np.void]:
        """The medium for the kernels of `space_bodies`."""
        return self._record(bodies=True, six=bool((self.bodies["size"] == 6).any()))

    def start(self, where: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Forget all motion; return the addresses of the arrays, for kernels; arguments as of `GranularLoad.start`."""
        if where is not None:
            self.places[:, 0] = where[self.places[:, 1]]
        self.active[:] = True
        self.anchors[:] = 0.0
        self.proximity[:] = 0.0
        self.forget()
        self.proximity[:, EVER] = -np.inf
        self.reference = reference
        own = {name: getattr(self, name) for name in OWN}
        return BODIES.addresses(own | {"medium": self._for_bodies})

    def immersed(self) -> set[tuple[str, Kind, float]]:
        """Body, kind and size (m) of the bodies that were ever immersed."""
        ever = [group for group, depth in zip(self._groups, self.proximity[:, EVER], strict=True) if depth > 0.0]
        return {(one.body.name, one.kind, one.size) for group in ever for one in group}

    @property
    def depths(self) -> Vector:
        """Depth (bodies,) m of the deepest point of each body where it was accepted last."""
        return self.proximity[:, DEEPEST]

    def forget(self) -> None:
        """As of `batch.Batch`."""
        self.asked[:, 0, 0] = np.nan

    def state(self) -> tuple[NDArray[Any], ...]:
        """What accepted steps change."""
        return self.anchors, self.poses, self.proximity, self.active


def _counted(sets: Sequence[Elements]) -> NDArray[np.void]:
    """Clusters of all sets, with their places among all rows."""
    made, row = [], 0
    for one in sets:
        clusters = one.clusters.copy()
        clusters["first"] += row
        clusters["last"] += row
        row += len(one.rows)
        made.append(clusters)
    return np.concatenate(made)


def _bodies(groups: Sequence[Sequence[Elements]]) -> NDArray[np.void]:
    """Records of bodies, each with the clusters of its sets."""
    bodies = np.zeros(len(groups), BODY)
    coordinate = cluster = 0
    for body, group in zip(bodies, groups, strict=True):
        clusters = np.concatenate([one.clusters for one in group])
        on = group[0].body
        body["size"] = body["places"] = len(on.coordinates)
        body["start"] = coordinate
        if on.piece is not None:
            body["size"], body["shape"], body["axis"] = 6, on.piece.shape, on.piece.axis
        body["first"], body["last"] = cluster, cluster + len(clusters)
        around(body, np.column_stack([clusters[name] for name in "xyz"]), clusters["radius"])
        coordinate, cluster = coordinate + body["places"], cluster + len(clusters)
    return bodies
