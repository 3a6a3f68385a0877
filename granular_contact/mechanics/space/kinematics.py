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
        coordinates = system.coordinates
        self._places = {name: np.array(coordinates.places(h.node)) for name, h in system.rigid.items()}
        masses: list[Vector] = []
        rates = [np.zeros((len(trajectory.time), 0))]
        for name, handle in system.rigid.items():
            spin = np.einsum("nji,nj->ni", self.rotation(name), self.spin(name))
            rates += [trajectory.v[:, self._places[name][:3]], spin]
            masses += [np.eye(3) * handle.body.mass, handle.body.inertia]
        mass = np.zeros((3 * len(masses),) * 2)
        for i, block in enumerate(masses):
            mass[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = block
        self.trajectory = replace(trajectory, v=np.concatenate(rates, axis=1), mass=mass)

    @property
    def accelerations(self) -> Vector:
        """Derivatives (n, m) of the trajectory's rates; known only where signals prescribe motions."""
        a = self.engine.a
        assert a is not None
        parts = []
        for name, places in self._places.items():
            angular_acceleration = angular(self.engine.q[:, places[3:]], a[:, places[3:]])  # without G' e', which is 0
            parts += [a[:, places[:3]], np.einsum("nji,nj->ni", self.rotation(name), angular_acceleration)]
        return np.concatenate(parts, axis=1)

    @cached_property
    def constraints(self) -> SpatialConstraints:  # type: ignore[override]
        """Constraints of the joints on the accelerations."""
        return SpatialConstraints(self)

    @cached_property
    def _rotations(self) -> dict[str, Vector]:
        """Rotation matrices (n, 3, 3) of rigid bodies."""
        return {name: rotations.of_quaternion(self.engine.q[:, places[3:]]) for name, places in self._places.items()}

    @cached_property
    def _spins(self) -> dict[str, Vector]:
        """Angular velocities (n, 3) rad/s of rigid bodies."""
        q, v = self.engine.q, self.engine.v
        return {name: angular(q[:, places[3:]], v[:, places[3:]]) for name, places in self._places.items()}

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
        return self._rotations[name]

    def quaternion(self, name: str) -> Vector:
        """Orientation (n, 4) of a body as a unit quaternion."""
        e = self.engine.q[:, self._places[name][3:]]
        return np.asarray(e / np.linalg.norm(e, axis=1, keepdims=True))

    def spin(self, name: str | None) -> Vector:
        """Angular velocity w = G(e) e' (n, 3) rad/s of a body; of a flexible link at its root; None is the ground."""
        if name in self.beams:
            name = self.beams[name].beam.root[0]
        if name is None:
            return np.zeros((len(self.engine.time), 3))
        return self._spins[name]

    def position(self, name: str | None, point: Vector) -> tuple[Vector, Vector]:
        """Position and velocity (n, 3) of a body-fixed point; None is the ground."""
        if name is None:
            fixed = np.broadcast_to(point, (len(self.engine.time), 3))
            return fixed, 0.0 * fixed
        places = self._places[name][:3]
        arm = self.rotation(name) @ point
        return self.engine.q[:, places] + arm, self.engine.v[:, places] + np.cross(self.spin(name), arm)

    def center(self, name: str) -> tuple[Vector, Vector]:
        """Centre of mass (n, 3) m of a body, and its velocity."""
        if name in self.beams:
            return self.beams[name].center
        places = self._places[name][:3]
        return self.engine.q[:, places], self.engine.v[:, places]

    def coordinate(self, joint: SpatialJoint) -> tuple[Vector, Vector]:  # type: ignore[override]
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
        axis = 0.5 * np.cross(parent, child, axis=1).sum(axis=2)
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
        R, places = self.rotation(name), self._places[name][:3]
        center, spin = self.engine.q[:, places], self.spin(name)
        if bed.heights is None:  # below a plane the depth is that of the centre plus a term linear in the point
            deeper = np.einsum("ni,ki->kn", np.array([*bed.rise, -1.0]) @ R, part.points)
            depth = deeper + bed.height(center[:, 0], center[:, 1]) - center[:, 2] + part.reach(*bed.rise)
        else:
            x, y, z = np.moveaxis(center + np.einsum("nij,kj->kni", R, part.points), 2, 0)
            height, *slopes = bed.tangent(x, y)
            depth = height - z + part.reach(*slopes)
        tracks = []
        for k in np.unique(depth.argmax(axis=0)):
            arm = R @ part.points[k]
            vx, vy, vz = (self.engine.v[:, places] + np.cross(spin, arm)).T
            rise_x, rise_y = bed.slope(*(center + arm)[:, :2].T)
            tracks.append(Track(depth[k], rise_x * vx + rise_y * vy - vz))
        return tracks

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """Outlines of the parts of the mechanism in side view, x and z, at an instant (index)."""
        outlines = []
        for name, handle in self.system.rigid.items():
            R, center = self.rotation(name)[instant], self.engine.q[instant, self._places[name][:3]]
            for part in handle.body.parts:
                points = (part.points @ R.T + center)[:, [0, 2]]
                bar = part.meets == ("bar",)
                thickness = part.shape.diameter if bar else 2.0 * part.drop
                line = points if bar or len(points) <= 2 else silhouette(points)
                outlines.append(Outline(part.name, line, thickness))
        return tuple(outlines)


def angular(e: Vector, d: Vector) -> Vector:
    """Angular velocity G(e) d (n, 3) of Euler parameters e (n, 4) with the rates d (n, 4)."""
    w: Vector = 2.0 * (e[:, :1] * d[:, 1:] - d[:, :1] * e[:, 1:] + np.cross(e[:, 1:], d[:, 1:]))
    return w
