"""Coordinates of one instant -> Observations, in space."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from granular_contact.geometry import rotations
from granular_contact.mechanics.sensors import Sensors
from granular_contact.mechanics.space.coordinates import coordinate
from granular_contact.mechanics.space.kinematics import angular
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.results.in_space import SpatialSeen
from granular_contact.results.observed import Instant, Observations
from granular_contact.sand.work import wrenches_about
from granular_contact.scene.space.types import SpatialBeam, reach
from granular_contact.scene.types import Vector, link_of


class SpatialSensors(Sensors):
    """Sensors in space; orientations do not show whole turns, so `follow` counts those of hinges."""

    system: SpatialSystem
    _seen_type = SpatialSeen

    def _reported(self) -> tuple[list[str], list[str]]:
        met = () if self.load is None else self.load.table.bodies
        return list(self.system.scene.reported), list(dict.fromkeys(link_of(name) for name in met))

    def _find(self, joints: list[Any]) -> None:
        system, coordinates, scene = self.system, self.system.coordinates, self.system.scene
        at = [coordinates.places(system.rigid[body.name].node) for body in scene.bodies]
        self._at = np.array(at, int).reshape(-1, 7)
        self._number = {body.name: i for i, body in enumerate(scene.bodies)}
        self._whole = [i for i, body in enumerate(scene.rigid) if not body.is_element]
        met, links = self._reported()[1], () if self.load is None else self.load.table.bodies
        # For each body of the load: its row among the reported bodies, and its index among bodies.
        self._loaded = [(met.index(link_of(name)), self._number[name]) for name in links]
        self._find_joints(joints)
        self._find_points()

    def _find_joints(self, joints: list[Any]) -> None:
        """Find the indices of the coordinates of joints."""
        system, coordinates = self.system, self.system.coordinates

        def at_nodes(joint: Any) -> list[int]:
            return [place for node in system.nodes_of(joint) for place in coordinates.places(node)]

        self._coordinates = [(coordinate(system, joint), at_nodes(joint)) for joint in joints]
        system.turns.extend(joint.last_angles for joint, _ in self._coordinates)

    @property
    def follows(self) -> bool:
        """Whether `follow` has to be called with every row: there are hinges."""
        return any(self.seen.hinges)

    def follow(self, q: Vector) -> None:
        """Count whole turns of hinges over the rows (n, m) of coordinates since the last call."""
        still = [0.0] * 14
        for (joint, places), is_hinge in zip(self._coordinates, self.seen.hinges, strict=True):
            for row in q[:, places] if is_hinge else ():
                joint.at(row.tolist(), still)

    def read(self, time: float, q: Vector, v: Vector, row: Vector | None) -> Observations:
        """See `Sensors.read`."""
        v, row = v.copy(), None if row is None else row.copy()
        joints = self.joints(q, v)  # now, as whole turns are counted on
        axes = cache(lambda: rotations.of_quaternion(q[self._at[:, 3:]]))  # of bodies
        now = Instant(
            lambda: joints,
            lambda: self.placed(q, v, axes()),
            lambda poses: self.forces(poses, row),
            lambda: self.deepest(q, axes()),
        )
        return Observations(self.seen, time, now)

    def joints(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """See `Sensors.joints`."""
        pairs = [joint.at(q[places].tolist(), v[places].tolist())[:2] for joint, places in self._coordinates]
        coordinates, rates = np.array(pairs).reshape(-1, 2).T
        return coordinates, rates

    def placed(self, q: Vector, v: Vector, R: Vector) -> tuple[Vector, Vector]:
        """Poses and velocities of bodies, (bodies, 6) each, from their axes R (bodies, 3, 3)."""
        places, rates = q[self._at], v[self._at]
        spin = angular(places[:, 3:], rates[:, 3:])
        poses = np.concatenate([places[:, :3], rotations.rpy_of(R)], axis=1)[self._whole]
        velocities = np.concatenate([rates[:, :3], spin], axis=1)[self._whole]
        for beam in self.system.scene.beams:
            pose, velocity = self._beam_pose(beam, places[:, :3], R, rates[:, :3], spin)
            poses, velocities = np.vstack([poses, pose]), np.vstack([velocities, velocity])
        return poses, velocities

    def _beam_pose(self, beam: SpatialBeam, x: Vector, R: Vector, v: Vector, spin: Vector) -> tuple[Vector, Vector]:
        """Pose (6,) and velocity (6,) of a flexible link: of its centre of mass, and of the frame of its root."""
        place, velocity, total = np.zeros(3), np.zeros(3), sum(mass for *_, mass in beam.pieces)
        for body, point, mass in beam.pieces:
            position, speed = point, np.zeros(3)
            if body is not None:
                i = self._number[body]
                arm = R[i] @ point
                position, speed = x[i] + arm, v[i] + np.cross(spin[i], arm)
            place, velocity = place + mass / total * position, velocity + mass / total * speed
        body, _, axes = beam.root
        turn, turning = axes, np.zeros(3)
        if body is not None:
            turn, turning = R[self._number[body]] @ axes, spin[self._number[body]]
        return np.concatenate([place, rotations.rpy_of(turn)]), np.concatenate([velocity, turning])

    def forces(self, poses: Vector, row: Vector | None) -> Vector:
        """Wrenches (met, 6) of the medium, with moments about the centres of mass."""
        if self.load is None or row is None:
            return np.zeros((0, 6))
        wrenches = np.zeros((len(self._met), 6))
        for (i, _), wrench in zip(self._loaded, self.load.table.wrenches(row), strict=True):
            wrenches[i] += wrench
        return wrenches_about(wrenches, poses[self._met, :3])

    def _find_points(self) -> None:
        """Find the outermost points of shapes in the medium: their bodies, places and reach.

        Points are sorted by reported body; the first of each is at an index of `_firsts`.
        """
        bodies, blocks = self.system.scene.rigid, []
        for k, i in sorted(self._loaded):
            for part in bodies[i].parts:
                if part.in_sand:
                    n, as_ball = len(part.points), float(part.meets == ("ball",))
                    numbers = np.tile([k, i, part.drop, as_ball], (n, 1))
                    blocks.append(np.column_stack([numbers, part.points]))
        table = np.concatenate(blocks) if blocks else np.zeros((0, 7))
        self._of_points, self._points = table[:, 1].astype(int), table[:, 4:]
        self._drops, self._as_balls = table[:, 2], table[:, 3] > 0.0
        self._firsts = np.searchsorted(table[:, 0], np.arange(len(self._met)))

    def deepest(self, q: Vector, R: Vector) -> Vector:
        """Depths (met,) m of the deepest points of reported bodies; R (bodies, 3, 3): axes of bodies."""
        if len(self._met) == 0:
            return np.zeros(0)
        bed: Any = self.system.scene.bed  # not None, as bodies are in the medium
        centers = q[self._at[:, :3]][self._of_points]
        x, y, z = (centers + np.einsum("nij,nj->ni", R[self._of_points], self._points)).T
        height, *slopes = bed.tangent(x, y)
        return np.maximum.reduceat(height - z + reach(self._drops, self._as_balls, *slopes), self._firsts)
