"""Force on one rigid body in steady motion, at many poses at once: a law by itself, on a whole shape.

A plate that is pressed in at a given speed, or a wheel that turns at a given slip, needs no integration. At every depth
the force follows from pose and velocity alone, if the resistance is fully mobilised. This includes shear that builds up
along a path, as that of Janosi and Hanamoto. All poses are copies of the body in one load, so that a curve of 200
points is one compiled call.
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
from granular_contact.sand.from_scene import lines_from_shape
from granular_contact.sand.load import SHAPE_SPACING, GranularLoad
from granular_contact.scene.parts import RigidBody, Shape, rotation
from granular_contact.scene.types import Scene

Vector = NDArray[np.float64]

MOST_LOADS = 4  # loads that are kept, with different numbers of poses: those of a table, and of a curve


class SteadyBody:
    """Rigid body of a scene with a level bed, in steady motion. Its poses turn about the joint that carries it.

    Parameters
    ----------
    scene : Scene
        The scene.
    name : str, optional
        Name of the body, or of a part on it; by default the only body that can meet the medium.

    Attributes
    ----------
    center : (2,) array
        Point of the joint in the frame of the body (m); the centre of mass of a body without a joint.
    angle : float
        Angle of the body in the initial state of the scene (rad, counter-clockwise).
    lowest : float
        Height (m) of the lowest point of the body relative to the centre at that angle, so 0 or less.

    Raises
    ------
    SceneError
        There is no such rigid body, no part of it meets the medium, or the surface is not level.
    """

    def __init__(self, scene: Scene, name: str | None = None) -> None:
        if scene.in_space:
            reason = "a steady motion is one of the plane; in space fit the forces of a run over time, by --columns"
            raise scene_error("model", f"{reason} time_s=HEADER,BODY_granular_z_N=HEADER")
        self._scene, self.body = scene, _chosen_body(scene, name)
        if scene.bed is None or not scene.bed.layers:
            raise scene_error("medium", "a steady motion needs a medium; got none")
        if not scene.bed.level:
            raise scene_error("bed", "a steady motion needs a medium with a level surface")
        joint = next((candidate for candidate in scene.joints if candidate.child == self.body.name), None)
        self.center = np.zeros(2) if joint is None else np.asarray(joint.child_point, float)
        self.angle = self.body.motion.angle
        self.lowest = min(_lowest(shape, self.angle) for shape in _sand_shapes(self.body))
        self.lowest -= float((rotation(self.angle) @ self.center)[1])
        self._template = list(self._lines())
        self._loads: dict[int, GranularLoad] = {}  # loads by their number of poses

    def __getstate__(self) -> dict[str, object]:
        """State for a worker process, without the loads, which each process forms itself."""
        return self.__dict__ | {"_loads": {}}

    @property
    def sizes(self) -> tuple[float, ...]:
        """Widths or diameters (m) of the parts that meet the medium."""
        return tuple(shape.width for shape in _sand_shapes(self.body))

    @property
    def reach(self) -> float:
        """Distance (m) from the centre to the farthest point of the parts that meet the medium."""
        points = [np.hypot(*(shape.points - self.center).T).max() + shape.drop for shape in _sand_shapes(self.body)]
        return float(max(points))

    def force(
        self,
        depth: Vector,
        velocity: Vector,
        rate: Vector,
        layers: Sequence[Layer] | None = None,
        scatter: Scatter | None = None,
    ) -> Vector:
        """Force and moment of the medium at many poses.

        Parameters
        ----------
        depth : (n,) array
            Depth of the lowest point below the surface (m).
        velocity : (n, 2) array
            Velocity of the centre (m/s), y up.
        rate : (n,) array
            Angular velocity (rad/s), counter-clockwise.
        layers : sequence of Layer, optional
            Layers with other media, in the bed of the scene.
        scatter : Scatter, optional
            Scatter of the resistance, in which each pose has a place of its own; None: mean resistance.

        Returns
        -------
        (n, 3) array
            Force x, y (N), and moment about the centre (N m, counter-clockwise).
        """
        count, scene = len(depth), self._scene
        assert scene.bed is not None  # else the constructor raises
        media = scene.bed.layers if layers is None else layers
        load = self._copies(count, tuple(_mobilised(layer, scatter) for layer in media), scatter is not None)
        arm = rotation(self.angle) @ self.center  # from the centre of mass to the centre
        height = float(scene.bed.profile[0, 1]) - depth - self.lowest
        pose = np.column_stack([np.full(count, -arm[0]), height - arm[1], np.full(count, self.angle)])
        motion = np.column_stack([velocity + rate[:, None] * np.array([arm[1], -arm[0]]), rate])
        q = np.ascontiguousarray(pose.ravel())
        load.start(q)
        wrenches = load.force(q, np.ascontiguousarray(motion.ravel()), np.zeros(3 * count)).reshape(count, 3)
        wrenches[:, 2] += wrenches[:, 0] * arm[1] - wrenches[:, 1] * arm[0]
        return wrenches

    def _copies(self, count: int, layers: tuple[Layer, ...], apart: bool) -> GranularLoad:
        """Load of so many copies of the body; an earlier load if it fits.

        apart: whether each copy has its own scatter.
        """
        scene, earlier = self._scene, self._loads.get(count)
        if earlier is not None and not apart and earlier.renew(layers, STEADY, scene.gravity):
            return earlier
        load = GranularLoad(
            layers,
            scene.bed.profile if scene.bed is not None else 0.0,
            gravity=scene.gravity,
            static=STEADY,
            form=scene.load.form,
            end_cap=scene.load.end_cap,
        )
        places = np.arange(3 * count).reshape(count, 3)
        offsets = SHAPE_SPACING * np.arange(1.0, count + 1.0) if apart else np.zeros(count)
        load.add([_copy(line, *copy) for copy in zip(places, offsets, strict=True) for line in self._template])
        load.close()
        if apart:
            return load
        if len(self._loads) >= MOST_LOADS:
            self._loads.clear()
        self._loads[count] = load
        return load

    def _lines(self) -> Sequence[ContactLine]:
        """Contact lines of the body."""
        strips, body = self._scene.load.strips_per_rigid_part, Body(self.body.name, [0, 1, 2])
        return [line for shape in _sand_shapes(self.body) for line in lines_from_shape(body, shape, strips)]


def _copy(line: ContactLine, places: NDArray[np.int64], offset: float) -> ContactLine:
    """Contact line with other coordinates, moved by a distance (m) on the lattice of the scatter."""
    record = line.record
    if offset:
        record = record.copy()
        record["place"] += offset
    return replace(line, body=Body(line.body.name, places), record=record)


def _mobilised(layer: Layer, scatter: Scatter | None) -> Layer:
    """Layer whose shear is fully mobilised, and whose resistance has this scatter, or is the mean."""
    medium = layer.medium
    changes: dict[str, object] = {"scatter": scatter} if scatter is not medium.scatter else {}
    if medium.shear_grows:
        changes["shear_deformation_modulus"] = 0.0
    return replace(layer, medium=medium.model_copy(update=changes)) if changes else layer


def _chosen_body(scene: Scene, name: str | None) -> RigidBody:
    """Body of this name, or the only body that meets the medium."""
    bodies = [body for body in scene.rigid if _sand_shapes(body)]
    names = ", ".join(body.name for body in bodies) or "none"
    if name is not None:
        named = (body for body in bodies if name in (body.name, *(shape.part for shape in body.shapes)))
        body = next(named, None)
        if body is None:
            raise scene_error("body", f"there is no rigid body {name!r} that meets the medium; there are {names}")
        return body
    if len(bodies) != 1:
        raise scene_error("body", f"{len(bodies)} rigid bodies meet the medium ({names}); say which one")
    return bodies[0]


def _sand_shapes(body: RigidBody) -> list[Shape]:
    """Shapes of a body that meet the medium."""
    return [shape for shape in body.shapes if shape.in_sand]


def _lowest(shape: Shape, angle: float) -> float:
    """Height (m) of the lowest point of a shape relative to the origin of the body, at an angle (rad)."""
    points = shape.points @ rotation(angle).T
    low = float(points[:, 1].min()) - shape.drop
    if shape.turns is None:
        return low
    for (a, b), turn in zip(pairwise(points), shape.turns, strict=True):
        if turn != 0.0:
            low = min(low, _lowest_of_arc(a, b, float(turn)))
    return low


def _lowest_of_arc(a: Vector, b: Vector, turn: float) -> float:
    """Height of the lowest point of an arc from a to b, (2,) m, that turns by less than half a turn (rad)."""
    chord = b - a
    length = float(np.hypot(*chord))
    radius = 0.5 * length / abs(np.sin(0.5 * turn))
    left = np.array([-chord[1], chord[0]]) / length
    center = 0.5 * (a + b) + left * (0.5 * length / np.tan(0.5 * turn))
    bottom = center - np.array([0.0, radius])
    on_arc = float((bottom - 0.5 * (a + b)) @ left) * np.sign(turn) <= 0.0
    return float(bottom[1]) if on_arc else float(min(a[1], b[1]))
