"""The force on one rigid body that moves steadily, at many poses at once: a law by itself, on a whole shape.

A plate that is pressed in at a given speed, or a wheel that turns at a given slip, needs no integration: at every depth
the medium's force follows from the pose and the velocity alone, if its resistance is fully mobilised (also shear that
builds up over a path, as Janosi and Hanamoto's). All poses are copies of the body side by side in one load, so that a
curve of 200 points is one compiled call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import scene_error
from granular_contact.laws.layer import Layer
from granular_contact.laws.probe import STEADY
from granular_contact.laws.scatter import Scatter
from granular_contact.sand.contact_lines import Body, ContactLine
from granular_contact.sand.load import APART, GranularLoad
from granular_contact.sand.of_scene import lines_of
from granular_contact.scene.parts import RigidBody, Shape, rotation
from granular_contact.scene.types import Scene

Vector = NDArray[np.float64]

MOST_LOADS = 4  # of different numbers of poses: those of a table, and of the curve through it


class SteadyBody:
    """A rigid body of a scene with a level bed, in steady motion; its poses turn about the joint that carries it.

    Attributes
    ----------
    center : ndarray
        (2,) m, the joint's point in the body's frame, or the centre of mass of a body that no joint carries.
    angle : float
        Of the body in the scene's initial state (rad, counter-clockwise).
    lowest : float
        Height of its lowest point over the centre (m) at that angle; below it, so negative or 0.

    Raises
    ------
    SceneError
        There is no such rigid body, no part of it meets the medium, or the surface is not level.
    """

    def __init__(self, scene: Scene, name: str | None = None) -> None:
        if scene.in_space:
            words = "a steady motion is one of the plane; in space fit the forces of a run over time, by --columns"
            raise scene_error("model", f"{words} time_s=HEADER,BODY_granular_z_N=HEADER")
        self._scene, self.body = scene, _chosen(scene, name)
        if scene.bed is None or not scene.bed.layers:
            raise scene_error("medium", "a steady motion needs a medium; got none")
        if not scene.bed.level:
            raise scene_error("bed", "a steady motion needs a medium with a level surface")
        joint = next((c for c in scene.joints if c.child == self.body.name), None)
        self.center = np.zeros(2) if joint is None else np.asarray(joint.child_point, float)
        self.angle = self.body.motion.angle
        self.lowest = min(_lowest(shape, self.angle) for shape in _met(self.body))
        self.lowest -= float((rotation(self.angle) @ self.center)[1])
        self._one = list(self._lines())
        self._loads: dict[int, GranularLoad] = {}  # by the number of poses

    def __getstate__(self) -> dict[str, object]:
        """What is sent to a worker: all but the loads, which are formed where they are needed."""
        return self.__dict__ | {"_loads": {}}

    @property
    def sizes(self) -> tuple[float, ...]:
        """Widths or diameters (m) of the parts that meet the medium."""
        return tuple(shape.width for shape in _met(self.body))

    @property
    def reach(self) -> float:
        """Distance (m) from the centre to the farthest point of what meets the medium."""
        points = [np.hypot(*(shape.points - self.center).T).max() + shape.drop for shape in _met(self.body)]
        return float(max(points))

    def force(
        self,
        depth: Vector,
        velocity: Vector,
        rate: Vector,
        layers: Sequence[Layer] | None = None,
        scatter: Scatter | None = None,
    ) -> Vector:
        """Force of the medium x, y (N) and its moment about the centre (N m, counter-clockwise): (n, 3).

        depth (n,) m: of the lowest point below the surface; velocity (n, 2) m/s of the centre, y up; rate (n,) rad/s,
        counter-clockwise; layers: of other media than the scene's, in the same bed. scatter: of their resistance, in
        which each pose has a place of its own; None: the mean.
        """
        count, scene = len(depth), self._scene
        assert scene.bed is not None  # or there was an error
        media = scene.bed.layers if layers is None else layers
        load = self._copies(count, tuple(_mobilised(layer, scatter) for layer in media), scatter is not None)
        arm = rotation(self.angle) @ self.center  # from the centre of mass
        height = float(scene.bed.profile[0, 1]) - depth - self.lowest
        pose = np.column_stack([np.full(count, -arm[0]), height - arm[1], np.full(count, self.angle)])
        motion = np.column_stack([velocity + rate[:, None] * np.array([arm[1], -arm[0]]), rate])
        q = np.ascontiguousarray(pose.ravel())
        load.start(q)
        found = load.force(q, np.ascontiguousarray(motion.ravel()), np.zeros(3 * count)).reshape(count, 3)
        found[:, 2] += found[:, 0] * arm[1] - found[:, 1] * arm[0]
        return found

    def _copies(self, count: int, layers: tuple[Layer, ...], apart: bool) -> GranularLoad:
        """Load of so many copies of the body, an earlier one again if it fits; apart: at places of their own."""
        scene, known = self._scene, self._loads.get(count)
        if known is not None and not apart and known.renew(layers, STEADY, scene.gravity):
            return known
        load = GranularLoad(
            layers,
            scene.bed.profile if scene.bed is not None else 0.0,
            gravity=scene.gravity,
            static=STEADY,
            form=scene.load.form,
            end_cap=scene.load.end_cap,
        )
        places = np.arange(3 * count).reshape(count, 3)
        away = APART * np.arange(1.0, count + 1.0) if apart else np.zeros(count)
        load.add([_copy(line, *one) for one in zip(places, away, strict=True) for line in self._one])
        load.close()
        if apart:
            return load
        if len(self._loads) >= MOST_LOADS:
            self._loads.clear()
        self._loads[count] = load
        return load

    def _lines(self) -> Sequence[ContactLine]:
        strips, body = self._scene.load.strips_per_rigid_part, Body(self.body.name, [0, 1, 2])
        return [line for shape in _met(self.body) for line in lines_of(body, shape, strips)]


def _copy(line: ContactLine, places: NDArray[np.int64], away: float) -> ContactLine:
    """The line on other coordinates, and elsewhere (m) on the lattice of a medium's scatter."""
    record = line.record
    if away:
        record = record.copy()
        record["place"] += away
    return replace(line, body=Body(line.body.name, places), record=record)


