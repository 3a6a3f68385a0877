"""Granular load on bodies in space: forces at a state, their tangent, accepted steps, history."""

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
from granular_contact.sand.bed_arguments import check_floor, check_slope, direction, layers_from, numbers
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.history import SPACE, HistoryTable
from granular_contact.sand.kernels import facet_paths, space_sand
from granular_contact.sand.kernels.ground import GROWTH, HEIGHT
from granular_contact.sand.kernels.space_joining import kinds_of, owner_of
from granular_contact.sand.load import GranularLoad
from granular_contact.sand.space import elements
from granular_contact.sand.space.batch import SpatialBatch
from granular_contact.sand.space.facets import as_facets
from granular_contact.sand.space.heights import Heights
from granular_contact.sand.space.round_shapes import Sphere
from granular_contact.sand.space.shapes import Bar, Shape
from granular_contact.sand.space.triangles import COST, FACET_SIZE, MOST_FACETS

Vector = NDArray[np.float64]
ELEMENT_NAMES = {"surface": "surfaces", "bar": "a Bar", "ball": "a Sphere"}


class SpatialLoad(GranularLoad):
    """One medium that acts on surfaces, bars and balls in space, or several media whose forces add.

    Bodies are one vector of coordinates q (m,) with rates v (m,); the load returns generalised forces (m,). A body has
    the coordinates x, y, z (m) and four Euler parameters, or three Tait-Bryan angles (rad) with R = R_x R_y R_z.
    Everything else is as in `GranularLoad`.

    Parameters
    ----------
    medium, gravity, static, end_cap, floor
        See `GranularBed`.
    surface : float
        Height of a level surface along `up` (m); of an inclined surface the height at the world origin.
    up : (3,) array
        Direction against which depth is measured and gravity acts on the medium, in the world frame.
    slope : (3,) array or 0
        Rise of the surface per length along each axis of the world; its component along `up` does not count.
    heights : Heights, optional
        Map of heights above that surface, for a bed whose `up` is z.
    watch : bool
        Whether the history records the range of what is immersed along x and y.
    spread : float
        Factor of the displacement over which the load on a face of a resting body builds up.

    Raises
    ------
    ValueError
        An argument is not allowed; errors as in `GranularBed`.
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
        for law in (layer.medium for layer in layers):
            if law.scatters and element_kinds(law) != ["surface"]:
                reason = "has scatter, which in space is for laws of surfaces; allowed is none"
                raise ValueError(f"medium: {law.name} {reason}")
            for key in law.lacking_in_space:
                raise ValueError(f"medium: {law.name} has no {key}, but in space a number is needed there")
        self._set_common(layers, static, gravity, floor)
        for record in self.records:
            record["pressed"] *= spread
        self.turn = rotation_to_z(up)
        self.ground = _ground(surface, slope, self.turn)
        check_slope(self.media, math.hypot(*self.ground[1:3]))
        if heights is None and not self.ground[1:3].any():
            check_floor(floor, float(self.ground[HEIGHT]))
        if heights is not None:
            self.ground = np.concatenate([self.ground, heights.numbers])
            self.ground[GROWTH] = np.sqrt(1.0 + heights.steepest**2)
        self.resultant, self.end_cap = False, end_cap
        self._cut: dict[Any, tuple[Shape, elements.CutSurface]] = {}  # see `_surface`

    @property
    def kernels(self) -> Any:
        """Module of compiled functions; see `GranularLoad.kernels`. That of a bed with walls also records the range."""
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
        """Add a shape of a body. Each medium acts on the kinds of element that its law takes.

        Parameters
        ----------
        body : Body
            The body.
        shape : Shape
            The shape.
        position : (3,) array
            Position of the shape (m) in the frame of the body.
        rotation : (3, 3) array, optional
            Rotation of the shape in the frame of the body.
        facet_size : float, optional
            Greatest edge of facets (m).
        accuracy : float, optional
            Without a size: allowed error of the motion by facets, relative to the path.
        share : float
            Factor of the size in either case.
        mass : float, optional
            Mass of the body (kg), for a sphere without a mass of its own.

        Raises
        ------
        SceneError
            No medium takes such a shape, an argument is not allowed, there are too many facets, or the batches are
            formed already.
        """
        self.check_open()
        if not isinstance(shape, Shape):
            raise scene_error("bed", f"shape: got {shape!r}, allowed is a shape, such as Box((0.1, 0.1, 0.05))")
        began = time.perf_counter()
        place, turn = elements.position_vector(position), elements.rotation_matrix(rotation)
        if facet_size is not None and not (np.isfinite(facet_size) and facet_size > 0.0):
            raise scene_error("bed", f"facet_size: got {facet_size}, allowed is a number above 0 (m)")
        parts = []
        for kind in self._element_kinds(shape):
            if kind == "ball":
                self._check_whole()
            if kind == "surface":
                parts.append(elements.surface(body, self._surface(shape, facet_size, accuracy, share), place, turn))
            elif isinstance(shape, Bar):
                parts.append(elements.bar(body, shape, place, turn))
                parts[-1].clusters["cap"] &= self.end_cap
            elif isinstance(shape, Sphere):
                parts.append(elements.ball(body, shape, place, mass))
        count = sum(len(part.rows) for part in (*self.lines, *parts) if part.element_kind == "surface")
        if count > MOST_FACETS:
            reason = f"got {count:,} facets in all; allowed are {MOST_FACETS:,}, which take {COST}: a larger accuracy,"
            raise scene_error(FACET_SIZE, f"{reason} larger facets, or fewer shapes in the sand (in_sand: false)")
        self.take([replace(part, duplicate=i > 0) for i, part in enumerate(parts)])
        self.building_s += time.perf_counter() - began

    def take(self, parts: Sequence[elements.Elements]) -> None:
        """Add elements of shapes, such as those of another load.

        Parameters
        ----------
        parts : sequence of Elements
            The elements.
        """
        self.lines += parts
        self.table = self._new_table()

    def _surface(self, shape: Shape, size: float | None, accuracy: float | None, share: float) -> elements.CutSurface:
        """Facets of a shape, cut once for all bodies that share it; arguments as in `elements.cut_surface`."""
        key = id(shape), size, accuracy, share
        if key not in self._cut:
            self._cut[key] = shape, elements.cut_surface(shape, size, accuracy, share)
        return self._cut[key][1]

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Yield nothing: the beds of scripts, which warn of steep pieces, take no map of heights."""
        yield from ()

    def _element_kinds(self, shape: Shape) -> list[str]:
        """Kinds of element by which the media act on a shape: surface, bar or ball."""
        possible: tuple[str, ...] = ("surface",)
        if isinstance(shape, Sphere | Bar):
            possible = ("bar",) if isinstance(shape, Bar) else ("surface", "ball")
        kinds = [kind for kind in possible if any(kind in element_kinds(medium) for medium in self.media)]
        if not kinds:
            reason = "; ".join(
                f"{medium.name} takes {' and '.join(ELEMENT_NAMES[k] for k in element_kinds(medium)) or 'nothing'}"
                for medium in self.media
            )
            raise scene_error("bed", f"in space nothing acts on a {type(shape).__name__}: {reason}")
        return kinds

    def close(self) -> None:
        """Form the batches: one for each kind of element on the floor, and for each medium and kind that it takes.

        `start` does it too.
        """
        self._cut.clear()
        if self.floor is not None:
            ground, owner = np.array([self.floor.height, 0.0, 0.0, 1.0]), self.floor.record_in_space()
            for kind in dict.fromkeys(group.element_kind for group in self.lines):
                sets = [_two_sided(group) for group in self.lines if group.element_kind == kind and not group.duplicate]
                self._add_batch(len(self.media), None, sets, (InSpace, owner, ground))
        for index, (layer, record) in enumerate(zip(self.layers, self.records, strict=True)):
            medium = layer.medium
            drop = float(getattr(medium, "surface_drop", 0.0))
            ground = self.ground.copy()
            ground[HEIGHT] -= drop
            depths = None if layer.whole else (max(0.0, layer.top - drop), max(0.0, layer.bottom - drop))
            for kind in element_kinds(medium):
                paths = 0
                if kind == "surface":
                    paths = facet_paths.COLUMNS - 3 if medium.scatters else 0
                    paths += facet_paths.SHEARED if medium.shear_grows else 0
                sets = [group for group in self.lines if group.element_kind == kind]
                self._add_batch(
                    index, medium, sets, (owner_of(type(medium)), record, ground), paths=paths, layer=depths
                )
        self.room_for_tangents = np.zeros((sum(batch.entries for batch in self.batches), 3))

    def _add_batch(
        self,
        index: int,
        medium: Law | None,
        sets: Sequence[elements.Elements],
        law: tuple[Any, NDArray[np.void], Vector],
        **options: Any,
    ) -> None:
        """Add the batch of the elements on which a medium acts, or the floor (None), if there are any.

        index: number of the medium; law: class of the law, its record and the surface; options: other arguments of
        `SpatialBatch`.
        """
        if not sets:
            return
        columns = [self.table.columns(index, group.body.name) for group in sets]
        batch = SpatialBatch(sets, *law, self.turn, columns, **options)
        if medium is not None and medium.scatters:
            medium.fill_scatter(batch.clusters, in_space=True)
        self.batches.append(batch)
        self.batch_media.append(medium)

    def _new_table(self, **of_rows: Any) -> HistoryTable:
        """Empty table of the history for the present bodies and media."""
        reached = (math.inf, math.inf, -math.inf, -math.inf) if self.watch else ()
        return super()._new_table(size=SPACE, reached=reached, **of_rows)


