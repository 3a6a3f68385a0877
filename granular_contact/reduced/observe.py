"""Trajectory -> what results hold of it, for the modal pendulum."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.kernels.modal import DEEPEST, observe_stations
from granular_contact.laws.law import term_names
from granular_contact.reduced.model import Bar, Model
from granular_contact.reduced.solve import Trajectory
from granular_contact.results import Outline, energy, series
from granular_contact.results.interpolation import Track
from granular_contact.results.limits import Reach
from granular_contact.results.observation import Observation, pictures
from granular_contact.results.observed import Observations, Seen, known
from granular_contact.results.stopping import Stop
from granular_contact.scene.types import Vector

POINTS = 17  # on a bent link in pictures
ALL = slice(None)


def observe(model: Model, trajectory: Trajectory) -> Observation:
    """What results hold of a run."""
    seen, scene, pin = Motion(model, trajectory), model.scene, model.scene.pivot
    assert pin is not None  # or the scene was refused
    return Observation(
        scene=scene,
        status=trajectory.status,
        cost=trajectory.cost,
        time=trajectory.time,
        motion=series.joint(pin.name, pin.child, None, seen.angle + model.turn, seen.rate),
        mean_rate=seen.mean_rate(),
        tip=seen.tip(),
        deflection=seen.deflection(),
        depths=seen.all_depths(),
        terms=term_names(scene.media),
        term_forces=trajectory.terms,
        moments_about=model.view.pivot,
        body_forces={"": trajectory.terms.sum(axis=1)},
        energies=seen.energies(),
        reach=seen.reach(),
        stop=lambda _: _stop(model, trajectory),
        outlines=seen.outlines,
        pictures=lambda at: pictures(lambda sampled: Motion(model, sampled).outlines, trajectory, at),
        more={"static_turns": trajectory.turns},
    )


def now(model: Model, trajectory: Trajectory) -> Observations:
    """What is seen of a trajectory of one row: the pivot, the body on it, the force of the medium on all of it."""
    seen, scene, pin = Motion(model, trajectory), model.scene, model.scene.pivot
    assert pin is not None  # or the scene was refused
    root = scene.rigid[0]
    center = model.view.of(root, np.zeros(2))[None, :]
    place, velocity = seen.positions(None, center)[0, 0], seen.velocities(None, center)[0, 0]
    angle, rate = seen.angle + model.turn, seen.rate
    depths = [float(track.values[0]) for track in seen.all_depths()]
    wrench = trajectory.terms.sum(axis=1)
    forces = np.array([[*wrench[0, :2], series.clockwise_moment(wrench, place)[0]]])
    met = ("all",) if depths and scene.media else ()
    return known(
        Seen((pin.name,), (True,), (root.name.split("+")[0],), met),
        float(trajectory.time[0]),
        (angle, rate),
        (np.array([[*place, angle[0]]]), np.array([[*velocity, rate[0]]])),
        (forces[: len(met)], np.array([max(depths)] if met else [])),
    )


def _stop(model: Model, trajectory: Trajectory) -> Stop | None:
    """When the mean rate first came to zero after the touch, as it was located on the way, with the pivot's angle."""
    time, angle, hub_time = trajectory.stop
    if np.isnan(time):
        return None
    return Stop(time, angle + model.turn, None if np.isnan(hub_time) else hub_time)


