"""Positions, orientations and rates of bodies and joints in space, from the coordinates of all accepted steps."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from granular_contact.geometry import rotations
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.space.beams import BeamMotion
from granular_contact.mechanics.space.constraints import SpatialConstraints
from granular_contact.mechanics.space.system import SpatialSystem
from granular_contact.mechanics.strains import Strains
from granular_contact.mechanics.system import Trajectory
from granular_contact.results import Outline
from granular_contact.results.energy import work
from granular_contact.results.in_space import silhouette
from granular_contact.results.interpolation import Track
from granular_contact.scene.space.types import Part, SpatialJoint, SpatialScene, Vector
from granular_contact.scene.types import link_of


class SpatialKinematics(Kinematics):
    """The motion of a system along a trajectory; (n,) and (n, 3) arrays over its instants, world frame.

    engine: the trajectory in the engine's coordinates. trajectory: the same, with the rates of every body one after
    another, the velocity of its centre of mass along the axes of the world and the angular velocity along its own, in
    which the mass matrix is constant.
    """

    system: SpatialSystem
    scene: SpatialScene

    def __init__(self, system: SpatialSystem, trajectory: Trajectory) -> None:
        self.system, self.scene, self.engine = system, system.scene, trajectory
        coordinates = system.coordinates
        self._places = {name: np.array(coordinates.places(h.node)) for name, h in system.rigid.items()}
        masses: list[Vector] = []
        rates = [np.zeros((len(trajectory.time), 0))]
        for name, handle in system.rigid.items():
            spin = np.einsum("nji,nj->ni", self.rotation(name), self.spin(name))
            rates += [trajectory.v[:, self._places[name][:3]], spin]
            masses += [np.eye(3) * handle.body.mass, handle.body.inertia]
        mass = np.zeros((3 * len(masses),) * 2)
        for i, one in enumerate(masses):
            mass[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = one
        self.trajectory = replace(trajectory, v=np.concatenate(rates, axis=1), mass=mass)

    @property
    def accelerations(self) -> Vector:
        """The engine's accelerations (n, m) in the coordinates of the rates; there are some with prescribed motions."""
        a = self.engine.a
        assert a is not None
        found = []
        for name, at in self._places.items():
            turning = angular(self.engine.q[:, at[3:]], a[:, at[3:]])  # e' adds nothing: G' e' = 0
            found += [a[:, at[:3]], np.einsum("nji,nj->ni", self.rotation(name), turning)]
        return np.concatenate(found, axis=1)

    @cached_property
    def constraints(self) -> SpatialConstraints:  # type: ignore[override]
        """What joints ask of accelerations."""
        return SpatialConstraints(self)

    @cached_property
    def _rotations(self) -> dict[str, Vector]:
        return {name: rotations.of_quaternion(self.engine.q[:, at[3:]]) for name, at in self._places.items()}

    @cached_property
    def _spins(self) -> dict[str, Vector]:
        q, v = self.engine.q, self.engine.v
        return {name: angular(q[:, at[3:]], v[:, at[3:]]) for name, at in self._places.items()}

    @cached_property
    def beams(self) -> dict[str, BeamMotion]:
        """Links that bend, by name."""
        return {beam.name: BeamMotion(self, beam) for beam in self.scene.beams}

    def reported(self, body: str) -> str:
        """As of `Kinematics`: of an element of a link that bends the name of the link."""
        return link_of(body)

    def rotation(self, name: str | None) -> Vector:
        """Rotation (n, 3, 3) of a body's frame, of a link that bends of that of its root; None is the ground."""
        if name is None:
            return np.broadcast_to(np.eye(3), (len(self.engine.time), 3, 3))
        if name in self.beams:
            return self.beams[name].frame(self.beams[name].beam.root)
        return self._rotations[name]

    def quaternion(self, name: str) -> Vector:
        """Orientation (n, 4) of a body."""
        e = self.engine.q[:, self._places[name][3:]]
        return np.asarray(e / np.linalg.norm(e, axis=1, keepdims=True))

    def spin(self, name: str | None) -> Vector:
        """Angular velocity (n, 3) rad/s of a body, of a link that bends that of its root; w = G(e) e'."""
        if name in self.beams:
            name = self.beams[name].beam.root[0]
        if name is None:
            return np.zeros((len(self.engine.time), 3))
        return self._spins[name]

    def position(self, name: str | None, point: Vector) -> tuple[Vector, Vector]:
        """Position and velocity (n, 3) of a body-frame point; None is the ground."""
        if name is None:
            fixed = np.broadcast_to(point, (len(self.engine.time), 3))
            return fixed, 0.0 * fixed
        at = self._places[name][:3]
        arm = self.rotation(name) @ point
        return self.engine.q[:, at] + arm, self.engine.v[:, at] + np.cross(self.spin(name), arm)

    def center(self, name: str) -> tuple[Vector, Vector]:
        """Centre of mass (n, 3) m of a body, and its velocity."""
        if name in self.beams:
            return self.beams[name].center
        at = self._places[name][:3]
        return self.engine.q[:, at], self.engine.v[:, at]

    def coordinate(self, joint: SpatialJoint) -> tuple[Vector, Vector]:  # type: ignore[override]
        """Coordinate (n,) rad, right-handed, or m, of a hinge or slider, angle from home of a ball joint; its rate."""
        if joint.kind == "ball":
            angle, axis = self.from_home(joint)
            return angle, np.sum(axis * (self.spin(joint.child) - self.spin(joint.parent)), axis=1)
        frame = self.rotation(joint.parent) @ joint.parent_turn
        axis = frame[:, :, 2]
        if joint.kind == "hinge":
            x = self.rotation(joint.child) @ joint.child_turn[:, 0]
            angle = np.unwrap(np.arctan2(np.sum(frame[:, :, 1] * x, axis=1), np.sum(frame[:, :, 0] * x, axis=1)))
            angle += 2.0 * np.pi * np.round((joint.start - angle[0]) / (2.0 * np.pi))
            return angle, np.sum(axis * (self.spin(joint.child) - self.spin(joint.parent)), axis=1)
        on_parent, parent_speed = self.position(joint.parent, joint.parent_point)
        on_child, child_speed = self.position(joint.child, joint.child_point)
        apart, speed = on_child - on_parent, child_speed - parent_speed
        # What is apart is parallel to the axis, so that turning with the parent does not change the speed along it.
        return np.sum(axis * apart, axis=1), np.sum(axis * speed, axis=1)

    def from_home(self, joint: SpatialJoint) -> tuple[Vector, Vector]:
        """Angle (n,) rad and axis (n, 3) of the rotation from the parent's frame of a joint to the child's."""
        parent = self.rotation(joint.parent) @ joint.parent_turn
        child = self.rotation(joint.child) @ joint.child_turn
        axis = 0.5 * np.cross(parent, child, axis=1).sum(axis=2)
        sine = np.linalg.norm(axis, axis=1, keepdims=True)
        angle = np.arctan2(sine[:, 0], 0.5 * (np.sum(parent * child, axis=(1, 2)) - 1.0))
        return angle, np.divide(axis, sine, out=np.zeros_like(axis), where=sine > 0.0)

    def elastic(self) -> list[tuple[Vector, Vector]]:
        """As of `Kinematics`."""
        return [beam.energy_and_loss() for beam in self.beams.values()]

    def strains(self) -> dict[str, Strains]:
        """As of `Kinematics`."""
        return {name: one.strains() for name, one in self.beams.items()}

    def element_errors(self) -> dict[str, tuple[float, int]]:
        """As of `Kinematics`."""
        return {name: (one.element_error(), one.beam.elements) for name, one in self.beams.items()}

    def bends(self) -> dict[str, list[Vector]]:
        """As of `Kinematics`, across the axis of the root along its y and z."""
        return {name: list(one.deflection[0][:, 1:].T) for name, one in self.beams.items()}

    def bend(self, name: str) -> Track:
        """Distance (m) of the tip of a link that bends from the axis of its root."""
        return self.beams[name].bend()

    def damped_balls(self) -> list[Vector]:
        """As of `Kinematics`."""
        works = []
        for joint in self.system.scene.joints:
            if joint.is_sprung and joint.law.damping > 0.0:
                spin = self.spin(joint.child) - self.spin(joint.parent)
                works.append(work(self.engine.time, -joint.law.damping * spin, spin))
        return works

    @cached_property
    def lever(self) -> Vector:
        """Factors (m,) from the rates of the trajectory to speeds of points (m/s)."""
        radii = [self.system.scene.radius(handle.body) for handle in self.system.rigid.values()]
        return np.array([factor for r in radii for factor in (1.0, 1.0, 1.0, r, r, r)])

    def lifted(self) -> Vector:
        """First moment of the masses (n,) kg m about the height of the origin."""
        return np.asarray(self.scene.mass * self.common_center[0][:, 2])

    def depths(self) -> dict[str, list[Track]]:
        """Depths (m) of the points of each body in sand that are deepest at some instant, by what is reported."""
        bed = self.scene.bed
        if bed is None or not self.scene.media:
            return {}
        found: dict[str, list[Track]] = {}
        for name, handle in self.system.rigid.items():
            for part in handle.body.parts:
                if part.in_sand:
                    found.setdefault(link_of(name), []).extend(self._depths(name, part))
        return found

    def _depths(self, name: str, part: Part) -> list[Track]:
        bed: Any = self.scene.bed
        R, at = self.rotation(name), self._places[name][:3]
        place, spin = self.engine.q[:, at], self.spin(name)
        if bed.heights is None:  # below a plane only the difference in depth to the origin of the body counts
            deeper = np.einsum("ni,ki->kn", np.array([*bed.rise, -1.0]) @ R, part.points)
            depth = deeper + bed.height(place[:, 0], place[:, 1]) - place[:, 2] + part.reach(*bed.rise)
        else:
            x, y, z = np.moveaxis(place + np.einsum("nij,kj->kni", R, part.points), 2, 0)
            depth = bed.height(x, y) - z + part.reach(*bed.slope(x, y))
        tracks = []
        for k in np.unique(depth.argmax(axis=0)):
            turned = R @ part.points[k]
            vx, vy, vz = (self.engine.v[:, at] + np.cross(spin, turned)).T
            rise_x, rise_y = bed.slope(*(place + turned)[:, :2].T)
            tracks.append(Track(depth[k], rise_x * vx + rise_y * vy - vz))
        return tracks

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """The mechanism in side view, x and z, at an instant (index)."""
        drawn = []
        for name, handle in self.system.rigid.items():
            R, at = self.rotation(name)[instant], self.engine.q[instant, self._places[name][:3]]
            for part in handle.body.parts:
                seen = (part.points @ R.T + at)[:, [0, 2]]
                bar = part.meets == ("bar",)
                across = part.shape.diameter if bar else 2.0 * part.drop
                drawn.append(Outline(part.name, seen if bar or len(seen) <= 2 else silhouette(seen), across))
        return tuple(drawn)


def angular(e: Vector, d: Vector) -> Vector:
    """G(e) d (n, 3): the angular velocity of Euler parameters e (n, 4) with the rates d."""
    found: Vector = 2.0 * (e[:, :1] * d[:, 1:] - d[:, :1] * e[:, 1:] + np.cross(e[:, 1:], d[:, 1:]))
    return found
