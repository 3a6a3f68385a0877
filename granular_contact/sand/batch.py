"""Contact lines in one medium, with the arrays that `kernels.batches` reads."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind
from granular_contact.sand.contact_lines import ContactLine
from granular_contact.sand.kernels import batches as kernels
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.kinematics import SPATIAL
from granular_contact.sand.kernels.path_length import COLUMNS
from granular_contact.sand.kernels.planar_sand import LINES
from granular_contact.sand.kernels.proximity import DEEPEST, EVER

Vector = NDArray[np.float64]
# Those of its arrays that kernels know by the same names.
OWN = "reference", "active", "ends", "places", "geometry", "profile", "medium", "anchors", "columns", "proximity"


class Batch:
    """Lines in one medium, computed in one call.

    records: of each line, with the layer that the medium lies in; profile: surface (k, 2) m of the medium; columns: for
    each line, where its numbers stand in a history row, see `history.HistoryTable`; paths: whether path lengths of the
    stations are counted, see `kernels.path_length`. anchors (stations, 2 or 6) m: the friction state; active (lines,):
    the lines that may touch the surface in this step; proximity: see `kernels.batches`.
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
        self.profile, self._own = profile, medium
        self.columns = np.array(columns)
        # The type is said, or numpy compares the records of every two lines field by field.
        self.geometry = np.concatenate([line.stations for line in lines], dtype=lines[0].stations.dtype)
        self.records = np.concatenate(list(records), dtype=records[0].dtype)
        sizes = [(len(line.stations), len(line.body.coordinates)) for line in lines]
        self.ends = np.concatenate([np.zeros((1, 2), np.int64), np.cumsum(sizes, axis=0)])
        self.anchors = np.zeros((len(self.geometry), COLUMNS if paths else 2))
        self.work = kernels.work(self.ends, self.anchors)
        self._forces = self.work[1][len(self.work[1]) - kernels.KEPT * len(lines) :]  # those found last
        self.proximity = np.zeros((len(lines), 3))
        self.active = np.ones(len(lines), dtype=bool)
        self.entries = sum(len(line.body.coordinates) ** 2 for line in lines)  # most that a tangent has
        coordinates = np.concatenate([np.asarray(line.body.coordinates, np.int64) for line in lines])
        self.places = np.column_stack([coordinates, coordinates])
        spatial = self.ends[:-1][self.geometry["kind"][self.ends[:-1, 0]] == SPATIAL, 1]
        self._euler = spatial[:, None] + np.arange(3, 7)  # places of the Euler parameters of spatial bodies
        self.reference: Vector = np.zeros(0)  # values that are added to the coordinates of the system

    @cached_property
    def medium(self) -> NDArray[np.void]:
        """The medium as kernels read it; its law is compiled, the first time on a machine."""
        return medium_record(self._own, self.records, self.anchors.shape[1] > 2, spatial=self.leans)

    def renew(self, own: NDArray[np.void]) -> None:
        """Take other coefficients of the same law, as its own record (1,); what is compiled and placed stays."""
        self._own = own
        self.medium["own"].view(np.uint8).ravel()[: own.nbytes] = own.view(np.uint8)
        self.forget()

    def start(self, where: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Begin anew, with arguments as of `GranularLoad.start`; return the addresses of all arrays, for kernels."""
        if where is not None:
            self.places[:, 0] = where[self.places[:, 1]]
        self.active[:] = True
        self.reference = reference
        self._forces[:] = np.nan
        room, body = self.work
        own = {name: getattr(self, name) for name in OWN}
        return LINES.addresses(own | {"lines": self.records, "room": room, "body": body})

    @property
    def leans(self) -> bool:
        """Whether any of its bodies is a spatial one, which may lean out of the plane."""
        return len(self._euler) > 0

    def leaning(self, q: Vector) -> float:
        """Sine of the greatest angle between the z axis of a spatial body and that of the world."""
        e = (q + self.reference)[self.places[:, 0][self._euler]].T
        return float(2.0 * np.max(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3])))

    def immersed(self) -> set[tuple[str, Kind, float]]:
        """Body, kind and width (m) of the lines that were ever immersed."""
        ever = [line for line, depth in zip(self.lines, self.proximity[:, EVER], strict=True) if depth > 0.0]
        return {(line.body.name, line.kind, float(line.record["width"][0])) for line in ever}

    def forget(self) -> None:
        """Forces found so far are those of another state, of which kernels cannot know."""
        self._forces[:: kernels.KEPT] = np.nan

    def state(self) -> tuple[NDArray[Any], ...]:
        """What accepted steps change, and the rates at which forces were asked for, which tangents look back to."""
        rates, before = (self._forces[row :: kernels.KEPT] for row in (kernels.RATES, kernels.BEFORE))
        return self.anchors, self.proximity, self.active, rates, before

    @property
    def depths(self) -> Vector:
        """Depth (lines,) m of the deepest station of each line where it was accepted last."""
        return self.proximity[:, DEEPEST]
