"""Elements in space, or lines in the plane, with their media: the part of a bed that all data of a model share.

Both kinds have the same interface, `Sand`. A state holds the arrays that a step changes.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.mujoco.kernels import planar_added_mass, space_added_mass
from granular_contact.engines.mujoco.kernels.added_mass import BRISTLE
from granular_contact.jit.compiled import bound
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.kernels.friction import SMOOTH
from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
State = list[tuple[Vector, NDArray[np.bool_]]]  # of each batch: anchors, and what may touch the surface in this step


@dataclass(frozen=True)
class _HeldBatch:
    """A batch of elements of one kind in one medium, with what the kernels of this room need beside it.

    held_places (k,): places in held of the k bodies, in the plane of the bodies of the k lines. bristle (1,): BRISTLE.
    records: of its clusters without free end faces, in the plane of its lines. rows: number of rows of an element.
    reaches (k,) m: largest distance of each body, or line, from the origin of the body's frame.
    """

    held_places: NDArray[np.int64]
    bristle: NDArray[np.void]
    batch: Any
    records: NDArray[np.void]
    rows: int
    reaches: Vector


class Sand(ABC):
    """Sand on the bodies of a model.

    sizes (bodies,) m: largest distance of the shapes of each body from the origin of its frame. facings (bodies, 3): of
    bodies in a plane, see `kernels.planar_added_mass`; 0 in space. yield_displacement (m): smallest one of all
    bristles; infinite without bristles.
    """

    def __init__(self, held_batches: list[_HeldBatch], bodies: int) -> None:
        self.held_batches, self.sizes, self.facings = held_batches, np.zeros(bodies), np.zeros((bodies, 3))
        for held_batch in held_batches:
            np.maximum.at(self.sizes, held_batch.held_places, held_batch.reaches)
        displacements = [
            float(held_batch.bristle["u_y"][0])
            for held_batch in held_batches
            if held_batch.bristle["friction"][0] != SMOOTH
        ]
        self.yield_displacement = min(displacements, default=np.inf)

    def state(self) -> State:
        """A new state: unstretched bristles, and everything may touch."""
        return [
            (np.zeros_like(held_batch.batch.anchors), np.ones(len(held_batch.records), bool))
            for held_batch in self.held_batches
        ]

    @staticmethod
    def _arrays(
        held_batch: _HeldBatch, state: tuple[Vector, NDArray[np.bool_]], held: Any, bed: Any, *names: str
    ) -> dict[str, Any]:
        """Arrays of a batch in a state, by the names that kernels use; names: attributes of the batch among them."""
        anchors, active = state
        step_arrays = {"held_places": held_batch.held_places, "bristle": held_batch.bristle, "held": held, "bed": bed}
        batch_arrays = {name: getattr(held_batch.batch, name) for name in names}
        return step_arrays | {"anchors": anchors, "active": active} | batch_arrays

    @abstractmethod
    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """Compiled functions, one for each batch, that process a step of a state.

        held (bodies,), bed (1,): records of `kernels.held_bodies`, which the functions read and write.
        """


class SpatialSand(Sand):
    """Elements of a `SpatialLoad` whose bodies have seven coordinates each, one after another."""

    def __init__(self, load: Any, static: Elastoplastic | Smooth) -> None:
        self.media = load.batch_media
        pairs = zip(load.batch_media, load.batches, strict=True)
        held_batches = [_spatial_batch(batch, bristle_record(static, medium, batch)) for medium, batch in pairs]
        super().__init__(held_batches, 1 + max(int(held_batch.held_places.max()) for held_batch in held_batches))

    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """As in `Sand`."""
        calls = []
        names = "bodies", "clusters", "elements", "ground", "medium"
        for medium, held_batch, batch_state in zip(self.media, self.held_batches, state, strict=True):
            arrays = self._arrays(held_batch, batch_state, held, bed, *names) | {"inner_clusters": held_batch.records}
            calls.append(
                bound(self._kernel(medium), space_added_mass.BATCH.addresses(arrays), held_batch.rows, keep=arrays)
            )
        return calls

    @staticmethod
    def _kernel(medium: Any) -> Any:
        """Kernel for a medium; medium: None for contact with a floor."""
        if medium is not None:
            return space_added_mass.act
        from granular_contact.engines.mujoco.kernels import floor_added_mass

        return floor_added_mass.act


def _spatial_batch(batch: Any, bristle: NDArray[np.void]) -> _HeldBatch:
    """A batch in space; its bodies have seven coordinates each."""
    is_bar = bool((batch.clusters["width"] > 0.0).any() and not batch.clusters["mass"].any())
    inner_clusters = batch.clusters
    if is_bar:
        inner_clusters = batch.clusters.copy()
        inner_clusters["cap"] = False
    bodies = batch.bodies
    reaches = bodies["radius"] + np.sqrt(bodies["x"] ** 2 + bodies["y"] ** 2 + bodies["z"] ** 2)
    rows = 2 if is_bar else 1
    return _HeldBatch(batch.places[bodies["start"], 1] // 7, bristle, batch, inner_clusters, rows, reaches)


class PlanarSand(Sand):
    """Lines of a `GranularLoad` whose bodies have three coordinates each, one after another.

    facings (bodies, 3): see `kernels.planar_added_mass`.
    """

    def __init__(self, load: GranularLoad, static: Elastoplastic | Smooth, facings: Vector) -> None:
        pairs = zip(load.batch_media, load.batches, strict=True)
        held_batches = [_planar_batch(batch, bristle_record(static, medium, batch)) for medium, batch in pairs]
        super().__init__(held_batches, len(facings))
        self.facings = facings

    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """As in `Sand`."""
        calls = []
        names = "ends", "geometry", "profile", "medium"
        for held_batch, batch_state in zip(self.held_batches, state, strict=True):
            arrays = self._arrays(held_batch, batch_state, held, bed, *names)
            arrays |= {"reaches": held_batch.reaches, "lines": held_batch.records}
            calls.append(bound(planar_added_mass.act, planar_added_mass.BATCH.addresses(arrays), keep=arrays))
        return calls


def _planar_batch(batch: Any, bristle: NDArray[np.void]) -> _HeldBatch:
    """A batch of lines in the plane; their bodies have three coordinates each."""
    first_coordinates = batch.ends[:-1, 1]
    radii = np.hypot(batch.geometry["x"], batch.geometry["y"])
    reaches = np.maximum.reduceat(radii, batch.ends[:-1, 0]) + batch.records["drop"]
    return _HeldBatch(batch.places[first_coordinates, 1] // 3, bristle, batch, batch.records, 1, reaches)


def bristle_record(static: Elastoplastic | Smooth, medium: Any, batch: Any) -> NDArray[np.void]:
    """Record (1,) of `kernels.added_mass.BRISTLE` for a medium; medium: None for a floor, which has no bristles."""
    record = np.zeros(1, BRISTLE)
    record["u_y"] = record["v_eps"] = 1.0
    static.fill(record)
    names = batch.medium.dtype.names or ()
    record["pressed"] = batch.medium["pressed"] if "pressed" in names else 0.0
    record["by_component"] = bool(getattr(medium, "by_component", False))
    return record
