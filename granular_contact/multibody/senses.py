"""Coordinates of one instant -> Observations, in the coordinates of the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.multibody.coordinates import End, Hinge, RigidHinge, Slider, coordinate
from granular_contact.multibody.mass_and_gravity import mass_matrix
from granular_contact.multibody.mechanism import label
from granular_contact.multibody.system import System
from granular_contact.results.observed import Observations, Seen
from granular_contact.results.series import clockwise_moment
from granular_contact.scene.types import Connection, Vector

if TYPE_CHECKING:
    from granular_contact.bed.load import GranularLoad


class Senses:
    """Reads observations of a system; `seen`: what there is of them.

    It follows links that bend from row to row, for their slopes do not tell whole turns.
    """

    def __init__(self, system: System, load: GranularLoad | None) -> None:
        self.system, self.load = system, load
        scene = system.scene
        joints = [joint for joint in scene.connections if joint.has_coordinate]
        bodies = [body.name for body in scene.bodies]
        of_load = () if load is None else load.table.bodies
        self.seen = Seen(
            tuple(joint.name for joint in joints),
            tuple(joint.kind == "hinge" for joint in joints),
            tuple(label(name) for name in bodies),
            tuple(label(name) for name in of_load),
        )
        self._nodes: dict[str, list[list[int]]] = {
            name: [list(system.mbs.systemData.GetNodeLTGODE2(node)) for node in nodes]
            for name, nodes in self._all_nodes().items()
        }
        self._turning: list[tuple[End, list[int]]] = []  # ends on links, with the places of their coordinates
        self._joints = [self._joint(joint) for joint in joints]
        self._rigid = np.array([self._nodes[name][0] for name in system.rigid], int).reshape(-1, 3)
        self._links = [self._link(name) for name in system.links]
        self._hinges = self._rigid_hinges(joints)
        self._met = np.array([bodies.index(name) for name in of_load], int)
        self._lines = _lines_of(load)

    def _all_nodes(self) -> dict[str, tuple[int, ...]]:
        rigid = {name: (handle.node,) for name, handle in self.system.rigid.items()}
        return rigid | {name: handle.nodes for name, handle in self.system.links.items()}

    # ---- set up ----

    def _end(self, body: str | None, point: Vector) -> tuple[End, list[int]]:
        """End of a joint for coordinates with their reference values, and the places of these."""
        if body is None:
            return End([], point.tolist()), []
        bends = body in self.system.links
        places = self._nodes[body][self.system.links[body].end(point) if bends else 0]
        end = End([0.0] * len(places), [0.0, 0.0] if bends else point.tolist(), self._start(body))
        if bends:
            self._turning.append((end, places))
            self.system.ends.append(end)
        return end, places

    def _start(self, body: str) -> float:
        return self.system.scene.body(body).motion.angle

    def _joint(self, joint: Connection) -> tuple[Hinge | Slider, list[int]]:
        (parent, first), (child, second) = (
            self._end(joint.parent, joint.parent_point),
            self._end(joint.child, joint.child_point),
        )
        return coordinate(joint, parent, child), first + second

    def _link(self, name: str) -> tuple[Vector, End, list[int]]:
        """Shares (2, m) of coordinates in a link's centre of mass, the end at its root, and its places."""
        mass, nodes = mass_matrix(self.system), np.array(self._nodes[name])
        shares = []
        for axis in (0, 1):
            along = np.zeros(mass.shape[0])
            along[nodes[:, axis]] = 1.0
            shares.append(mass @ along / (along @ mass @ along))
        return np.array(shares), *self._end(name, np.zeros(2))

    def _rigid_hinges(self, joints: list[Connection]) -> tuple[Vector, Vector, list[int]]:
        """Matrix (joints, m) and offsets (joints,) of hinges of rigid bodies; the joints that are none."""
        matrix, offsets = np.zeros((len(joints), self.system.mbs.systemData.ODE2Size())), np.zeros(len(joints))
        others = []
        for i, (joint, (how, places)) in enumerate(zip(joints, self._joints, strict=True)):
            if not isinstance(how, RigidHinge):
                others.append(i)
                continue
            offsets[i] = joint.offset
            matrix[i, places[-1]] = -1.0
            if joint.parent is not None:
                matrix[i, places[2]] = 1.0
        return matrix, offsets, others

    # ---- read ----

    def follow(self, q: Vector) -> None:
        """Count the turns of links over rows (n, m) of coordinates that came since it was told some last."""
        for end, places in self._turning:
            end.last = float(np.unwrap([end.last, *np.arctan2(q[:, places[3]], q[:, places[2]])])[-1])

    def read(self, time: float, q: Vector, v: Vector, row: Vector | None) -> Observations:
        """Observations at a time (s) of coordinates (m,), reference values included, and rates.

        row: of the history of the load, None without one.
        """
        matrix, offsets, others = self._hinges
        coordinates, rates = matrix @ q + offsets, matrix @ v
        for i in others:
            how, places = self._joints[i]
            coordinates[i], rates[i], _ = how.at(q[places].tolist(), v[places].tolist())
        poses, velocities = q[self._rigid], v[self._rigid]
        if self._links:
            bent = [self._of_link(q, v, *link) for link in self._links]
            poses = np.vstack([poses, [pose for pose, _ in bent]])
            velocities = np.vstack([velocities, [velocity for _, velocity in bent]])
        poses[:, 2] *= -1.0
        velocities[:, 2] *= -1.0
        forces, depths = self._medium(poses, row)
        return Observations(self.seen, time, coordinates, rates, poses, velocities, forces, depths)

    @staticmethod
    def _of_link(q: Vector, v: Vector, shares: Vector, end: End, places: list[int]) -> tuple[Vector, Vector]:
        angle, rate, _ = end.angle(q[places].tolist(), v[places].tolist())
        return np.array([*(shares @ q), angle]), np.array([*(shares @ v), rate])

    def _medium(self, poses: Vector, row: Vector | None) -> tuple[Vector, Vector]:
        """Forces (met, 3) and depths (met,) of the medium."""
        if self.load is None or row is None:
            return np.zeros((0, 3)), np.zeros(0)
        forces = self.load.table.wrenches(row)
        forces[:, 2] = clockwise_moment(forces, poses[self._met, :2])
        depths = np.full(len(self._met), -np.inf)
        for batch, places in zip(self.load.batches, self._lines, strict=True):
            np.maximum.at(depths, places, batch.depths)
        return forces, depths


def _lines_of(load: GranularLoad | None) -> list[list[int]]:
    """Body of each line of each batch, by its place among those of the load."""
    if load is None:
        return []
    return [[load.table.bodies.index(line.body) for line in batch.lines] for batch in load.batches]
