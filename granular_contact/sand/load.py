"""Granular load on all bodies of a system: forces at a state, their tangent, accepted steps, history."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.geometry.surface import pieces
from granular_contact.laws.floor import TERM as FLOOR_TERM
from granular_contact.laws.floor import Floor
from granular_contact.laws.kinds import SHAPE_NAMES
from granular_contact.laws.law import Law, accepted_shapes, term_names
from granular_contact.laws.layer import Layer
from granular_contact.laws.static_friction import Elastoplastic, Smooth
from granular_contact.sand.batch import Batch, record_in_layer
from granular_contact.sand.bed_arguments import (
    carrying_floor,
    check_floor,
    check_slope,
    layers_from,
    medium_records,
    surface_profile,
)
from granular_contact.sand.compiled_load import CompiledLoad, add_nothing, compiled_load
from granular_contact.sand.contact_lines import ContactLine
from granular_contact.sand.history import HistoryTable, LoadHistory
from granular_contact.sand.kernels import planar_sand
from granular_contact.sand.kernels.lines import FIRST
from granular_contact.sand.kernels.proximity import GREATEST
from granular_contact.sand.state import batch_states, restore_batches

Vector = NDArray[np.float64]
# A body that touches the surface at the start, within TOUCH_DISTANCE (m), is evaluated TOUCH_TIME (s) later: otherwise
# round-off decides whether it is immersed.
TOUCH_DISTANCE, TOUCH_TIME = 1e-9, 1e-9
SHAPE_SPACING = 100.0  # distance (m) of two shapes on the lattice of the scatter of a medium


class GranularLoad:
    """One medium that acts on contact lines, or several media whose forces add.

    Bodies are one vector of coordinates q (m,) with rates v (m,); the load returns generalised forces (m,). A body in
    the plane has the coordinates x, y and angle, with the force x, y (N) and the moment (N m, counter-clockwise) about
    that point. Vectors are contiguous arrays of float64; this is not checked. An evaluation of forces does not change
    the load; `accept` ends a step.

    Parameters
    ----------
    medium, surface, slope, gravity, static, form, end_cap, floor
        See `GranularBed`.

    Attributes
    ----------
    lines : list
        `ContactLine` objects, in space `Elements`.
    batches : list
        `Batch` objects, in space `SpatialBatch`.
    time : float or None
        Time (s) of the last accepted state; None until a step is accepted after `start`.
    active : bool
        Whether anything can touch the surface in this step.
    table : HistoryTable
        Table of the history.

    Raises
    ------
    ValueError
        An argument is not allowed; errors as in `GranularBed`.
    """

    building_s = 0.0  # wall time (s) in which its shapes were made

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
        self._set_common(layers_from(medium, form), static, gravity, floor)
        self.profile = surface_profile(surface, slope)
        check_slope(self.media, slope)
        if slope == 0.0:
            check_floor(floor, float(self.profile[:, 1].max()))
        self.resultant, self.end_cap = form == "resultant", end_cap
        self._added = 0  # number of shapes

    def _set_common(
        self, layers: tuple[Layer, ...], static: Elastoplastic | Smooth | None, gravity: float, floor: Floor | None
    ) -> None:
        """Set what a load in the plane and a load in space have in common."""
        self.layers, self.media = layers, tuple(layer.medium for layer in layers)
        self.records, self.floor = medium_records(layers, static, gravity), carrying_floor(floor)
        self.gravity = abs(gravity)
        self.lines: list[Any] = []
        self.batches: list[Any] = []
        self.batch_media: list[Law | None] = []  # medium of each batch; None for the contact of the floor
        self._leaning_batches: list[Batch] = []  # batches with bodies that may lean out of the plane
        self.time: float | None = None
        self.active = False
        self.table = self._new_table()
        # Compiled form of `force`, without a return value: for solvers, which call it in each iteration.
        self.add_forces: Callable[[Vector, Vector, Vector], None] = add_nothing
        self._compiled: CompiledLoad | None = None
        self._sand = np.zeros((0, 0), np.int64)  # addresses of the arrays of all batches, see `planar_sand`

    @property
    def kernels(self) -> Any:
        """Module of compiled functions that evaluate all batches in one call."""
        return planar_sand

    # ---- contact lines and batches ----

    def add(self, lines: Sequence[ContactLine]) -> None:
        """Add contact lines of a shape. Each medium acts on those whose kind of shape it takes.

        Parameters
        ----------
        lines : sequence of ContactLine
            The lines.

        Raises
        ------
        SceneError
            No medium takes such a shape, or the batches are formed already.
        """
        self.check_open()
        self.lines += [self._line_record(line) for line in lines]
        self._added += 1
        self.table = self._new_table()

    def pieces(self) -> Iterator[tuple[float, float]]:
        """Rise per length, and length (m), of the pieces of a surface that was given by its corners."""
        yield from pieces(self.profile[1:-1])  # without the level pieces that `geometry.surface` adds

    def _line_record(self, line: ContactLine) -> ContactLine:
        """Copy of a line with the options of this load in its record; refused if no medium takes its kind of shape."""
        if not any(line.kind in medium.takes for medium in self.media):
            reason = "; ".join(map(accepted_shapes, self.media))
            raise scene_error("bed", f"nothing acts on {SHAPE_NAMES[line.kind]}: {reason}")
        if line.kind == "ball":
            self._check_whole()
        record = line.record.copy()
        record["cap"] &= self.end_cap
        record["place"] += SHAPE_SPACING * self._added
        record["resultant"] = self.resultant and line.kind in ("round", "flat")
        return replace(line, record=record)

    def _check_whole(self) -> None:
        """Refuse a ball in a bed with layers."""
        if not all(layer.whole for layer in self.layers):
            raise scene_error("bed", "a ball is met as a whole, but the bed has layers: allowed is one medium")

    def check_open(self) -> None:
        """Refuse more lines once the batches are formed.

        Raises
        ------
        SceneError
            The batches are formed.
        """
        if self.batches:
            raise scene_error("bed", "it is attached already; name every body before attach()")

    def close(self) -> None:
        """Form the batches, one for each kind of line that the floor meets and one for each medium.

        `start` does it too.
        """
        for index, kinds, profile, medium, layer in self._contacts():
            acting = [line for line in self.lines if line.kind in kinds]
            if acting:
                columns = [self.table.columns(index, line.body.name) for line in acting]
                records = [record_in_layer(layer, line, self.gravity) for line in acting]
                paths = layer is not None and layer.medium.needs_path_length
                self.batches.append(Batch(acting, records, profile, medium, columns, paths))
                self.batch_media.append(None if layer is None else layer.medium)
        self.room_for_tangents = np.zeros((sum(batch.entries for batch in self.batches), 3))  # of `planar_sand.tangent`
        self._leaning_batches = [batch for batch in self.batches if batch.has_spatial_bodies]

    def _contacts(self) -> Iterator[tuple[int, Collection[str], Vector, NDArray[np.void], Layer | None]]:
        """Yield number, kinds of shape, surface, record and layer of the contact of the floor, then of each medium."""
        if self.floor is not None:
            for kind in dict.fromkeys(line.kind for line in self.lines):
                yield len(self.media), (kind,), self.floor.profile, self.floor.record(kind), None
        for i, (layer, record) in enumerate(zip(self.layers, self.records, strict=True)):
            yield i, layer.medium.takes, self.profile, record, layer

    def _new_table(self, **of_rows: Any) -> HistoryTable:
        """Empty table of the history for the present bodies and media."""
        terms, names = [len(medium.terms) for medium in self.media], term_names(self.media)
        if self.floor is not None:
            terms, names = [*terms, 1], (*names, FLOOR_TERM)
        bodies = tuple(dict.fromkeys(line.body.name for line in self.lines))
        return HistoryTable(terms, names, bodies, self.floor is not None, **of_rows)

    def renew(self, layers: Sequence[Layer], static: Elastoplastic | Smooth, gravity: float) -> bool:
        """Take other coefficients of the same laws in the same layers, to evaluate many media on the same lines.

        Parameters
        ----------
        layers : sequence of Layer
            The layers.
        static : Elastoplastic or Smooth
            Regularisation of the sign in the static resistance.
        gravity : float
            Gravity (m/s2).

        Returns
        -------
        bool
            False if laws or layers are others, or the bed has a floor; then nothing is changed.
        """
        same = [type(layer.medium) is type(old.medium) for layer, old in zip(layers, self.layers, strict=False)]
        placed = [(layer.top, layer.bottom) for layer in layers] == [(layer.top, layer.bottom) for layer in self.layers]
        if self.floor is not None or not placed or not all(same) or len(self.batches) != len(layers):
            return False
        self.layers = tuple(layers)
        self.media = tuple(layer.medium for layer in layers)
        self.batch_media[:] = self.media
        self.records = medium_records(self.layers, static, gravity)
        for batch, record in zip(self.batches, self.records, strict=True):
            batch.renew(record)
        return True

    # ---- steps ----

    def start(self, q: Vector, system_places: NDArray[np.int64] | None = None, reference: Vector | None = None) -> None:
        """Begin an empty history at a state, with all bristles unstretched.

        Parameters
        ----------
        q : (m,) array
            Coordinates.
        system_places : (n,) array of int, optional
            Places of the coordinates of the bed in q and v, if these belong to a larger system.
        reference : (m,) array, optional
            Reference values, which are added to q.
        """
        if not self.batches:
            self.close()
        self.table.length, self.time = 0, None
        q = np.ascontiguousarray(q)  # for a view with gaps all kernels would be compiled again
        if not self.batches:
            return
        added = np.zeros_like(q) if reference is None else np.ascontiguousarray(reference)
        sand = self._sand = self.addresses(system_places, added)
        self._compiled = compiled_load(self.kernels)  # compiled here, so that the first step of a solve does not wait
        self.add_forces = partial(self._compiled.force, sand)
        self._compiled.accept(sand, q, np.zeros_like(q), np.zeros(FIRST), True)
        for batch in self.batches:
            batch.proximity[:, GREATEST] = -np.inf

    def addresses(self, system_places: NDArray[np.int64] | None, reference: Vector) -> NDArray[np.int64]:
        """Begin all batches, and return the addresses of their arrays; arguments as in `start`.

        Returns
        -------
        (batches, addresses) array
            See `kernels.planar_sand`.
        """
        return np.array([batch.start(system_places, reference) for batch in self.batches])

    def force(self, q: Vector, v: Vector, out: Vector) -> Vector:
        """Add the generalised forces of all active lines.

        Parameters
        ----------
        q, v : (m,) array
            Coordinates and rates.
        out : (n,) array
            Generalised forces, by the coordinates of the bed. The forces are added.

        Returns
        -------
        (n,) array
            The array `out`.
        """
        self.add_forces(q, v, out)
        return out

    def tangent(self, q: Vector, v: Vector, factor_q: float, factor_v: float) -> Vector:
        """Entries of the matrix factor_q df/dq + factor_v df/dv of the generalised forces f.

        Parameters
        ----------
        q, v : (m,) array
            Coordinates and rates.
        factor_q, factor_v : float
            Factors.

        Returns
        -------
        (k, 3) array
            Rows (row, column, value) by the coordinates of the bed. The next call overwrites the array.
        """
        number = 0
        if self._compiled is not None:
            number = self._compiled.tangent(self._sand, q, v, factor_q, factor_v, self.room_for_tangents)
        return self.room_for_tangents[:number]

    def accept(self, t: float, q: Vector, v: Vector) -> None:
        """End a step: update the friction state, and append a row to the history.

        Parameters
        ----------
        t : float
            Time (s).
        q, v : (m,) array
            Coordinates and rates at the end of the step.
        """
        row = self.table.new_row(t)
        if self._compiled is not None:
            self._compiled.accept(self._sand, q, v, row, False)
        self.time = t

    def update_active(self, step: float) -> bool:
        """Choose the lines that can touch the surface within the next step, by the last accepted state.

        All lines are active after `start`. Without this call the forces are the same, but take longer.

        Parameters
        ----------
        step : float
            Length of the step (s).

        Returns
        -------
        bool
            Whether any line is active.
        """
        self.active = self._compiled is not None and self._compiled.update_active(self._sand, step)
        return self.active

    def lean(self, q: Vector) -> float:
        """Sine of the greatest angle by which a spatial body leans out of the plane.

        Parameters
        ----------
        q : (m,) array
            Coordinates.
        """
        return max(batch.lean(q) for batch in self._leaning_batches) if self._leaning_batches else 0.0

    @contextmanager
    def accepted(self, t: float, q: Vector, v: Vector) -> Iterator[None]:
        """Accept a state for the duration of a `with` block, and restore the state before it at the end of the block.

        Parameters
        ----------
        t : float
            Time (s).
        q, v : (m,) array
            Coordinates and rates.
        """
        length, time = self.table.length, self.time
        states = batch_states(self.batches)
        self.accept(t, q, v)
        try:
            yield
        finally:
            self.table.length, self.time = length, time
            restore_batches(self.batches, states)

    # ---- results ----

    @property
    def history(self) -> LoadHistory:
        """History of the steps accepted so far."""
        immersed = frozenset(entry for batch in self.batches for entry in batch.immersed())
        return replace(self.table.history(), immersed=immersed)

    @property
    def last(self) -> LoadHistory:
        """History of the last row alone; its cost does not grow with the number of rows."""
        return self.table.last()

    def soonest(self) -> float:
        """Time (s) after the last accepted step until a body above the surface can touch it; infinite if none can."""
        return math.inf if self._compiled is None else float(self._compiled.soonest(self._sand))
