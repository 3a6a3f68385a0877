"""Coordinates of one instant -> Observations, in the coordinates of the engine."""

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
ROOT = np.zeros(2)  # of a body, m in its frame


class Sensors:
    """Reads observations of a system; `seen`: what there is of them.

    It follows links that bend from row to row, for their slopes do not count whole turns; `follows`: whether it has to.
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
        """Names of bodies, and of those that the medium can meet."""
        met = () if self.load is None else self.load.table.bodies
        return [body.name for body in self.system.scene.bodies], list(met)

    def _find(self, joints: list[Joint]) -> None:
        """Where the coordinates of joints and bodies are, and the lines of bodies."""
        system = self.system
        self._turning: list[tuple[Vector, list[int]]] = []  # angles (1,) of ends on links, places of coordinates
        self._joints = {i: self._joint(joint) for i, joint in enumerate(joints) if not self._turns_rigid(joint)}
        self._rigid = np.array([system.places(name, ROOT) for name in system.rigid], int).reshape(-1, 3)
        self._links = [self._link(name) for name in system.links]
        self._hinges = self._rigid_hinges(joints)
        self._lines = _lines_of(self.load)
        self._above = np.full(len(self._met), -np.inf)

    @property
    def follows(self) -> bool:
        """Whether it has to see all rows."""
        return bool(self._turning)

    # ---- set up ----

    def _turns_rigid(self, joint: Joint) -> bool:
        """Whether it is a hinge of rigid bodies."""
        return joint.kind == "hinge" and not {joint.parent, joint.child} & self.system.links.keys()

    def _joint(self, joint: Joint) -> tuple[Coordinate, list[int]]:
        """Coordinate of a joint, and the places of what it depends on; both with reference values."""
        from granular_contact.mechanics.coordinates import coordinate

        made, found = coordinate(self.system, joint, np.zeros(2)), []
        for i, (body, point) in enumerate(((joint.parent, joint.parent_point), (joint.child, joint.child_point))):
            if body is not None:
                places = self.system.places(body, point)
                found += places
                if body in self.system.links:
                    self._turning.append((made.last_angles[i : i + 1], places))
        self.system.turns.append(made.last_angles)
        return made, found

    def _link(self, name: str) -> tuple[Vector, Vector, list[int]]:
        """Shares (2, m) of coordinates in a link's centre of mass, the angle (1,) at its root, and its places."""
        system, coordinates = self.system, self.system.coordinates
        nodes = np.array([coordinates.places(node) for node in system.links[name].nodes])
        last, places = np.array([system.scene.body(name).motion.angle]), system.places(name, ROOT)
        self._turning.append((last, places))
        system.turns.append(last)
        return center_shares(mass_matrix(system), nodes), last, places

    def _rigid_hinges(self, joints: list[Joint]) -> tuple[Vector, Vector]:
        """Matrix (joints, m) and offsets (joints,) of hinges of rigid bodies."""
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
        """Count the turns of links over rows (n, m) of coordinates that came since the last call."""
        for last, places in self._turning:
            last[0] = np.unwrap([last[0], *np.arctan2(q[:, places[3]], q[:, places[2]])])[-1]

    def read(self, time: float, q: Vector, v: Vector, row: Vector | None) -> Observations:
        """Observations at a time (s) of coordinates (m,), reference values included, and rates.

        row: of the history of the load, None without one. Arrays that are written over later are copied.
        """
        v, row = v.copy(), None if row is None else row.copy()
        depths = [] if self.load is None else [batch.depths.copy() for batch in self.load.batches]
        now = Instant(
            lambda: self.joints(q, v),
            lambda: self.bodies(q, v),
            lambda poses: self.forces(poses, row),
            lambda: self.depths(depths),
        )
        found = Observations(self.seen, time, now)
        return found.computed() if self._turning else found  # turns are counted on, later there are others

    def joints(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Coordinates and rates of joints."""
        matrix, offsets = self._hinges
        coordinates, rates = matrix @ q + offsets, matrix @ v
        for i, (how, places) in self._joints.items():
            coordinates[i], rates[i], _ = how.at(q[places].tolist(), v[places].tolist())
        return coordinates, rates

    def bodies(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Poses and velocities of bodies."""
        poses, velocities = q[self._rigid], v[self._rigid]
        if self._links:
            bent = [self._of_link(q, v, *link) for link in self._links]
            poses = np.vstack([poses, [pose for pose, _ in bent]])
            velocities = np.vstack([velocities, [velocity for _, velocity in bent]])
        poses[:, 2] = 0.0 - poses[:, 2]  # no zero below zero
        velocities[:, 2] = 0.0 - velocities[:, 2]
        return poses, velocities

    @staticmethod
    def _of_link(q: Vector, v: Vector, shares: Vector, last: Vector, places: list[int]) -> tuple[Vector, Vector]:
        angle, rate = _root_angle(last, *q[places][2:], *v[places][2:])
        return np.array([*(shares @ q), angle]), np.array([*(shares @ v), rate])

    def forces(self, poses: Vector, row: Vector | None) -> Vector:
        """Forces of the medium on bodies at their poses (met, 3)."""
        if self.load is None or row is None:
            return np.zeros((0, 3))
        forces = self.load.table.wrenches(row)
        forces[:, 2] = clockwise_moment(forces, poses[self._met, :2])
        return forces

    def depths(self, of_lines: list[Vector]) -> Vector:
        """Depths of bodies (met,) m, by those of the lines of each batch."""
        deepest = self._above.copy()
        for depths, (order, starts, bodies) in zip(of_lines, self._lines, strict=True):
            deepest[bodies] = np.maximum(deepest[bodies], np.maximum.reduceat(depths[order], starts))
        return deepest


def _root_angle(last: Vector, x: float, y: float, x_rate: float, y_rate: float) -> tuple[float, float]:
    """Angle and rate of the slope (x, y) at a root; last (1,) rad: found last, by which whole turns are counted."""
    phi = math.atan2(y, x)
    last[0] = phi + 2.0 * math.pi * round((last[0] - phi) / (2.0 * math.pi))
    return float(last[0]), (x * y_rate - y * x_rate) / (x * x + y * y)


def _lines_of(load: GranularLoad | None) -> list[tuple[Places, Places, Places]]:
    """Of each batch: an order of its lines by their bodies, where in it each body begins, and which body that is."""
    if load is None:
        return []
    found = []
    for batch in load.batches:
        body = np.array([load.table.bodies.index(line.body.name) for line in batch.lines])
        order = np.argsort(body, kind="stable")
        bodies, starts = np.unique(body[order], return_index=True)
        found.append((order, starts, bodies))
    return found
