"""The granular load on bodies in space: forces at a state, its tangent, accepted steps, history."""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.laws.catalogue import LAWS
from granular_contact.laws.floor import Floor, InSpace
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.bed_arguments import check_floor, check_slope, direction, layers_from
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.history import SPACE, HistoryTable
from granular_contact.sand.kernels import facet_paths, space_sand
from granular_contact.sand.kernels.facets import SIDE
from granular_contact.sand.kernels.space_joining import kinds_of, owner_of
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space import elements
from granular_contact.sand.space.batch import SpatialBatch
from granular_contact.sand.space.heights import Heights
from granular_contact.sand.space.round_shapes import Sphere
from granular_contact.sand.space.shapes import Bar, Shape
from granular_contact.sand.space.triangles import COST, FACET_SIZE, MOST_FACETS

Vector = NDArray[np.float64]
WORDS = {"surface": "surfaces", "bar": "a Bar", "ball": "a Sphere"}


class SpatialLoad(GranularLoad):
    """One medium, or several whose forces add, that act on surfaces, bars and balls in space.

    It sees bodies as one vector of coordinates q (m,) with rates v (m,), and gives generalised forces (m,): of a body
    its position x, y, z (m) and four Euler parameters, or three Tait-Bryan angles (rad) with R = R_x R_y R_z. In all
    else as `GranularLoad`.

    Parameters
    ----------
    medium, gravity, static, end_cap, floor
        As of `GranularBed`, with its errors.
    surface : float
        Height of the surface along `up` (m), where it is level; else at the world origin.
    up : (3,) array
        Direction against which depth is counted and gravity acts on the medium, in the world frame.
    slope : (3,) array or 0
        Rise of the surface per length along each axis of the world; what lies along `up` does not count.
    heights : Heights, optional
        A map of heights above such a surface; for a bed whose `up` is z.
    watch : bool
        Whether the history has how far what is immersed reaches along x and y.
    spread : float
        Over how much more of its bristles' yield the loading of a face that rests is spread.
    """

    def __init__(
        self,
        medium: Law | Layer | Sequence[Law | Layer],
        surface: ArrayLike,
        *,
        up: ArrayLike = (0.0, 0.0, 1.0),
        slope: ArrayLike = 0.0,
        heights: Heights | None = None,
        gravity: float = 9.81,
        static: Elastoplastic | Smooth | None = None,
        end_cap: bool = False,
        floor: Floor | None = None,
        watch: bool = False,
        spread: float = 1.0,
    ) -> None:
        self.watch = watch
        layers = layers_from(medium, "distributed")
        for one in (layer.medium for layer in layers):
            if one.scatters and kinds(one) != ["surface"]:
                words = "has scatter, which in space is for laws of surfaces; allowed is none"
                raise ValueError(f"medium: {one.name} {words}")
            for key in one.lacking_in_space:
                raise ValueError(f"medium: {one.name} has no {key}, but in space a number is needed there")
        self._set_common(layers, static, gravity, floor)
        for record in self.records:
            record["pressed"] *= spread
        self.turn = turn_to(up)
        self.ground = _ground(surface, slope, self.turn)
        check_slope(self.media, math.hypot(*self.ground[1:3]))
        if heights is None and not self.ground[1:3].any():
            check_floor(floor, float(self.ground[0]))
        if heights is not None:
            self.ground = np.concatenate([self.ground, heights.numbers])
            self.ground[3] = np.sqrt(1.0 + heights.steepest**2)
        self.resultant, self.end_cap = False, end_cap
        self._cut: dict[Any, tuple[Shape, elements.Cut]] = {}  # see `_surface`

    @property
    def kernels(self) -> Any:
        """As of `GranularLoad`; those of a bed with walls also see how far what is immersed reaches."""
        if self.watch:
            from granular_contact.sand.kernels import space_watched

            return space_watched
        return space_sand

    def add_shape(
        self,
        body: Body,
        shape: Shape,
        position: ArrayLike = (0.0, 0.0, 0.0),
        rotation: ArrayLike | None = None,
        *,
        facet_size: float | None = None,
        accuracy: float | None = None,
        share: float = 1.0,
        mass: float | None = None,
    ) -> None:
        """Let the media act on a shape of a body; arguments as of `GranularBed.add_body`, mass (kg): of the body.

        accuracy: the error of the motion that facets may cause, as a part of the way, where they have no size; share:
        of either size, which is taken.

        Raises
        ------
        SceneError
            No medium takes such a shape, it is not where a shape can be, or the list is closed.
        """
        self.check_open()
        if not isinstance(shape, Shape):
            raise scene_error("bed", f"shape: got {shape!r}, allowed is a shape, such as Box((0.1, 0.1, 0.05))")
        began = time.perf_counter()
        place, turn = elements.place_of(position), elements.turn_of(rotation)
        if facet_size is not None and not (np.isfinite(facet_size) and facet_size > 0.0):
            raise scene_error("bed", f"facet_size: got {facet_size}, allowed is a number above 0 (m)")
        made = []
        for meets in self._met_as(shape):
            if meets == "ball":
                self._check_whole()
            if meets == "surface":
                made.append(elements.surface(body, self._surface(shape, facet_size, accuracy, share), place, turn))
            elif isinstance(shape, Bar):
                made.append(elements.bar(body, shape, place, turn))
                made[-1].clusters["cap"] &= self.end_cap
            elif isinstance(shape, Sphere):
                made.append(elements.ball(body, shape, place, mass))
        count = sum(len(one.rows) for one in (*self.lines, *made) if one.meets == "surface")
        if count > MOST_FACETS:
            words = f"got {count:,} facets in all; allowed are {MOST_FACETS:,}, which take {COST}: larger facets, or"
            raise scene_error(FACET_SIZE, f"{words} fewer shapes in the sand (in_sand: false)")
        self.lines += [replace(one, again=i > 0) for i, one in enumerate(made)]
        self.table = self._new_table()
        self.building_s += time.perf_counter() - began

    def _surface(self, shape: Shape, size: float | None, accuracy: float | None, share: float) -> elements.Cut:
        """Facets of a shape, cut once for all bodies that share it; arguments as of `elements.cut`."""
        key = id(shape), size, accuracy, share
        if key not in self._cut:
            self._cut[key] = shape, elements.cut(shape, size, accuracy, share)
        return self._cut[key][1]

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Nothing: no door takes a map of heights."""
        yield from ()

    def _met_as(self, shape: Shape) -> list[str]:
        """As what the media meet a shape: surface, bar or ball."""
        can = {"bar"} if isinstance(shape, Bar) else {"surface", "ball"} if isinstance(shape, Sphere) else {"surface"}
        found: list[str] = [
            kind for kind in ("surface", "bar", "ball") if kind in can and any(kind in kinds(m) for m in self.media)
        ]
        if not found:
            known = "; ".join(
                f"{m.name} takes {' and '.join(WORDS[k] for k in kinds(m)) or 'nothing'}" for m in self.media
            )
            raise scene_error("bed", f"in space nothing acts on a {type(shape).__name__}: {known}")
        return found

    def close(self) -> None:
        """Form the batches, of the elements that the floor or one medium meets as one kind; `start` does it too."""
        self._cut.clear()
        if self.floor is not None:
            ground, owner = np.array([self.floor.height, 0.0, 0.0, 1.0]), self.floor.record_in_space()
            for kind in dict.fromkeys(one.meets for one in self.lines):
                sets = [_two_sided(one) for one in self.lines if one.meets == kind and not one.again]
                self._form(len(self.media), None, sets, (InSpace, owner, ground))
        for index, (layer, record) in enumerate(zip(self.layers, self.records, strict=True)):
            medium = layer.medium
            drop = float(getattr(medium, "surface_drop", 0.0))
            ground = self.ground.copy()
            ground[0] -= drop
            between = None if layer.whole else (max(0.0, layer.top - drop), max(0.0, layer.bottom - drop))
            for kind in kinds(medium):
                paths = 0
                if kind == "surface":
                    paths = facet_paths.COLUMNS - 3 if medium.scatters else 0
                    paths += facet_paths.SHEARED if medium.shear_grows else 0
                sets = [one for one in self.lines if one.meets == kind]
                self._form(index, medium, sets, (owner_of(type(medium)), record, ground), paths=paths, layer=between)
        self.room_for_tangents = np.zeros((sum(batch.entries for batch in self.batches), 3))

    def _form(
        self,
        index: int,
        medium: Law | None,
        sets: Sequence[elements.Elements],
        met: tuple[Any, NDArray[np.void], Vector],
        **options: Any,
    ) -> None:
        """Add the batch of what a medium, the one of this number, or the floor (None) meets, if there is anything.

        met, options: law, its record and the surface, and what else a `SpatialBatch` takes.
        """
        if not sets:
            return
        columns = [self.table.columns(index, one.body.name) for one in sets]
        batch = SpatialBatch(sets, *met, self.turn, columns, **options)
        if medium is not None and medium.scatters:
            medium.fill_scatter(batch.clusters, in_space=True)
        self.batches.append(batch)
        self.batch_media.append(medium)

    def _new_table(self, **of_rows: Any) -> HistoryTable:
        reached = (math.inf, math.inf, -math.inf, -math.inf) if self.watch else ()
        return super()._new_table(size=SPACE, reached=reached, **of_rows)


def _two_sided(one: elements.Elements) -> elements.Elements:
    """Elements as a floor meets them: no side of a surface leads or trails."""
    if one.meets != "surface":
        return one
    rows = one.rows.copy()
    rows[:, SIDE] = 0.0
    return replace(one, rows=rows)


def kinds(medium: Law) -> list[str]:
    """As what a medium meets bodies in space: surface, bar, ball."""
    return sorted(kinds_of(type(medium)))


def laws_for(meets: Collection[str]) -> list[str]:
    """Tags of the laws that meet bodies in space as one of these."""
    return [tag for tag, law in LAWS.items() if kinds_of(law) & set(meets)]


def turn_to(up: ArrayLike) -> Vector:
    """Rotation (3, 3) by the least angle that takes the direction `up` (3,) to z.

    Raises
    ------
    ValueError
        It is no direction.
    """
    x, y, z = direction("up", up)
    if z < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    k = 1.0 / (1.0 + z)
    return np.array([[1.0 - k * x * x, -k * x * y, -x], [-k * x * y, 1.0 - k * y * y, -y], [x, y, z]])


def _ground(surface: ArrayLike, slope: ArrayLike, turn: Vector) -> Vector:
    """The surface as kernels read it, see `kernels.space_law`."""
    if np.ndim(surface) != 0 or not np.isfinite(float(np.asarray(surface))):
        raise ValueError(
            f"surface: got {np.asarray(surface)}, allowed in space is a finite number, its height along up (m)"
        )
    rise = np.zeros(3) if np.ndim(slope) == 0 and float(np.asarray(slope)) == 0.0 else np.asarray(slope, float)
    if rise.shape != (3,) or not np.isfinite(rise).all():
        allowed = "allowed in space are three finite numbers, the rise per length along x, y, z"
        raise ValueError(f"slope: got {np.asarray(slope)}, {allowed}")
    x, y, _ = turn @ rise
    return np.array([float(np.asarray(surface)), x, y, np.sqrt(1.0 + x * x + y * y)])
