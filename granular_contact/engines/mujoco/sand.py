"""What of a bed is the same for all data of a model: elements in space or lines in the plane, and media.

Both kinds are called alike. Signs are those of `kernels.added_mass`; a state is a list of arrays that a
step changes.
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
State = list[tuple[Vector, NDArray[np.bool_]]]  # of each batch: anchors, and what may be touched in this step


@dataclass(frozen=True)
class _Part:
    """Elements of one kind in one medium, as kernels take them; of_bed (k,): places of the bodies that lines or bodies
    of the batch are on; reaches (k,) m: how far each reaches from the origin of its frame; inner: their records.
    """

    of_bed: NDArray[np.int64]
    bristle: NDArray[np.void]
    batch: Any
    inner: NDArray[np.void]
    rows: int
    reaches: Vector


class Sand(ABC):
    """What both kinds share; sizes (bodies,): how far bodies reach from the origins of their frames (m).

    facings (bodies, 3): of bodies in a plane, see `kernels.planar_added_mass`; 0 in space.
    yields (m): least displacement at which bristles yield; without bristles infinite.
    """

    def __init__(self, parts: list[_Part], bodies: int) -> None:
        self.parts, self.sizes, self.facings = parts, np.zeros(bodies), np.zeros((bodies, 3))
        for part in parts:
            np.maximum.at(self.sizes, part.of_bed, part.reaches)
        held = [float(part.bristle["u_y"][0]) for part in parts if part.bristle["friction"][0] != SMOOTH]
        self.yields = min(held, default=np.inf)

    def state(self) -> State:
        """A new state."""
        return [(np.zeros_like(part.batch.anchors), np.ones(len(part.inner), bool)) for part in self.parts]

    @staticmethod
    def _arrays(part: _Part, state: tuple[Vector, NDArray[np.bool_]], held: Any, bed: Any, *own: str) -> dict[str, Any]:
        """Arrays of a part in a state of its own, as kernels know them; own: those that its batch has by such names."""
        anchors, active = state
        of_step = {"of_bed": part.of_bed, "bristle": part.bristle, "held": held, "bed": bed}
        return of_step | {"anchors": anchors, "active": active} | {name: getattr(part.batch, name) for name in own}

    @abstractmethod
    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """A call for each batch, with the records of `kernels.held_bodies`."""


class SpatialSand(Sand):
    """Elements of a `SpatialLoad` whose bodies have seven coordinates each, one after another."""

    def __init__(self, load: Any, static: Elastoplastic | Smooth) -> None:
        self.met = load.batch_media
        pairs = zip(load.batch_media, load.batches, strict=True)
        parts = [_part(batch, bristle_of(static, m, batch)) for m, batch in pairs]
        super().__init__(parts, 1 + max(int(part.of_bed.max()) for part in parts))

    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """As of `Sand`."""
        found = []
        own = "bodies", "clusters", "elements", "ground", "medium"
        for medium, part, now in zip(self.met, self.parts, state, strict=True):
            arrays = self._arrays(part, now, held, bed, *own) | {"inner": part.inner}
            found.append(bound(self._kernel(medium), space_added_mass.BATCH.addresses(arrays), part.rows, keep=arrays))
        return found

    @staticmethod
    def _kernel(medium: Any) -> Any:
        """The kernel for a medium; None: for contact with a floor."""
        if medium is not None:
            return space_added_mass.act
        from granular_contact.engines.mujoco.kernels import floor_added_mass

        return floor_added_mass.act


def _part(batch: Any, bristle: NDArray[np.void]) -> _Part:
    bar = bool((batch.clusters["width"] > 0.0).any() and not batch.clusters["mass"].any())
    inner = batch.clusters
    if bar:
        inner = batch.clusters.copy()
        inner["cap"] = False
    b = batch.bodies
    far = b["radius"] + np.sqrt(b["x"] ** 2 + b["y"] ** 2 + b["z"] ** 2)
    return _Part(batch.places[b["start"], 1] // 7, bristle, batch, inner, 2 if bar else 1, far)


class PlanarSand(Sand):
    """Lines of a `GranularLoad` whose bodies have three coordinates each, one after another; facings as of kernels."""

    def __init__(self, load: GranularLoad, static: Elastoplastic | Smooth, facings: Vector) -> None:
        met = zip(load.batch_media, load.batches, strict=True)
        parts = [_line_part(batch, bristle_of(static, m, batch)) for m, batch in met]
        super().__init__(parts, len(facings))
        self.facings = facings

    def calls(self, state: State, held: Any, bed: Any) -> list[Callable[[], None]]:
        """As of `Sand`."""
        found = []
        own = "ends", "geometry", "profile", "medium"
        for part, now in zip(self.parts, state, strict=True):
            arrays = self._arrays(part, now, held, bed, *own) | {"reaches": part.reaches, "lines": part.inner}
            found.append(bound(planar_added_mass.act, planar_added_mass.BATCH.addresses(arrays), keep=arrays))
        return found


def _line_part(batch: Any, bristle: NDArray[np.void]) -> _Part:
    firsts = batch.ends[:-1, 1]
    radii = np.hypot(batch.geometry["x"], batch.geometry["y"])
    reaches = np.maximum.reduceat(radii, batch.ends[:-1, 0]) + batch.records["drop"]
    return _Part(batch.places[firsts, 1] // 3, bristle, batch, batch.records, 1, reaches)


def bristle_of(static: Elastoplastic | Smooth, medium: Any, batch: Any) -> NDArray[np.void]:
    """Record (1,) of `kernels.added_mass.BRISTLE` for a medium; None: contact with the floor, which has no bristle."""
    record = np.zeros(1, BRISTLE)
    record["u_y"] = record["v_eps"] = 1.0
    static.fill(record)
    names = batch.medium.dtype.names or ()
    record["pressed"] = batch.medium["pressed"] if "pressed" in names else 0.0
    record["parted"] = bool(getattr(medium, "by_component", False))
    return record