def _mobilised(layer: Layer, scatter: Scatter | None) -> Layer:
    """A layer whose shear needs no path to build up, and whose resistance scatters as said, or is its mean."""
    medium = layer.medium
    plain: dict[str, object] = {"scatter": scatter} if scatter is not medium.scatter else {}
    if medium.shear_grows:
        plain["shear_deformation_modulus"] = 0.0
    return replace(layer, medium=medium.model_copy(update=plain)) if plain else layer


def _chosen(scene: Scene, name: str | None) -> RigidBody:
    """The body of a name, or the only one that meets the medium."""
    able = [body for body in scene.rigid if _met(body)]
    names = ", ".join(body.name for body in able) or "none"
    if name is not None:
        found = next((body for body in able if name in (body.name, *(shape.part for shape in body.shapes))), None)
        if found is None:
            raise scene_error("body", f"there is no rigid body {name!r} that meets the medium; there are {names}")
        return found
    if len(able) != 1:
        raise scene_error("body", f"{len(able)} rigid bodies meet the medium ({names}); say which one")
    return able[0]


def _met(body: RigidBody) -> list[Shape]:
    return [shape for shape in body.shapes if shape.in_sand]


def _lowest(shape: Shape, angle: float) -> float:
    """Height of the lowest point of a shape over the body's origin (m), turned by an angle (rad)."""
    points = shape.points @ rotation(angle).T
    low = float(points[:, 1].min()) - shape.drop
    if shape.turns is None:
        return low
    for (a, b), turn in zip(pairwise(points), shape.turns, strict=True):
        if turn != 0.0:
            low = min(low, _of_arc(a, b, float(turn)))
    return low


def _of_arc(a: Vector, b: Vector, turn: float) -> float:
    """Height of the lowest point of an arc from a to b, (2,) m, that turns by less than half a turn (rad)."""
    chord = b - a
    length = float(np.hypot(*chord))
    radius = 0.5 * length / abs(np.sin(0.5 * turn))
    left = np.array([-chord[1], chord[0]]) / length
    center = 0.5 * (a + b) + left * (0.5 * length / np.tan(0.5 * turn))
    bottom = center - np.array([0.0, radius])
    on_arc = float((bottom - 0.5 * (a + b)) @ left) * np.sign(turn) <= 0.0
    return float(bottom[1]) if on_arc else float(min(a[1], b[1]))
