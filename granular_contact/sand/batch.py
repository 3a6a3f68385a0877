"""Contact lines in one medium, with the arrays that `kernels.batches` reads."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.laws.layer import Layer
from granular_contact.sand.contact_lines import ContactLine
from granular_contact.sand.kernels import batches as kernels
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.kinematics import SPATIAL
from granular_contact.sand.kernels.path_length import COLUMNS
from granular_contact.sand.kernels.planar_sand import LINES
from granular_contact.sand.kernels.proximity import DEEPEST, GREATEST

Vector = NDArray[np.float64]
# Attributes of a batch that are arrays of `planar_sand.LINES` of the same name.
ARRAYS = "reference", "active", "ends", "places", "geometry", "profile", "medium", "anchors", "columns", "proximity"


class Batch:
    """Contact lines in one medium, evaluated in one compiled call.

    Parameters
    ----------
    lines : sequence of ContactLine
        The lines.
    records : sequence of (1,) array
        Record of each line (`kernels.law.LINE`), with the layer of the medium.
    profile : (k, 2) array
        Corners of the surface of the medium (m).
    medium : (1,) array
        Record of the law.
    columns : sequence of (3,) array
        Columns of each line in a row of the history, see `history.HistoryTable`.
    paths : bool
        Whether path lengths of the stations are counted, see `kernels.path_length`.

    Attributes
    ----------
    anchors : (stations, 2 or 6) array
        Friction state (m).
    active : (lines,) array of bool
        Whether a line can touch the surface in this step.
    proximity : (lines, 3) array
        See `kernels.proximity`.
    """

    def __init__(
        self,
        lines: Sequence[ContactLine],
        records: Sequence[NDArray[np.void]],
        profile: Vector,
        medium: NDArray[np.void],
        columns: Sequence[Vector],
        paths: bool = False,
    ) -> None:
        self.lines = lines
        self.profile, self._law_record = profile, medium
        self.columns = np.array(columns)
        # With a dtype, NumPy does not compare the record types of every two lines field by field.
        self.geometry = np.concatenate([line.stations for line in lines], dtype=lines[0].stations.dtype)
        self.records = np.concatenate(list(records), dtype=records[0].dtype)
        sizes = [(len(line.stations), len(line.body.coordinates)) for line in lines]
        self.ends = np.concatenate([np.zeros((1, 2), np.int64), np.cumsum(sizes, axis=0)])
        self.anchors = np.zeros((len(self.geometry), COLUMNS if paths else 2))
        self.work = kernels.work(self.ends, self.anchors)
        self._forces = self.work[1][len(self.work[1]) - kernels.KEPT * len(lines) :]  # kept forces of the lines
        self.proximity = np.zeros((len(lines), 3))
        self.active = np.ones(len(lines), dtype=bool)
        self.entries = sum(len(line.body.coordinates) ** 2 for line in lines)  # upper bound of entries of a tangent
        coordinates = np.concatenate([np.asarray(line.body.coordinates, np.int64) for line in lines])
        self.places = np.column_stack([coordinates, coordinates])
        spatial = self.ends[:-1][self.geometry["kind"][self.ends[:-1, 0]] == SPATIAL, 1]
        self._euler = spatial[:, None] + np.arange(3, 7)  # places of the Euler parameters of spatial bodies
        self.reference: Vector = np.zeros(0)  # reference values, which are added to the coordinates of the system

    @cached_property
    def medium(self) -> NDArray[np.void]:
        """The medium as the kernels read it. The law is compiled when it is first used on a machine."""
        return medium_record(self._law_record, self.records, self.anchors.shape[1] > 2, spatial=self.has_spatial_bodies)

    def renew(self, law_record: NDArray[np.void]) -> None:
        """Take other coefficients of the same law; compiled functions and addresses stay.

        Parameters
        ----------
        law_record : (1,) array
            Record of the law.
        """
        self._law_record = law_record
        self.medium["own"].view(np.uint8).ravel()[: law_record.nbytes] = law_record.view(np.uint8)
        self.forget()

    def start(self, system_places: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Begin a new history; arguments as in `GranularLoad.start`.

        Returns
        -------
        (addresses,) array
            Addresses of all arrays, for the kernels.
        """
        if system_places is not None:
            self.places[:, 0] = system_places[self.places[:, 1]]
        self.active[:] = True
        self.reference = reference
        self._forces[:] = np.nan
        room, body = self.work
        arrays = {name: getattr(self, name) for name in ARRAYS}
        return LINES.addresses(arrays | {"lines": self.records, "room": room, "body": body})

    @property
    def has_spatial_bodies(self) -> bool:
        """Whether a body of the batch is a spatial one, which may lean out of the plane."""
        return len(self._euler) > 0

    def lean(self, q: Vector) -> float:
        """Sine of the greatest angle between the z axis of a spatial body and the z axis of the world.

        Parameters
        ----------
        q : (m,) array
            Coordinates of the system, without reference values.
        """
        e = (q + self.reference)[self.places[:, 0][self._euler]].T
        return float(2.0 * np.max(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3])))

    def immersed(self) -> set[tuple[str, Kind, float]]:
        """Name of the body, kind and width (m) of each line that has ever been immersed."""
        lines = [line for line, depth in zip(self.lines, self.proximity[:, GREATEST], strict=True) if depth > 0.0]
        return {(line.body.name, line.kind, float(line.record["width"][0])) for line in lines}

    def forget(self) -> None:
        """Mark the kept forces as invalid, because the state was changed from outside of the kernels."""
        self._forces[:: kernels.KEPT] = np.nan

    def state(self) -> tuple[NDArray[Any], ...]:
        """Arrays that accepted steps change, and the rates of the last force evaluations, which tangents use."""
        rates, previous = (self._forces[row :: kernels.KEPT] for row in (kernels.RATES, kernels.BEFORE))
        return self.anchors, self.proximity, self.active, rates, previous

    @property
    def depths(self) -> Vector:
        """Depth (lines,) m of the deepest station of each line at the last accepted step."""
        return self.proximity[:, DEEPEST]


def record_in_layer(layer: Layer | None, line: ContactLine, gravity: float) -> NDArray[np.void]:
    """Record of a line for a medium in a layer.

    Parameters
    ----------
    layer : Layer or None
        The layer; None for the contact of the floor.
    line : ContactLine
        The line.
    gravity : float
        Gravity (m/s2).

    Returns
    -------
    (1,) array
        `kernels.law.LINE`.
    """
    record = line.record.copy()
    if layer is not None:
        medium = layer.medium
        medium.fill_scatter(record)
        if gravity > 0.0 and record["radius"] > 0.0:
            record["behind"] = getattr(medium, "wheel_drop", 0.0) / gravity
        record["layered"], record["top"], record["bottom"] = not layer.whole, layer.top, layer.bottom
    return record