class Motion:
    """Reads positions, rates and energies out of a trajectory; (n,) and (n, 2) arrays over its instants."""

    def __init__(self, model: Model, trajectory: Trajectory) -> None:
        self.model, self.scene, self.trajectory = model, model.scene, trajectory
        self.mass = trajectory.arrays.pendulum[0]
        self.angle, self.rate = trajectory.q[:, 0], trajectory.v[:, 0]
        self.bends, self.bend_rates = trajectory.q[:, 1:], trajectory.v[:, 1:]
        n = len(model.modes.beta)
        self.coupling, self.moments, self.stiffness = (self.mass[key][:n] for key in ("c", "p", "k"))

    # ---- motion ----

    def _inertia(self) -> Vector:
        inertia: Vector = self.mass["J"] + 2.0 * self.mass["b"] * self.bends @ self.moments
        inertia += self.mass["m"] * np.sum(self.bends**2, axis=1)
        return inertia

    def mean_rate(self) -> Vector:
        """Angular momentum over moment of inertia about the pivot (rad/s, clockwise)."""
        rate: Vector = self.rate + self.bend_rates @ self.coupling / self._inertia()
        return rate

    def positions(self, bar: Bar | None, places: Vector, instants: slice = ALL) -> Vector:
        """World positions (instants, points, 2) m of places (points, 2) m of a bar, or of a rigid part (None)."""
        angle = self.angle[instants]
        x = np.broadcast_to(places[:, 1], (len(angle), len(places)))
        if bar is not None:
            x = x + self.bends[instants] @ self.model.shapes(bar, places).T
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        return self.model.view.pivot + np.stack([places[:, 0] * c - x * s, -places[:, 0] * s - x * c], axis=-1)

    def tip(self) -> Vector:
        """Position (n, 2) m of the tip."""
        name, point = self.scene.tip
        place = self.model.view.of(self.scene.body(name), point)
        bar = next((b for b in self.model.bars if b.bends and b.part == name), None)
        tip: Vector = self.positions(bar, place[None, :])[:, 0]
        return tip

    def deflection(self) -> Track | None:
        """Deflection (m) of the flexible link's tip, clockwise positive; None without modes."""
        return Track(self.bends.sum(axis=1), self.bend_rates.sum(axis=1)) if self.model.bends else None

    @cached_property
    def _lines(self) -> list[_Line]:
        """All bars, by the ends of their strips."""
        surface = self.scene.surface
        assert surface is not None
        q, v = (np.ascontiguousarray(both) for both in (self.trajectory.q, self.trajectory.v))
        pairs = zip(self.model.bars, self.model.stations, strict=True)
        return [_line(q, v, stations, surface, 0.5 * bar.diameter) for bar, stations in pairs]

    def all_depths(self) -> list[Track]:
        """Depths (m) of all ends and corners that may get into the medium, negative above the surface."""
        if self.scene.surface is None:
            return []
        found = []
        for bar, line in zip(self.model.bars, self._lines, strict=True):
            ends = slice(None) if bar.bends else slice(None, None, bar.strips)
            found += [Track(*both) for both in zip(line.depths[ends], line.rates[ends], strict=True)]
        for shape in (shape for shape in self.model.others if shape.in_sand):
            moved = self.positions(None, shape.points), self.velocities(None, shape.points)
            found += self._depths(*moved, shape.drop)
        return found

    def _depths(self, positions: Vector, velocities: Vector, drop: float) -> list[Track]:
        """Depths of points from their positions and velocities (instants, points, 2)."""
        assert self.scene.surface is not None
        depths, rates = self.scene.surface - positions[..., 1] + drop, -velocities[..., 1]
        return [Track(depth, rate) for depth, rate in zip(depths.T, rates.T, strict=True)]

    def velocities(self, bar: Bar | None, places: Vector) -> Vector:
        """World velocities (instants, points, 2) m/s of places (points, 2) m of a bar, or of a rigid part (None)."""
        x, x_rate = np.broadcast_to(places[:, 1], (len(self.angle), len(places))), np.zeros(1)
        if bar is not None:
            shapes = self.model.shapes(bar, places)
            x, x_rate = x + self.bends @ shapes.T, self.bend_rates @ shapes.T
        c, s = np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]
        along, turn = places[:, 0], self.rate[:, None]
        return np.stack([-(along * s + x * c) * turn - x_rate * s, (x * s - along * c) * turn - x_rate * c], axis=-1)

    def reach(self) -> Reach | None:
        """Extremes of what was immersed; None where nothing could meet the medium."""
        if not self.scene.media or self.scene.surface is None or not self.model.bars:
            return None
        lines = self._lines
        speed, depth, lowest, left, right = zip(*(line.extremes.tolist() for line in lines), strict=True)
        met = [bar for bar, line in zip(self.model.bars, lines, strict=True) if line.extremes[DEEPEST] > 0.0]
        return Reach(
            speed=max(speed),
            depth=max(depth),
            lowest=min(lowest),
            left=min(left),
            right=max(right),
            sizes=tuple(sorted({("round", bar.diameter) for bar in met})),
        )

    # ---- energies ----

    def energies(self) -> series.Series:
        """Columns of what was stored, and of the work done so far."""
        kinetic = 0.5 * self._inertia() * self.rate**2 + self.rate * (self.bend_rates @ self.coupling)
        kinetic += 0.5 * self.mass["m"] * np.sum(self.bend_rates**2, axis=1)
        across = self.mass["S_n"] + self.bends @ self.moments
        gravity = -self.scene.gravity * (self.mass["S_e"] * np.sin(self.angle) + across * np.cos(self.angle))
        elastic = 0.5 * self.bends**2 @ self.stiffness if self.model.bends else None
        t = self.trajectory
        return energy.columns(kinetic, gravity - gravity[0], elastic, t.work, t.damping)

    # ---- pictures ----

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """The mechanism as drawn at an instant (index)."""
        now = slice(instant, instant + 1)
        outlines = [
            Outline(shape.part, self.positions(None, shape.points, now)[0], shape.thickness)
            for shape in self.model.others
        ]
        for bar in self.model.bars:
            line = self.positions(bar, bar.places(POINTS if bar.bends else 2), now)[0]
            outlines.append(Outline(bar.part, line, bar.diameter))
        return tuple(outlines)


class _Line(NamedTuple):
    """Ends of the strips of a bar: depths (m) and their rates (m/s), (ends, instants); extremes as of the kernel."""

    depths: Vector
    rates: Vector
    extremes: Vector


def _line(q: Vector, v: Vector, stations: NDArray[np.void], surface: float, beside: float) -> _Line:
    depths, rates = np.empty((2, len(stations), len(q)))
    extremes = np.array([0.0, -np.inf, np.inf, np.inf, -np.inf])
    P, V = np.empty((2, len(stations), 2))
    observe_stations(q, v, stations, surface, beside, P, V, depths, rates, extremes)
    return _Line(depths, rates, extremes)
