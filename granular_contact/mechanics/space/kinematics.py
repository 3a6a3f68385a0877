"""Kinematics in space: positions, orientations and rates of bodies and joints, for all accepted steps at once."""

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
    """Motion of a system along a trajectory; (n,) and (n, 3) arrays over its instants, world frame.

    engine: the trajectory in the engine's coordinates. trajectory: the same with six rates for each body, in the order
    of bodies: velocity of the centre of mass in the world frame, and angular velocity in the body frame. The mass
    matrix of these rates is constant.
    """

    system: SpatialSystem
    scene: SpatialScene

    def __init__(self, system: SpatialSystem, trajectory: Trajectory) -> None:
        self.system, self.scene, self.engine = system, system.scene, trajectory
        places = [system.coordinates.places(handle.node) for handle in system.rigid.values()]
        self._places = np.array(places, np.int64).reshape(-1, 7)
        self._number = {name: i for i, name in enumerate(system.rigid)}
        self._coordinates = {}
        self._poses, rates = self._by_body(trajectory.q), self._by_body(trajectory.v)
        self._velocities, self._spins = rates[..., :3], angular(self._poses[..., 3:], rates[..., 3:])
        self._rotations = rotations.of_quaternion(self._poses[..., 3:])
        mass, i = np.zeros((2 * len(places), 3) * 2), 2 * np.arange(len(places))
        for number, handle in zip(i, system.rigid.values(), strict=True):
            mass[number, :, number], mass[number + 1, :, number + 1] = np.eye(3) * handle.body.mass, handle.body.inertia
        v = self._side_by_side(self._velocities, self._spins)
        self.trajectory = replace(trajectory, v=v, mass=mass.reshape(v.shape[1], v.shape[1]))

    def _by_body(self, values: Vector) -> Vector:
        """Values (b, n, 7) of the coordinates of bodies among those (n, m) of the engine."""
        return values[:, self._places].transpose(1, 0, 2)

    def _side_by_side(self, linear: Vector, rotary: Vector) -> Vector:
        """Linear and rotary rates (b, n, 3) of bodies, world frame, in the order and in the frames of `trajectory`."""
        in_body = (rotary[:, :, None] @ self._rotations)[:, :, 0]
        both = np.concatenate([linear, in_body], axis=2).transpose(1, 0, 2)
        return both.reshape(len(both), 6 * len(linear))

    @property
    def accelerations(self) -> Vector:
        """Derivatives (n, m) of the trajectory's rates; known only where signals prescribe motions."""
        a = self.engine.a
        assert a is not None
        of_bodies = self._by_body(a)  # the angular acceleration is without G' e', which is 0
        return self._side_by_side(of_bodies[..., :3], angular(self._poses[..., 3:], of_bodies[..., 3:]))

    @cached_property
    def constraints(self) -> SpatialConstraints:  # type: ignore[override]
        """Constraints of the joints on the accelerations."""
        return SpatialConstraints(self)

    @cached_property
    def beams(self) -> dict[str, BeamMotion]:
        """Motions of flexible links, by name."""
        return {beam.name: BeamMotion(self, beam) for beam in self.scene.beams}

    def reported(self, body: str) -> str:
        """Name under which a body is reported; for an element of a flexible link the name of the link."""
        return link_of(body)

    def rotation(self, name: str | None) -> Vector:
        """Rotation matrices (n, 3, 3) of a body's frame; of a flexible link at its root; None is the ground."""
        if name is None:
            return np.broadcast_to(np.eye(3), (len(self.engine.time), 3, 3))
        if name in self.beams:
            return self.beams[name].frame(self.beams[name].beam.root)
        rotation: Vector = self._rotations[self._number[name]]
        return rotation

    def quaternion(self, name: str) -> Vector:
        """Orientation (n, 4) of a body as a unit quaternion."""
        e = self._poses[self._number[name], :, 3:]
        return np.asarray(e / np.linalg.norm(e, axis=1, keepdims=True))

    def spin(self, name: str | None) -> Vector:
        """Angular velocity w = G(e) e' (n, 3) rad/s of a body; of a flexible link at its root; None is the ground."""
        if name in self.beams:
            name = self.beams[name].beam.root[0]
        if name is None:
            return np.zeros((len(self.engine.time), 3))
        spin: Vector = self._spins[self._number[name]]
        return spin

    def position(self, name: str | None, point: Vector) -> tuple[Vector, Vector]:
        """Position and velocity (n, 3) of a body-fixed point; None is the ground."""
        if name is None:
            fixed = np.broadcast_to(point, (len(self.engine.time), 3))
            return fixed, 0.0 * fixed
        arm, i = self.rotation(name) @ point, self._number[name]
        return self._poses[i, :, :3] + arm, self._velocities[i] + rotations.vector_products(self.spin(name), arm)

    def center(self, name: str) -> tuple[Vector, Vector]:
        """Centre of mass (n, 3) m of a body, and its velocity."""
        if name in self.beams:
            return self.beams[name].center
        i = self._number[name]
        return self._poses[i, :, :3], self._velocities[i]

    def _coordinate(self, joint: SpatialJoint) -> tuple[Vector, Vector]:  # type: ignore[override]
        """Coordinate (n,) of a hinge (rad, right-handed), slider (m) or ball joint (angle, rad), and its rate."""
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
        offset, speed = on_child - on_parent, child_speed - parent_speed
        # The offset is parallel to the axis, so the rotation of the axis adds nothing to the rate.
        return np.sum(axis * offset, axis=1), np.sum(axis * speed, axis=1)

    def from_home(self, joint: SpatialJoint) -> tuple[Vector, Vector]:
        """Angle (n,) rad and axis (n, 3) of the rotation from a joint's frame on the parent to that on the child."""
        parent = self.rotation(joint.parent) @ joint.parent_turn
        child = self.rotation(joint.child) @ joint.child_turn
        columns = (frame.transpose(0, 2, 1) for frame in (parent, child))
        axis = 0.5 * rotations.vector_products(*columns).sum(axis=1)
        sine = np.linalg.norm(axis, axis=1, keepdims=True)
        angle = np.arctan2(sine[:, 0], 0.5 * (np.sum(parent * child, axis=(1, 2)) - 1.0))
        return angle, np.divide(axis, sine, out=np.zeros_like(axis), where=sine > 0.0)

    def elastic(self) -> list[tuple[Vector, Vector]]:
        """See `Kinematics.elastic`."""
        return [beam.energy_and_loss() for beam in self.beams.values()]

    def strains(self) -> dict[str, Strains]:
        """See `Kinematics.strains`."""
        return {name: beam.strains() for name, beam in self.beams.items()}

    def element_errors(self) -> dict[str, tuple[float, int]]:
        """See `Kinematics.element_errors`."""
        return {name: (motion.element_error(), motion.beam.elements) for name, motion in self.beams.items()}

    def mode_errors(self, doubtful: float) -> dict[str, float]:
        """See `Kinematics.mode_errors`."""
        if not self.engine.mode_residuals:
            return {}
        from granular_contact.mechanics.space import mode_error  # here, as the compiler comes with it

        return mode_error.errors(self, doubtful)

    def bends(self) -> dict[str, list[Vector]]:
        """Deflections (n,) m of the tip of each flexible link along y and z of its root."""
        return {name: list(beam.deflection[0][:, 1:].T) for name, beam in self.beams.items()}

    def bend(self, name: str) -> Track:
        """Distance (m) of the tip of a flexible link from the axis of its root, and its rate."""
        return self.beams[name].bend()

    def damped_balls(self) -> list[Vector]:
        """Work (n,) J of the damper of each ball joint."""
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
        """First moment of mass (n,) kg m: mass times height above the origin, summed up."""
        return np.asarray(self.scene.mass * self.common_center[0][:, 2])

    def depths(self) -> dict[str, list[Track]]:
        """Depths (m) of the points that are the deepest of a shape at some instant, by reported body."""
        bed = self.scene.bed
        if bed is None or not self.scene.media:
            return {}
        tracks: dict[str, list[Track]] = {}
        for name, handle in self.system.rigid.items():
            for part in handle.body.parts:
                if part.in_sand:
                    tracks.setdefault(link_of(name), []).extend(self._depths(name, part))
        return tracks

    def _depths(self, name: str, part: Part) -> list[Track]:
        """Depths (m) of the points of a shape that are its deepest at some instant."""
        bed: Any = self.scene.bed
        R, (center, speed) = self.rotation(name), self.center(name)
        if bed.heights is None:  # below a plane the depth is that of the centre plus a term linear in the point
            deeper = part.points @ (np.array([*bed.rise, -1.0]) @ R).T
            depth = deeper + bed.height(center[:, 0], center[:, 1]) - center[:, 2] + part.reach(*bed.rise)
        else:
            x, y, z = np.moveaxis(center + np.einsum("nij,kj->kni", R, part.points), 2, 0)
            height, *slopes = bed.tangent(x, y)
            depth = height - z + part.reach(*slopes)
        deepest = np.unique(depth.argmax(axis=0))
        arms = (R @ part.points[deepest].T).transpose(2, 0, 1)  # (k, n, 3)
        vx, vy, vz = np.moveaxis(speed + rotations.vector_products(self.spin(name), arms), 2, 0)
        rise_x, rise_y = bed.slope(*np.moveaxis((center + arms)[..., :2], 2, 0))
        return list(map(Track, depth[deepest], rise_x * vx + rise_y * vy - vz))

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """Outlines of the parts of the mechanism in side view, x and z, at an instant (index)."""
        outlines = []
        for name, handle in self.system.rigid.items():
            R, center = self.rotation(name)[instant], self.center(name)[0][instant]
            for part in handle.body.parts:
                points = (part.points @ R.T + center)[:, [0, 2]]
                bar = part.meets == ("bar",)
                thickness = part.shape.diameter if bar else 2.0 * part.drop
                line = points if bar or len(points) <= 2 else silhouette(points)
                outlines.append(Outline(part.name, line, thickness))
        return tuple(outlines)


def angular(e: Vector, d: Vector) -> Vector:
    """Angular velocity G(e) d (..., 3) of Euler parameters e (..., 4) with the rates d (..., 4)."""
    products = rotations.vector_products(e[..., 1:], d[..., 1:])
    return np.asarray(2.0 * (e[..., :1] * d[..., 1:] - d[..., :1] * e[..., 1:] + products))
