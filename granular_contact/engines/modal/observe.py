"""Trajectory of the modal pendulum -> the contents of results."""

from __future__ import annotations

import math

import numpy as np

from granular_contact.engines.modal import energies
from granular_contact.engines.modal.extremes import known
from granular_contact.engines.modal.model import Bar, Model
from granular_contact.engines.modal.solve import Trajectory
from granular_contact.laws.law import term_names
from granular_contact.results import Outline, energy, series
from granular_contact.results.interpolation import Track
from granular_contact.results.observation import Known, Observation, pictures
from granular_contact.results.observed import Instant, Observations, Seen
from granular_contact.results.stopping import Stop
from granular_contact.scene.types import Vector

POINTS = 17  # of a bent link in drawings
ALL = slice(None)


def observe(model: Model, trajectory: Trajectory) -> Observation:
    """Observation of a run."""
    motion, scene, pin = Motion(model, trajectory), model.scene, model.scene.pivot
    assert pin is not None  # or the scene was refused
    extremes = motion.known()
    return Observation(
        scene=scene,
        status=trajectory.status,
        cost=trajectory.cost,
        time=trajectory.time,
        motion=series.joint(pin.name, pin.child, None, motion.angle + model.turn, motion.rate),
        mean_rate=motion.mean_rate(),
        tip=motion.tip(),
        deflection=motion.deflection(),
        depths=(),
        terms=term_names(scene.media),
        term_forces=trajectory.terms,
        moments_about=model.view.pivot,
        body_forces={"": trajectory.terms.sum(axis=1)},
        energies=motion.energies(),
        reach=extremes.reach,
        stop=lambda _: stop(model, trajectory.stop),
        outlines=motion.outlines,
        pictures=lambda at: pictures(lambda sampled: Motion(model, sampled).outlines, trajectory, at),
        more={"static_turns": trajectory.turns},
        known=extremes,
    )


def now(model: Model, trajectory: Trajectory) -> Observations:
    """Observations of a trajectory of one row: pivot, body on it, force of the medium on all parts."""
    motion, scene, pin = Motion(model, trajectory), model.scene, model.scene.pivot
    assert pin is not None  # or the scene was refused
    root = scene.rigid[0]
    center = model.view.of(root, np.zeros(2))[None, :]
    place, velocity = motion.positions(None, center)[0, 0], motion.velocities(None, center)[0, 0]
    angle, rate = motion.angle + model.turn, motion.rate
    depth = motion.known().depth
    wrench = trajectory.terms.sum(axis=1)
    forces = np.array([[*wrench[0, :2], series.clockwise_moment(wrench, place)[0]]])
    met = ("all",) if depth is not None and scene.media else ()
    who = Seen((pin.name,), (True,), (root.name.split("+")[0],), met)
    bodies = np.array([[*place, angle[0]]]), np.array([[*velocity, rate[0]]])
    depths = depth if depth is not None and met else np.zeros(0)
    instant = Instant(lambda: (angle, rate), lambda: bodies, lambda _: forces[: len(met)], lambda: depths)
    return Observations(who, float(trajectory.time[0]), instant)


def stop(model: Model, first: tuple[float, float, float]) -> Stop | None:
    """Time and pivot angle of the first zero of the mean rate after the touch; first: `Trajectory.stop`."""
    time, angle, hub_time = first
    if math.isnan(time):
        return None
    return Stop(time, angle + model.turn, None if math.isnan(hub_time) else hub_time)


class Motion:
    """Positions, rates and energies of a trajectory; arrays (n,) and (n, 2) over its instants."""

    def __init__(self, model: Model, trajectory: Trajectory) -> None:
        self.model, self.scene, self.trajectory = model, model.scene, trajectory
        self.mass = energies.mass(trajectory.arrays.pendulum, model.method.modes)
        self.angle, self.rate = trajectory.q[:, 0], trajectory.v[:, 0]
        self.bends, self.bend_rates = trajectory.q[:, 1:], trajectory.v[:, 1:]

    # ---- motion ----

    def mean_rate(self) -> Vector:
        """Angular momentum over moment of inertia about the pivot (rad/s, clockwise)."""
        momentum = np.sum(self.bend_rates * self.mass.c, axis=1)
        rate: Vector = self.rate + momentum / energies.inertia(self.bends, self.mass)
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

    def known(self) -> Known:
        """Extremes of the motion, between rows, too, and the time when the pendulum touches the medium."""
        t = self.trajectory
        return known([self.model], np.array([0, len(t.time)]), np.column_stack([t.time, t.q, t.v]))[0]

    def velocities(self, bar: Bar | None, places: Vector) -> Vector:
        """World velocities (instants, points, 2) m/s of places (points, 2) m of a bar, or of a rigid part (None)."""
        x, x_rate = np.broadcast_to(places[:, 1], (len(self.angle), len(places))), np.zeros(1)
        if bar is not None:
            shapes = self.model.shapes(bar, places)
            x, x_rate = x + self.bends @ shapes.T, self.bend_rates @ shapes.T
        c, s = np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]
        along, turn = places[:, 0], self.rate[:, None]
        return np.stack([-(along * s + x * c) * turn - x_rate * s, (x * s - along * c) * turn - x_rate * c], axis=-1)

    # ---- energies ----

    def energies(self) -> series.Series:
        """Columns of the stored energies, and of the work so far."""
        t = self.trajectory
        kinetic, gravity, elastic = energies.stored(t.q, t.v, self.mass)
        return energy.columns(kinetic, gravity - gravity[0], elastic, t.work, t.damping)

    # ---- pictures ----

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """Outlines of the mechanism at an instant (index), for drawing."""
        now = slice(instant, instant + 1)
        outlines = [
            Outline(shape.part, self.positions(None, shape.points, now)[0], shape.thickness)
            for shape in self.model.others
        ]
        for bar in self.model.bars:
            line = self.positions(bar, bar.places(POINTS if bar.bends else 2), now)[0]
            outlines.append(Outline(bar.part, line, bar.diameter))
        return tuple(outlines)
