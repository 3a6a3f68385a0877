"""Elements of one kind in one medium, on all bodies that have any, with the arrays that the kernels read."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.sand.kernels.ground import PLANE
from granular_contact.sand.kernels.law import TERMS
from granular_contact.sand.kernels.proximity import DEEPEST, GREATEST
from granular_contact.sand.kernels.space_joining import space_record
from granular_contact.sand.kernels.space_law import BODIES, BODY
from granular_contact.sand.space.elements import Elements
from granular_contact.sand.space.triangles import enclose

Vector = NDArray[np.float64]
# Attributes of a batch that are arrays of `space_law.BODIES` of the same name.
ARRAYS = (
    *("places", "bodies", "turn", "clusters", "elements", "anchors", "active", "ground", "poses", "proximity"),
    *("columns", "asked", "wrenches", "reference"),
)


class SpatialBatch:
    """Elements of one kind in one medium, evaluated in one compiled call.

    Parameters
    ----------
    sets : sequence of Elements
        Elements of shapes, all of one kind.
    law : type
        Class of the law of the medium.
    law_record : (1,) array
        Record of the law for the kernels of the plane.
    ground : (4,) or longer array
        The surface, see `kernels.ground`.
    turn : (3, 3) array
        Rotation from the world frame to the frame of the bed.
    columns : sequence of (3,) array
        Columns of each set in a row of the history, see `history.HistoryTable`.
    paths : int
        Number of additional columns of the anchors, see `kernels.space_law`.
    layer : tuple of float, optional
        Depths (m) between which the medium lies; None: it fills the bed.

    Attributes
    ----------
    anchors : (rows, 3 + paths) array
        Friction state (m).
    active : (clusters,) array of bool
        Whether a cluster can touch the surface in this step.
    poses, proximity, asked, wrenches : array
        See `kernels.space_bodies`.
    """

    def __init__(
        self,
        sets: Sequence[Elements],
        law: type,
        law_record: NDArray[np.void],
        ground: Vector,
        turn: Vector,
        columns: Sequence[NDArray[np.int64]],
        paths: int = 0,
        layer: tuple[float, float] | None = None,
    ) -> None:
        self.ground, self.turn = ground, turn
        mapped = len(ground) > PLANE
        kind = sets[0].element_kind
        self._record = partial(space_record, law, law_record, kind, layer, paths=paths > 0, heights=mapped)
        grouped: dict[Any, list[Elements]] = {}
        columns_by_body = []
        for elements, element_columns in zip(sets, columns, strict=True):
            if elements.body.identity not in grouped:
                columns_by_body.append(element_columns)
            grouped.setdefault(elements.body.identity, []).append(elements)
        self.columns = np.array(columns_by_body)
        self._groups = list(grouped.values())
        ordered = [elements for group in self._groups for elements in group]
        self.elements = np.concatenate([elements.rows for elements in ordered])
        self.clusters = _numbered_clusters(ordered)
        self.bodies = _body_records(self._groups)
        coordinates = np.concatenate([np.asarray(group[0].body.coordinates, np.int64) for group in self._groups])
        self.places = np.column_stack([coordinates, coordinates])
        self.anchors = np.zeros((len(self.elements), 3 + paths))
        self.active = np.ones(len(self.clusters), dtype=bool)
        self.poses = np.zeros((len(self.bodies), 6, 3))
        self.proximity = np.zeros((len(self.bodies), 3))
        self.asked = np.full((len(self.bodies), 2, 7), np.nan)
        self.wrenches = np.zeros((len(self.bodies), TERMS, 6))
        self.entries = int(np.sum(self.bodies["places"] ** 2))  # upper bound of entries of a tangent

    @cached_property
    def medium(self) -> NDArray[np.void]:
        """The medium as the kernels read it. The law is compiled when it is first used on a machine."""
        return self._record()

    @cached_property
    def _body_medium(self) -> NDArray[np.void]:
        """The medium as the kernels of `space_bodies` read it."""
        return self._record(bodies=True, six=bool((self.bodies["size"] == 6).any()))

    def start(self, system_places: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Begin a new history with unstretched bristles; arguments as in `GranularLoad.start`.

        Returns
        -------
        (addresses,) array
            Addresses of all arrays, for the kernels.
        """
        if system_places is not None:
            self.places[:, 0] = system_places[self.places[:, 1]]
        self.active[:] = True
        self.anchors[:] = 0.0
        self.proximity[:] = 0.0
        self.forget()
        self.proximity[:, GREATEST] = -np.inf
        self.reference = reference
        arrays = {name: getattr(self, name) for name in ARRAYS}
        return BODIES.addresses(arrays | {"medium": self._body_medium})

    def immersed(self) -> set[tuple[str, Kind, float]]:
        """Name of the body, kind and size (m) of each set on the bodies that have ever been immersed."""
        groups = [group for group, depth in zip(self._groups, self.proximity[:, GREATEST], strict=True) if depth > 0.0]
        return {(elements.body.name, elements.kind, elements.size) for group in groups for elements in group}

    @property
    def depths(self) -> Vector:
        """Upper bound (bodies,) m of the depth of each body at the last accepted step."""
        return self.proximity[:, DEEPEST]

    def forget(self) -> None:
        """Mark the kept wrenches as invalid; see `batch.Batch.forget`."""
        self.asked[:, 0, 0] = np.nan

    def state(self) -> tuple[NDArray[Any], ...]:
        """Arrays that accepted steps change."""
        return self.anchors, self.poses, self.proximity, self.active


def _numbered_clusters(sets: Sequence[Elements]) -> NDArray[np.void]:
    """Clusters of all sets, with their first and last row among the rows of all sets."""
    records, row = [], 0
    for elements in sets:
        clusters = elements.clusters.copy()
        clusters["first"] += row
        clusters["last"] += row
        row += len(elements.rows)
        records.append(clusters)
    return np.concatenate(records)


def _body_records(groups: Sequence[Sequence[Elements]]) -> NDArray[np.void]:
    """Record of each body, with its coordinates, its clusters and a sphere around them."""
    bodies = np.zeros(len(groups), BODY)
    coordinate = cluster = 0
    for body, group in zip(bodies, groups, strict=True):
        clusters = np.concatenate([elements.clusters for elements in group])
        owner = group[0].body
        body["size"] = body["places"] = len(owner.coordinates)
        body["start"] = coordinate
        if owner.piece is not None:
            body["size"], body["shape"], body["axis"] = 6, owner.piece.shape, owner.piece.axis
        body["first"], body["last"] = cluster, cluster + len(clusters)
        enclose(body, np.column_stack([clusters[name] for name in "xyz"]), clusters["radius"])
        coordinate, cluster = coordinate + body["places"], cluster + len(clusters)
    return bodies
