"""Contact lines in one medium, with the arrays that `kernels.batches` reads."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.bed.contact_lines import ContactLine
from granular_contact.kernels import batches as kernels
from granular_contact.kernels.entry import entry
from granular_contact.kernels.forces import medium_record
from granular_contact.kernels.kinematics import SPATIAL
from granular_contact.kernels.lines import FIRST
from granular_contact.kernels.path_length import COLUMNS
from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]


class Batch:
    """Lines in one medium, computed in one call.

    records: of each line, with the layer that the medium lies in; profile: surface (k, 2) m of the medium; columns: for
    each line, where its numbers stand in a history row, see `history.HistoryTable`; paths: whether path lengths of the
    stations are counted, see `kernels.path_length`. anchors (stations, 2 or 6) m: the friction state; active (lines,):
    the lines that may touch the surface in this step; proximity: see `kernels.batches`.
    """

    _sand: tuple[Any, ...]  # what kernels get between the coordinates and what they fill

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
        sizes = [(len(line.stations), len(line.coordinates)) for line in lines]
        self.ends = np.concatenate([np.zeros((1, 2), np.int64), np.cumsum(sizes, axis=0)])
        self.anchors = np.zeros((len(self.geometry), COLUMNS if paths else 2))
        self.work = kernels.work(self.ends, self.anchors)
        self.proximity = np.zeros((len(lines), 3))
        self.active = np.ones(len(lines), dtype=bool)
        self.entries = sum(len(line.coordinates) ** 2 for line in lines)  # most that a tangent has
        coordinates = np.concatenate([line.coordinates for line in lines])
        self.places = np.column_stack([coordinates, coordinates])
        spatial = self.ends[:-1][self.geometry["kind"][self.ends[:-1, 0]] == SPATIAL, 1]
        self._euler = spatial[:, None] + np.arange(3, 7)  # places of the Euler parameters of spatial bodies
        self._compiled = False

    @cached_property
    def medium(self) -> NDArray[np.void]:
        """The medium as kernels read it; its law is compiled, the first time on a machine."""
        return medium_record(self._own, self.records, self.anchors.shape[1] > 2)

    def renew(self, own: NDArray[np.void]) -> None:
        """Take other coefficients of the same law, as its own record (1,); what is compiled and placed stays."""
        self._own = own
        self.medium["own"].view(np.uint8).ravel()[: own.nbytes] = own.view(np.uint8)
        self.forget()

    def start(self, q: Vector, where: NDArray[np.int64] | None, reference: Vector) -> None:
        """Reset the friction state for bodies at q; arguments as of `GranularLoad.start`."""
        if where is not None:
            self.places[:, 0] = where[self.places[:, 1]]
        at = (self.ends, self.places, self.geometry)
        sand = (*at, self.records, self.profile, self.medium, self.anchors, *self.work)
        self._sand, self._all_sand = (reference, self.active, *sand), (reference, *sand)
        self.active[:] = True
        row, found = np.zeros(FIRST), (self.columns, self.proximity)
        if not self._compiled:
            # Compiling, the first time on a machine, belongs to the start and not to the first step.
            self._force = entry(kernels.force, q, q, *self._sand, q)
            self._tangent = entry(kernels.tangent, q, q, *self._sand, 1.0, 1.0, np.zeros((0, 3)), 0)
            self._accept = entry(kernels.accept, q, q, *self._all_sand, row, *found, True)
            self._update_active = entry(kernels.update_active, self.proximity, 0.0, self.active)
            self._compiled = True
        self._accept(q, np.zeros_like(q), *self._all_sand, row, *found, True)
        self.proximity[:, kernels.EVER] = -np.inf

    @property
    def leans(self) -> bool:
        """Whether any of its bodies is a spatial one, which may lean out of the plane."""
        return len(self._euler) > 0

    def leaning(self, q: Vector) -> float:
        """Sine of the greatest angle between the z axis of a spatial body and that of the world."""
        e = (q + self._all_sand[0])[self.places[:, 0][self._euler]].T
        return float(2.0 * np.max(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3])))

    def force(self, q: Vector, v: Vector, out: Vector) -> None:
        """Add the generalised forces of the active lines to out, the coordinates of the bed."""
        self._force(q, v, *self._sand, out)

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float, triplets: Vector, number: int) -> int:
        """Append the entries of factor_q df/dq + factor_v df/dv to the first `number`; how many there are then."""
        return int(self._tangent(q, v, *self._sand, factor_q, factor_v, triplets, number))

    def accept(self, q: Vector, v: Vector, row: Vector) -> None:
        """End of a step at this state, added to a history row."""
        self._accept(q, v, *self._all_sand, row, self.columns, self.proximity, False)

    def update_active(self, step: float) -> bool:
        """Choose the lines that may touch the surface in the next step (s); whether there are any."""
        return bool(self._update_active(self.proximity, step, self.active))

    def immersed(self) -> set[tuple[str, Kind, float]]:
        """Body, kind and width (m) of the lines that were ever immersed."""
        ever = [line for line, depth in zip(self.lines, self.proximity[:, kernels.EVER], strict=True) if depth > 0.0]
        return {(line.body, line.kind, float(line.record["width"][0])) for line in ever}

    def forget(self) -> None:
        """Forces found so far are those of another state, of which kernels cannot know."""
        self.work[1][:] = np.nan

    def state(self) -> tuple[NDArray[Any], ...]:
        """What accepted steps change."""
        return self.anchors, self.proximity, self.active

    @property
    def depths(self) -> Vector:
        """Depth (lines,) m of the deepest station of each line where it was accepted last."""
        return self.proximity[:, kernels.DEEPEST]

    def soonest(self) -> float:
        """Time (s) after `accept` until the first of the lines above the surface may touch it; infinite of none."""
        depths = ((one[kernels.DEEPEST], one[kernels.APPROACH]) for one in self.proximity.tolist())
        return min((-depth / approach for depth, approach in depths if depth < 0.0 < approach), default=math.inf)