def _two_sided(group: elements.Elements) -> elements.Elements:
    """Elements on which a floor acts: it acts on both sides of a surface."""
    if group.element_kind != "surface":
        return group
    rows = group.rows.copy()
    as_facets(rows)["side"] = 0.0
    return replace(group, rows=rows)


def element_kinds(medium: Law) -> list[str]:
    """Kinds of element on which a medium acts in space.

    Parameters
    ----------
    medium : Law
        The medium.

    Returns
    -------
    list of str
        Of "surface", "bar" and "ball".
    """
    return sorted(kinds_of(type(medium)))


def laws_for(kinds: Collection[str]) -> list[str]:
    """Tags of the laws that act on any of some kinds of element.

    Parameters
    ----------
    kinds : collection of str
        Of "surface", "bar" and "ball".
    """
    return [tag for tag, law in LAWS.items() if kinds_of(law) & set(kinds)]


def rotation_to_z(up: ArrayLike) -> Vector:
    """Rotation by the smallest angle that takes the direction `up` to z.

    Parameters
    ----------
    up : (3,) array
        The direction.

    Returns
    -------
    (3, 3) array

    Raises
    ------
    ValueError
        It is not a direction.
    """
    x, y, z = direction("up", up)
    if z < -1.0 + 1e-12:
        return np.diag([1.0, -1.0, -1.0])
    k = 1.0 / (1.0 + z)
    return np.array([[1.0 - k * x * x, -k * x * y, -x], [-k * x * y, 1.0 - k * y * y, -y], [x, y, z]])


def _ground(surface: ArrayLike, slope: ArrayLike, turn: Vector) -> Vector:
    """The surface as the kernels read it, (4,), see `kernels.ground`."""
    height, rise = numbers(surface), numbers(slope)
    if height.ndim != 0 or not np.isfinite(height):
        got = np.asarray(surface).tolist()
        raise ValueError(f"surface: got {got!r}, allowed in space is a finite number, its height along up (m)")
    rise = np.zeros(3) if rise.ndim == 0 and rise == 0.0 else rise
    if rise.shape != (3,) or not np.isfinite(rise).all():
        allowed = "allowed in space are three finite numbers, the rise per length along x, y, z"
        raise ValueError(f"slope: got {np.asarray(slope)}, {allowed}")
    x, y, _ = turn @ rise
    return np.array([float(height), x, y, np.sqrt(1.0 + x * x + y * y)])
