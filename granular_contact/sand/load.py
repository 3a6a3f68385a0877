"""The granular load on all bodies of a system: forces at a state, its tangent, accepted steps, history."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry.surface import pieces
from granular_contact.jit.compiled import ready
from granular_contact.laws.floor import TERM as FLOOR_TERM
from granular_contact.laws.floor import Floor
from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.laws.law import Law, accepted_shapes, term_names
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.batch import Batch
from granular_contact.sand.contact_lines import ContactLine
from granular_contact.sand.given import check_floor, check_slope, floor_of, layers_of, profile_of, records_of
from granular_contact.sand.history import HistoryTable, LoadHistory
from granular_contact.sand.kernels import planar_sand
from granular_contact.sand.kernels.lines import FIRST
from granular_contact.sand.kernels.proximity import EVER
from granular_contact.sand.state import batch_states, restore_batches

Vector = NDArray[np.float64]
# What touches at the start, to so many metres, is looked at so many seconds later, or round-off decides if it does.
TOUCHES, AHEAD = 1e-9, 1e-9
APART = 100.0  # m, between the places of two shapes on the lattice of a medium's scatter


class _Compiled(NamedTuple):
    """Functions of `planar_sand`, or of those for space, as compiled."""

    force: Callable[..., None]
    tangent: Callable[..., int]
    accept: Callable[..., None]
    update_active: Callable[..., bool]
    soonest: Callable[..., float]


@cache
def _compiled(kernels: Any) -> _Compiled:
    """Of a module of kernels what is the same for all loads: finding it takes as long as some steps."""
    sand, q, triplets = np.zeros((1, 1), np.int64), np.zeros(1), np.zeros((1, 3))
    return _Compiled(
        ready(kernels.force, sand, q, q, q),
        ready(kernels.tangent, sand, q, q, 1.0, 1.0, triplets),
        ready(kernels.accept, sand, q, q, q, True),
        ready(kernels.update_active, sand, 0.0),
        ready(kernels.soonest, sand),
    )


def _nothing(q: Vector, v: Vector, out: Vector) -> None:
    """What a load on no lines adds."""


class GranularLoad:
    """One medium, or several whose forces add, that act on contact lines.

    It sees bodies as one vector of coordinates q (m,) with rates v (m,), and gives generalised forces (m,): of a body
    in the plane x, y and angle, with the force x, y (N) and the moment (N m) about that point. Vectors are float64 and
    contiguous; they are read unchecked. Forces at a state do not change the load; `accept` ends a step.

    Parameters
    ----------
    medium, surface, slope, gravity, static, form, end_cap, floor
        As of `GranularBed`, with its errors.
    """

    building_s = 0.0  # wall time (s) that its shapes took to be made

    def __init__(
        self,
        medium: Law | Layer | Sequence[Law | Layer],
        surface: ArrayLike,
        *,
        slope: float = 0.0,
        gravity: float = 9.81,
        static: Elastoplastic | Smooth | None = None,
        form: str = "distributed",
        end_cap: bool = False,
        floor: Floor | None = None,
    ) -> None:
        self._take(layers_of(medium, form), static, gravity, floor)
        self.profile = profile_of(surface, slope)
        check_slope(self.media, slope)
        if slope == 0.0:
            check_floor(floor, float(self.profile[:, 1].max()))
        self.resultant, self.end_cap = form == "resultant", end_cap
        self._added = 0  # shapes so far

    def _take(
        self, layers: tuple[Layer, ...], static: Elastoplastic | Smooth | None, gravity: float, floor: Floor | None
    ) -> None:
        """What a load of any kind begins with."""
        self.layers, self.media = layers, tuple(layer.medium for layer in layers)
        self.records, self.floor = records_of(layers, static, gravity), floor_of(floor)
        self.gravity = abs(gravity)
        self.lines: list[Any] = []  # `ContactLine`; of a load in space `Elements`
        self.batches: list[Any] = []  # `Batch`, in space `SpatialBatch`
        self.met: list[Law | None] = []  # of each batch its medium, None of the floor's contact
        self._leaning: list[Batch] = []  # those with bodies that may lean out of the plane
        self.time: float | None = None  # of the last accepted state (s); None until `start` was followed by one
        self.active = False  # whether anything may touch the surface in this step
        self.table = self._new_table()  # rows of the history
        # `force` as compiled, without what it returns: for whoever calls it in each iteration of a solve.
        self.add_forces: Callable[[Vector, Vector, Vector], None] = _nothing
        self._compiled: _Compiled | None = None
        self._sand = np.zeros((0, 0), np.int64)  # where the arrays of all batches are, see `planar_sand`

    @property
    def kernels(self) -> Any:
        """The module of what is compiled: of all batches in one call."""
        return planar_sand

    # ---- what the medium acts on ----

    def add(self, lines: Sequence[ContactLine]) -> None:
        """Let the media act on lines, each by those that take its kind of shape.

        Raises
        ------
        SceneError
            No medium takes such shapes, or the list of lines is closed.
        """
        self.check_open()
        self.lines += [self._met(line) for line in lines]
        self._added += 1
        self.table = self._new_table()

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Rise per length, and length (m), of the pieces of a surface that was given by its corners."""
        yield from pieces(self.profile[1:-1])  # without those that `geometry.surface` adds

    def _met(self, line: ContactLine) -> ContactLine:
        """A line that some medium takes, by the form of this load."""
        if not any(line.kind in medium.takes for medium in self.media):
            known = "; ".join(map(accepted_shapes, self.media))
            raise scene_error("bed", f"nothing acts on {SHAPE_NAMES[line.kind]}: {known}")
        if line.kind == "ball":
            self._check_whole()
        record = line.record.copy()
        record["cap"] &= self.end_cap
        record["place"] += APART * self._added
        record["resultant"] = self.resultant and line.kind in ("round", "flat")
        return replace(line, record=record)

    def _check_whole(self) -> None:
        """Refuse a ball where there are layers."""
        if not all(layer.whole for layer in self.layers):
            raise scene_error("bed", "a ball is met as a whole, but the bed has layers: allowed is one medium")

    def check_open(self) -> None:
        """Refuse more lines once there are batches of them."""
        if self.batches:
            raise scene_error("bed", "it is attached already; name every body before attach()")

    def close(self) -> None:
        """Form the batches, of lines that the floor or one medium meets; `start` does it too."""
        for index, kinds, profile, medium, layer in self._meetings():
            acting = [line for line in self.lines if line.kind in kinds]
            if acting:
                columns = [self.table.columns(index, line.body.name) for line in acting]
                records = [_in(layer, line, self.gravity) for line in acting]
                paths = layer is not None and layer.medium.needs_path_length
                self.batches.append(Batch(acting, records, profile, medium, columns, paths))
                self.met.append(None if layer is None else layer.medium)
        self.room_for_tangents = np.zeros((sum(batch.entries for batch in self.batches), 3))  # of `planar_sand.tangent`
        self._leaning = [batch for batch in self.batches if batch.leans]

    def _meetings(self) -> Iterator[tuple[int, Collection[str], Vector, NDArray[np.void], Layer | None]]:
        """Number, kinds of shape, surface, record and layer of the floor's contact, then of all media."""
        if self.floor is not None:
            for kind in dict.fromkeys(line.kind for line in self.lines):
                yield len(self.media), (kind,), self.floor.profile, self.floor.record(kind), None
        for i, (layer, record) in enumerate(zip(self.layers, self.records, strict=True)):
            yield i, layer.medium.takes, self.profile, record, layer

    def _new_table(self, **of_rows: Any) -> HistoryTable:
        terms, names = [len(medium.terms) for medium in self.media], term_names(self.media)
        if self.floor is not None:
            terms, names = [*terms, 1], (*names, FLOOR_TERM)
        bodies = tuple(dict.fromkeys(line.body.name for line in self.lines))
        return HistoryTable(terms, names, bodies, self.floor is not None, **of_rows)

    def renew(self, layers: Sequence[Layer], static: Elastoplastic | Smooth, gravity: float) -> bool:
        """Take other coefficients of the same laws in the same layers; False, with nothing done, if these are others.

        For curves of many coefficients on the same lines, without a floor.
        """
        same = [type(one.medium) is type(other.medium) for one, other in zip(layers, self.layers, strict=False)]
        placed = [(one.top, one.bottom) for one in layers] == [(one.top, one.bottom) for one in self.layers]
        if self.floor is not None or not placed or not all(same) or len(self.batches) != len(layers):
            return False
        self.layers = tuple(layers)
        self.media = tuple(layer.medium for layer in layers)
        self.met[:] = self.media
        self.records = records_of(self.layers, static, gravity)
        for batch, record in zip(self.batches, self.records, strict=True):
            batch.renew(record)
        return True

    # ---- steps ----

    def start(self, q: Vector, where: NDArray[np.int64] | None = None, reference: Vector | None = None) -> None:
        """Begin at the coordinates q: an empty history, and a friction state without any stretched bristle.

        where (m,): places of the bed's coordinates in q and v, where these are a larger system's; reference, of the
        size of q: what is added to q.
        """
        if not self.batches:
            self.close()
        self.table.length, self.time = 0, None
        q = np.ascontiguousarray(q)  # of a view with gaps all kernels would be compiled anew
        if not self.batches:
            return
        added = np.zeros_like(q) if reference is None else np.ascontiguousarray(reference)
        sand = self._sand = self.addresses(where, added)
        self._compiled = _compiled(self.kernels)  # which a solve calls: compiling is no part of its first step
        self.add_forces = partial(self._compiled.force, sand)
        self._compiled.accept(sand, q, np.zeros_like(q), np.zeros(FIRST), True)
        for batch in self.batches:
            batch.proximity[:, EVER] = -np.inf

    def addresses(self, where: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Begin all batches, with arguments as of `start`; return the addresses of their arrays, (media, addresses)."""
        return np.array([batch.start(where, reference) for batch in self.batches])

    def force(self, q: Vector, v: Vector, out: Vector) -> Vector:
        """Add the generalised forces of all active lines to out (m,), and return it."""
        self.add_forces(q, v, out)
        return out

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Entries (row, column, value) of factor_q df/dq + factor_v df/dv, (k, 3); the next call overwrites them."""
        number = 0
        if self._compiled is not None:
            number = self._compiled.tangent(self._sand, q, v, factor_q, factor_v, self.room_for_tangents)
        return self.room_for_tangents[:number]

    def accept(self, t: float, q: Vector, v: Vector) -> None:
        """End a step at the time t (s) in this state: the friction state follows, the history gets a row."""
        row = self.table.new_row(t)
        if self._compiled is not None:
            self._compiled.accept(self._sand, q, v, row, False)
        self.time = t

    def update_active(self, step: float) -> bool:
        """Choose the lines that may touch the surface in the next step (s), by the last accepted state.

        All lines are active after `start`; whoever never calls this has the same forces, in more time.
        """
        self.active = self._compiled is not None and self._compiled.update_active(self._sand, step)
        return self.active

    def leaning(self, q: Vector) -> float:
        """Sine of the greatest angle by which a spatial body leans out of the plane."""
        return max(batch.leaning(q) for batch in self._leaning) if self._leaning else 0.0

    @contextmanager
    def accepted(self, t: float, q: Vector, v: Vector) -> Iterator[None]:
        """A state that counts as accepted for as long as the block lasts, and is taken back after it."""
        length, time = self.table.length, self.time
        kept = batch_states(self.batches)
        self.accept(t, q, v)
        try:
            yield
        finally:
            self.table.length, self.time = length, time
            restore_batches(self.batches, kept)

    # ---- what is read ----

    @property
    def history(self) -> LoadHistory:
        """The steps accepted so far."""
        immersed = frozenset(one for batch in self.batches for one in batch.immersed())
        return replace(self.table.history(), immersed=immersed)

    @property
    def last(self) -> LoadHistory:
        """The last entry of the history, at no more than the cost of one."""
        return self.table.last()

    def soonest(self) -> float:
        """Time (s) after the last accepted step until something above the surface may touch it; infinite of nothing."""
        return math.inf if self._compiled is None else float(self._compiled.soonest(self._sand))


def _in(layer: Layer | None, line: ContactLine, gravity: float) -> NDArray[np.void]:
    """Record (1,) of a line for a medium in a layer; gravity (m/s2)."""
    record = line.record.copy()
    if layer is not None:
        medium = layer.medium
        medium.fill_scatter(record)
        if gravity > 0.0 and record["radius"] > 0.0:
            record["behind"] = getattr(medium, "wheel_drop", 0.0) / gravity
        record["layered"], record["top"], record["bottom"] = not layer.whole, layer.top, layer.bottom
    return record
