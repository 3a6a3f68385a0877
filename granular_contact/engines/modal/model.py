"""Scene -> Model: the pendulum in modal coordinates; a scene that is no such pendulum is refused."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.modal.kernels.modal import MODAL_STATION
from granular_contact.engines.modal.kernels.pendulum import PENDULUM
from granular_contact.engines.modal.modes import Modes, roots
from granular_contact.scene.methods import check_reduced
from granular_contact.scene.parts import FlexibleLink, RigidBody, Shape, rotation
from granular_contact.scene.types import Reduced, Scene, Vector

# Least number of strips for each mode, as strips have to resolve its wavelength.
STRIPS_PER_MODE = 4
STRETCH = 1.02  # factor of the reach, as a bent link may reach a little farther than a straight one


@dataclass(frozen=True)
class View:
    """Coordinates in the undeformed pendulum, from its pivot (2,) m: along its axis, and across it, clockwise.

    angle (rad): of the axis, counter-clockwise from x of the world.
    """

    angle: float
    pivot: Vector

    def of(self, body: RigidBody | FlexibleLink, point: Vector) -> Vector:
        """Coordinates (along, across) m of a point (2,) m of a body, or of several points (n, 2)."""
        arm = body.motion.position + point @ rotation(body.motion.angle).T - self.pivot
        coordinates: Vector = arm @ rotation(-self.angle).T * (1.0, -1.0)
        return coordinates


@dataclass(frozen=True)
class Bar:
    """Straight part of the pendulum; start and end (2,) m are (along, across), see View; diameter (m).

    bends: whether it is the flexible link; free: whether its end is a free face; strips: number of strips of the load.
    """

    part: str
    start: Vector
    end: Vector
    diameter: float
    free: bool
    bends: bool
    strips: int

    def places(self, count: int) -> Vector:
        """`count` equally spaced points (count, 2) m."""
        placed: Vector = self.start + _shares(count) * (self.end - self.start)
        return placed


@lru_cache(maxsize=64)
def _shares(count: int) -> Vector:
    """Equally spaced numbers (count, 1) from 0 to 1."""
    shares: Vector = np.linspace(0.0, 1.0, count)[:, None]
    return shares


class Lines(NamedTuple):
    """Bars, and then the other shapes in the sand, as the kernels of extremes take them.

    points: records of `kernels.modal`; other fields: those of one run in `kernels.modal_extremes.Lines`.
    """

    points: NDArray[np.void]
    starts: NDArray[np.int64]
    every: NDArray[np.int64]
    beside: Vector
    drop: Vector


@dataclass(frozen=True)
class Model:
    """The pendulum, with the n + 1 coordinates q_1 (rad) and q_{1+i} (m).

    others: shapes without strips, with points in the coordinates of `view`; view: coordinates of the
    undeformed pendulum; turn: angle of the root's body less q_1, both below the horizontal (rad); reach: greatest
    distance of a point from the pivot (m); speed: scale of speeds (m/s); start: initial state, see `modal_motion`.
    """

    scene: Scene
    method: Reduced
    link: FlexibleLink | None
    modes: Modes
    bars: tuple[Bar, ...]
    others: tuple[Shape, ...]
    view: View
    turn: float
    reach: float
    speed: float
    start: Vector

    @property
    def bends(self) -> bool:
        """Whether the model has modes."""
        return len(self.modes.beta) > 0

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return self.method.modes + 1

    @cached_property
    def mechanics(self) -> NDArray[np.void]:
        """Record (1,) of `kernels.pendulum`: inertia, static moments, stiffness and damping; fields of a run are 0."""
        record = np.zeros(1, PENDULUM)
        n, root, link = self.method.modes, self.scene.rigid[0], self.link
        center = self.view.of(root, np.zeros(2))
        record["modes"], record["g"] = n, self.scene.gravity
        record["J"] = root.inertia + root.mass * float(center @ center)
        record["S_e"], record["S_n"] = root.mass * center
        if link is None:
            return record
        a, b = self.bars[-1].start
        middle = a + 0.5 * link.length
        # The engine's beam has no rotary inertia of its section; its rigid bar has.
        section = 0.0 if n else link.thickness**2 / 16.0
        record["J"] += link.mass * (middle**2 + b**2 + link.length**2 / 12.0 + section)
        record["S_e"] += link.mass * middle
        record["S_n"] += link.mass * b
        record["b"], record["m"] = b, 0.25 * link.mass
        mean, first, bending = self.modes.mean(), self.modes.first_moment(), self.modes.bending()
        record["p"][0, :n] = link.mass * mean
        record["c"][0, :n] = link.mass * (a * mean + link.length * first)
        record["k"][0, :n] = link.bending_stiffness * bending
        record["d"][0, :n] = link.bending_damping * bending
        return record

    @cached_property
    def met(self) -> tuple[int, ...]:
        """Indices of the bars that can get below the surface, at any angle of the pendulum and bending of its link."""
        scene = self.scene
        if not scene.media or scene.surface is None:
            return ()
        reach = (self.view.pivot[1] - scene.surface) / STRETCH
        return tuple(i for i, bar in enumerate(self.bars) if max(math.hypot(*bar.start), math.hypot(*bar.end)) > reach)

    @cached_property
    def stations(self) -> tuple[NDArray[np.void], ...]:
        """Ends of the strips of each bar, as records for the kernels."""
        return tuple(self._stations(bar) for bar in self.bars)

    @cached_property
    def lines(self) -> Lines:
        """All lines that can meet the medium; on a straight bar only the ends can be deepest."""
        others = [shape for shape in self.others if shape.in_sand]
        points = [*self.stations, *(self._points(shape.points) for shape in others)]
        every = [1 if bar.bends else bar.strips for bar in self.bars] + [1] * len(others)
        return Lines(
            np.concatenate([np.zeros(0, MODAL_STATION), *points]),
            np.cumsum([0, *map(len, points)]),
            np.array(every, dtype=np.int64),
            np.array([0.5 * bar.diameter for bar in self.bars] + [0.0] * len(others)),
            np.array([0.0] * len(self.bars) + [shape.drop for shape in others]),
        )

    def _points(self, places: Vector) -> NDArray[np.void]:
        """Stations at places (points, 2) m that turn with the root."""
        made = np.zeros(len(places), MODAL_STATION)
        made["along"], made["across"], made["pivot"] = places[:, 0], places[:, 1], self.view.pivot
        return made

    def _stations(self, bar: Bar) -> NDArray[np.void]:
        places = bar.places(bar.strips + 1)
        made = self._points(places)
        if bar.bends:
            made["phi"][:, : self.method.modes] = self.shapes(bar, places)
        return made

    def shapes(self, bar: Bar, places: Vector) -> Vector:
        """Mode shapes (points, n) at places (points, 2) of a bar."""
        if not bar.bends:
            return np.zeros((len(places), len(self.modes.beta)))
        return self.modes.shape(places[:, 0] - bar.start[0])


def model(scene: Scene, method: Reduced) -> Model:
    """Reduce a scene.

    Raises
    ------
    SceneError
        The mechanism has no such reduction; the message says which have one.
    """
    check_reduced(scene, method.modes)
    root, pin = scene.rigid[0], scene.pivot
    assert pin is not None  # or the scene was refused
    link = scene.links[0] if scene.links else None
    axis = root.motion.angle if link is None else link.motion.angle
    view = View(axis, pin.parent_point)
    modes = Modes(roots(method.modes), 1.0 if link is None else link.length)
    bars = tuple(_bars(scene, method, view))
    others = tuple(replace(shape, points=view.of(root, shape.points)) for shape in root.shapes if not _is_bar(shape))
    points = np.vstack([*(np.array([bar.start, bar.end]) for bar in bars), *(shape.points for shape in others)])
    reach = float(np.linalg.norm(points, axis=1).max())
    return Model(
        scene, method, link, modes, bars, others, view, axis - root.motion.angle, reach, *_begun(scene, method, reach)
    )


class Models:
    """Models of scenes; the model of a variant (see `scene.variants`) shares parts with that of its base scene."""

    def __init__(self) -> None:
        self._known: list[tuple[Scene, Model]] = []

    def __call__(self, scene: Scene) -> Model:
        """The model of a scene; raises SceneError as `model` does."""
        assert isinstance(scene.method, Reduced)
        if scene.variant_of is None:
            return model(scene, scene.method)
        like = next((made for known, made in self._known if known is scene.variant_of), None)
        if like is None:
            assert isinstance(scene.variant_of.method, Reduced)
            like = model(scene.variant_of, scene.variant_of.method)
            self._known.append((scene.variant_of, like))
        return variant(like, scene)


def variant(like: Model, scene: Scene) -> Model:
    """Model of a scene that differs from that of `like` only in its medium and initial motion, see `scene.variants`."""
    root, link = scene.rigid[0], scene.links[0] if scene.links else None
    view = View((root if link is None else link).motion.angle, like.view.pivot)
    speed, start = _begun(scene, like.method, like.reach)
    made = replace(like, scene=scene, link=link, view=view, speed=speed, start=start)
    # These cached properties depend on the parts only.
    vars(made).update(stations=like.stations, lines=like.lines, mechanics=like.mechanics)
    return made


def _begun(scene: Scene, method: Reduced, reach: float) -> tuple[float, Vector]:
    """Scale of speeds (m/s), and the initial state."""
    motion = scene.rigid[0].motion
    axis = (scene.links[0] if scene.links else scene.rigid[0]).motion.angle
    start = np.zeros(2 * (method.modes + 1) + 2)
    start[0], start[method.modes + 1] = -axis, -motion.rate
    return max(reach * abs(motion.rate) + math.sqrt(abs(scene.gravity) * reach), 1e-6), start


def _is_bar(shape: Shape) -> bool:
    """Whether the reduced model divides a shape into strips: straight, round and in the sand."""
    return shape.in_sand and shape.kind == "round" and len(shape.points) == 2


def _bars(scene: Scene, method: Reduced, view: View) -> Iterator[Bar]:
    for body in scene.rigid:
        for shape in filter(_is_bar, body.shapes):
            start, end = view.of(body, shape.points[0]), view.of(body, shape.points[1])
            yield Bar(shape.part, start, end, shape.width, shape.free, False, scene.load.strips_per_rigid_part)
    for link in scene.links:
        start = view.of(link, np.zeros(2))
        strips = scene.load.strips_per_rigid_part
        if method.modes > 0:
            strips = max(link.elements * scene.load.strips_per_element, STRIPS_PER_MODE * method.modes)
        end = start + np.array([link.length, 0.0])
        yield Bar(link.name, start, end, link.width, link.free, method.modes > 0, strips)
