"""Coordinates of one instant -> Observations, in the generalised coordinates of the engine."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.mass_and_gravity import center_shares, mass_matrix
from granular_contact.mechanics.mechanism import label
from granular_contact.mechanics.system import System
from granular_contact.results.observed import Instant, Observations, Seen
from granular_contact.results.series import clockwise_moment
from granular_contact.scene.types import Joint, Vector

if TYPE_CHECKING:
    from granular_contact.mechanics.coordinates import Coordinate
    from granular_contact.sand.load import GranularLoad


Places = NDArray[np.int64]
ROOT = np.zeros(2)  # m, origin of a body's frame


class Sensors:
    """Sensors that read observations of a system; `seen`: names of the observed joints, bodies and parts.

    The slope at a node of a flexible link does not show whole turns, so `follow` has to be called with every row of
    coordinates where `follows` is true.
    """

    _seen_type: type[Seen] = Seen

    def __init__(self, system: System, load: GranularLoad | None) -> None:
        self.system, self.load = system, load
        joints = [joint for joint in system.scene.joints if joint.has_coordinate]
        bodies, met = self._reported()
        self.seen = self._seen_type(
            tuple(joint.name for joint in joints),
            tuple(joint.kind == "hinge" for joint in joints),
            tuple(label(name) for name in bodies),
            tuple(label(name) for name in met),
            tuple((part, label(name)) for name in bodies for part in name.split("+")[1:]),
        )
        self._met = np.array([bodies.index(name) for name in met], int)
        self._find(joints)

    def _reported(self) -> tuple[list[str], list[str]]:
        """Names of all bodies, and of the bodies that the medium can touch."""
        met = () if self.load is None else self.load.table.bodies
        return [body.name for body in self.system.scene.bodies], list(met)

    def _find(self, joints: list[Joint]) -> None:
        """Find the indices of the coordinates of joints and bodies, and the contact lines of bodies."""
        system = self.system
        # Last angles (1,) of joint ends and roots on flexible links, and indices of the node's coordinates.
        self._turning: list[tuple[Vector, list[int]]] = []
        self._joints = {i: self._joint(joint) for i, joint in enumerate(joints) if not self._turns_rigid(joint)}
        self._rigid = np.array([system.places(name, ROOT) for name in system.rigid], int).reshape(-1, 3)
        self._links = [self._link(name) for name in system.links]
        self._hinges = self._rigid_hinges(joints)
        self._lines = _lines_of(self.load)
        self._above = np.full(len(self._met), -np.inf)

    @property
    def follows(self) -> bool:
        """Whether `follow` has to be called with every row."""
        return bool(self._turning)

    # ---- set up ----

    def _turns_rigid(self, joint: Joint) -> bool:
        """Return whether a joint is a hinge between rigid bodies or the ground."""
        return joint.kind == "hinge" and not {joint.parent, joint.child} & self.system.links.keys()

    def _joint(self, joint: Joint) -> tuple[Coordinate, list[int]]:
        """Coordinate of a joint for q with reference values, and indices of the coordinates that it depends on."""
        from granular_contact.mechanics.coordinates import coordinate

        s, indices = coordinate(self.system, joint, np.zeros(2)), []
        for i, (body, point) in enumerate(((joint.parent, joint.parent_point), (joint.child, joint.child_point))):
            if body is not None:
                places = self.system.places(body, point)
                indices += places
                if body in self.system.links:
                    self._turning.append((s.last_angles[i : i + 1], places))
        self.system.turns.append(s.last_angles)
        return s, indices

    def _link(self, name: str) -> tuple[Vector, Vector, list[int]]:
        """Shares (2, m) of coordinates in a link's centre of mass; last angle (1,) and indices of its root."""
        system, coordinates = self.system, self.system.coordinates
        nodes = np.array([coordinates.places(node) for node in system.links[name].nodes])
        last, places = np.array([system.scene.body(name).motion.angle]), system.places(name, ROOT)
        self._turning.append((last, places))
        system.turns.append(last)
        return center_shares(mass_matrix(system), nodes), last, places

    def _rigid_hinges(self, joints: list[Joint]) -> tuple[Vector, Vector]:
        """Matrix (joints, m) and offsets (joints,): angles of the hinges of rigid bodies are affine in q."""
        matrix, offsets = np.zeros((len(joints), self.system.coordinates.size)), np.zeros(len(joints))
        for i, joint in enumerate(joints):
            if i not in self._joints:
                offsets[i] = joint.offset
                matrix[i, self.system.places(joint.child, joint.child_point)[2]] = -1.0
                if joint.parent is not None:
                    matrix[i, self.system.places(joint.parent, joint.parent_point)[2]] = 1.0
        return matrix, offsets

    # ---- read ----

    def follow(self, q: Vector) -> None:
        """Count whole turns of flexible links over the rows (n, m) of coordinates since the last call."""
        for last, places in self._turning:
            last[0] = np.unwrap([last[0], *np.arctan2(q[:, places[3]], q[:, places[2]])])[-1]

    def read(self, time: float, q: Vector, v: Vector, row: Vector | None) -> Observations:
        """Observations at a time (s) from coordinates (m,), reference values included, and rates (m,).

        row: row of the load's history, None without a load. Arrays that are overwritten later are copied.
        """
        v, row = v.copy(), None if row is None else row.copy()
        depths = [] if self.load is None else [batch.depths.copy() for batch in self.load.batches]
        now = Instant(
            lambda: self.joints(q, v),
            lambda: self.bodies(q, v),
            lambda poses: self.forces(poses, row),
            lambda: self.depths(depths),
        )
        observations = Observations(self.seen, time, now)
        # With flexible links they are computed now: whole turns are counted on, so later they would be others.
        return observations.computed() if self._turning else observations

    def joints(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Coordinates and rates (joints,) of joints."""
        matrix, offsets = self._hinges
        coordinates, rates = matrix @ q + offsets, matrix @ v
        for i, (s, places) in self._joints.items():
            coordinates[i], rates[i], _ = s.at(q[places].tolist(), v[places].tolist())
        return coordinates, rates

    def bodies(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Poses and velocities (bodies, 3) of bodies: centre of mass x, y and angle, clockwise."""
        poses, velocities = q[self._rigid], v[self._rigid]
        if self._links:
            links = [self._link_pose(q, v, *link) for link in self._links]
            poses = np.vstack([poses, [pose for pose, _ in links]])
            velocities = np.vstack([velocities, [velocity for _, velocity in links]])
        poses[:, 2] = 0.0 - poses[:, 2]  # avoids a negative zero
        velocities[:, 2] = 0.0 - velocities[:, 2]
        return poses, velocities

    @staticmethod
    def _link_pose(q: Vector, v: Vector, shares: Vector, last: Vector, places: list[int]) -> tuple[Vector, Vector]:
        """Pose (3,) and velocity (3,) of a flexible link: of its centre of mass, and the angle of its root."""
        angle, rate = _root_angle(last, *q[places][2:], *v[places][2:])
        return np.array([*(shares @ q), angle]), np.array([*(shares @ v), rate])

    def forces(self, poses: Vector, row: Vector | None) -> Vector:
        """Forces (met, 3) on bodies at their poses: x, y (N), and clockwise moment (N m) about the centre."""
        if self.load is None or row is None:
            return np.zeros((0, 3))
        forces = self.load.table.wrenches(row)
        forces[:, 2] = clockwise_moment(forces, poses[self._met, :2])
        return forces

    def depths(self, line_depths: list[Vector]) -> Vector:
        """Depths (met,) m of bodies, from the depths of the contact lines of each batch."""
        deepest = self._above.copy()
        for depths, (order, starts, bodies) in zip(line_depths, self._lines, strict=True):
            deepest[bodies] = np.maximum(deepest[bodies], np.maximum.reduceat(depths[order], starts))
        return deepest


def _root_angle(last: Vector, x: float, y: float, x_rate: float, y_rate: float) -> tuple[float, float]:
    """Angle and rate of the slope (x, y) at a root; last (1,) rad: last angle, by which whole turns are counted."""
    phi = math.atan2(y, x)
    last[0] = phi + 2.0 * math.pi * round((last[0] - phi) / (2.0 * math.pi))
    return float(last[0]), (x * y_rate - y * x_rate) / (x * x + y * y)


def _lines_of(load: GranularLoad | None) -> list[tuple[Places, Places, Places]]:
    """Contact lines of each batch by body: their order, the start of each body in it, and index of the body."""
    if load is None:
        return []
    batches = []
    for batch in load.batches:
        body = np.array([load.table.bodies.index(line.body.name) for line in batch.lines])
        order = np.argsort(body, kind="stable")
        bodies, starts = np.unique(body[order], return_index=True)
        batches.append((order, starts, bodies))
    return batches
