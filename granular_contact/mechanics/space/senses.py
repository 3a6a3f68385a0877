"""Coordinates of one instant -> Observations, in space."""

from __future__ import annotations

from typing import Any

import numpy as np

from granular_contact.geometry import rotations
from granular_contact.mechanics.senses import Senses
from granular_contact.mechanics.space.coordinates import coordinate
from granular_contact.mechanics.space.kinematics import SpatialKinematics, angular
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.system import Trajectory
from granular_contact.results.in_space import SpatialSeen
from granular_contact.results.observed import Instant, Observations
from granular_contact.sand.work import about
from granular_contact.scene.types import Vector


class SpatialSenses(Senses):
    """As `Senses`. It follows hinges from row to row, for the orientations of bodies do not count whole turns."""

    system: SpatialSystem
    _seen_type = SpatialSeen

    def _find(self, joints: list[Any]) -> None:
        system, coordinates = self.system, self.system.coordinates
        at = [coordinates.places(system.rigid[body.name].node) for body in system.scene.bodies]
        self._at = np.array(at, int).reshape(-1, 7)

        def at_nodes(joint: Any) -> list[int]:
            return [place for node in system.nodes_of(joint) for place in coordinates.places(node)]

        self._coordinates = [(coordinate(system, joint, whole=True), at_nodes(joint)) for joint in joints]
        system.turns.extend(made.last_angles for made, _ in self._coordinates)

    @property
    def follows(self) -> bool:
        """As of `Senses`."""
        return any(self.seen.hinges)

    def kinematics(self, trajectory: Trajectory) -> SpatialKinematics:
        """As of `Senses`."""
        return SpatialKinematics(self.system, trajectory)

    def follow(self, q: Vector) -> None:
        """Count the turns of hinges over rows (n, m) of coordinates that came since the last call."""
        still = [0.0] * 14
        for (joint, places), is_hinge in zip(self._coordinates, self.seen.hinges, strict=True):
            for row in q[:, places] if is_hinge else ():
                joint.at(row.tolist(), still)

    def read(self, time: float, q: Vector, v: Vector, row: Vector | None) -> Observations:
        """As of `Senses`."""
        v, row = v.copy(), None if row is None else row.copy()
        joints = self.joints(q, v)  # at once, as a hinge counts its turns on
        now = Instant(
            lambda: joints,
            lambda: self.bodies(q, v),
            lambda _: (self.forces(q, row), self.depths(q)),
        )
        return Observations(self.seen, time, now)

    def joints(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """As of `Senses`."""
        found = [joint.at(q[at].tolist(), v[at].tolist())[:2] for joint, at in self._coordinates]
        coordinates, rates = np.array(found).reshape(-1, 2).T
        return coordinates, rates

    def bodies(self, q: Vector, v: Vector) -> tuple[Vector, Vector]:
        """Poses and velocities of bodies, (bodies, 6) each."""
        places, rates = q[self._at], v[self._at]
        e = places[:, 3:]
        spin, angles = angular(e, rates[:, 3:]), rotations.rpy_of(rotations.of_quaternion(e))
        return np.concatenate([places[:, :3], angles], axis=1), np.concatenate([rates[:, :3], spin], axis=1)

    def forces(self, q: Vector, row: Vector | None) -> Vector:
        """Forces of the medium (met, 6), moments about the centres of mass."""
        if self.load is None or row is None:
            return np.zeros((0, 6))
        return about(self.load.table.wrenches(row), q[self._at[self._met, :3]])

    def depths(self, q: Vector) -> Vector:
        """Depths (met,) m of the deepest points of bodies."""
        scene, deepest = self.system.scene, np.full(len(self._met), -np.inf)
        bed: Any = scene.bed  # there is one where something is in sand
        for k, i in enumerate(self._met):
            at = q[self._at[i]]
            R = rotations.of_quaternion(at[None, 3:])[0]
            for part in scene.bodies[i].parts:
                if part.in_sand:
                    x, y, z = (part.points @ R.T + at[:3]).T
                    deepest[k] = max(deepest[k], float((bed.height(x, y) - z).max()) + part.drop)
        return deepest
