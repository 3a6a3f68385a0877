"""Kinematics: positions, angles and rates of bodies and joints, for all accepted steps at once."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from granular_contact.mechanics.beam_energy import curvatures, elastic_energy_and_loss
from granular_contact.mechanics.constraints import Constraints
from granular_contact.mechanics.mass_and_gravity import center_shares
from granular_contact.mechanics.strains import Strains
from granular_contact.mechanics.system import System, Trajectory
from granular_contact.results import Outline
from granular_contact.results.energy import accumulate
from granular_contact.results.interpolation import Track
from granular_contact.sand.work import work_correction
from granular_contact.scene.types import Joint, Vector


class Kinematics:
    """Motion of a system along a trajectory; (n,) and (n, 2) arrays over its instants, world frame.

    engine: the trajectory in the engine's coordinates; in the plane the same as `trajectory`.
    """

    def __init__(self, system: System, trajectory: Trajectory) -> None:
        self.system = system
        self.scene = system.scene
        self.trajectory = self.engine = trajectory
        coordinates = system.coordinates
        self._coordinates: dict[str, tuple[Vector, Vector]] = {}
        self._rigid = {name: coordinates.places(h.node) for name, h in system.rigid.items()}
        self._links = {name: [coordinates.places(n) for n in h.nodes] for name, h in system.links.items()}

    @property
    def accelerations(self) -> Vector:
        """Accelerations (n, m) of the engine's coordinates; kept only where signals prescribe motions."""
        assert self.trajectory.a is not None
        return self.trajectory.a

    @cached_property
    def constraints(self) -> Constraints:
        """Constraints of the joints on the accelerations."""
        return Constraints(self)

    def reported(self, body: str) -> str:
        """Name under which a body is reported."""
        return body

    def position(self, name: str, point: Vector) -> tuple[Vector, Vector]:
        """Position and velocity (n, 2) of a body-fixed point; on a flexible link of the nearer of root and tip."""
        q, v = self.trajectory.q, self.trajectory.v
        if name in self._links:
            node = self.system.places(name, point)
            return q[:, node[:2]], v[:, node[:2]]
        position, velocity = self.positions(name, np.asarray(point)[None])
        return position[0], velocity[0]

    def positions(self, name: str, points: Vector) -> tuple[Vector, Vector]:
        """Positions and velocities (k, n, 2) of points (k, 2) of a rigid body."""
        (x, y, phi), (px, py) = self._rigid[name], points.T[:, :, None]
        q, v = self.trajectory.q, self.trajectory.v
        c, s = np.cos(q[:, phi]), np.sin(q[:, phi])
        arm = np.stack([c * px - s * py, s * px + c * py], axis=2)
        relative = v[:, [phi]] * np.stack([-arm[..., 1], arm[..., 0]], axis=2)
        return q[:, [x, y]] + arm, v[:, [x, y]] + relative

    def angle(self, name: str | None, point: Vector) -> tuple[Vector, Vector]:
        """Angle (rad) and rate (rad/s) of a body at a joint's point, counter-clockwise; zeros for the ground."""
        if name is None:
            return np.zeros_like(self.trajectory.time), np.zeros_like(self.trajectory.time)
        q, v = self.trajectory.q, self.trajectory.v
        if name in self._rigid:
            phi = self._rigid[name][2]
            return q[:, phi], v[:, phi]
        node = self.system.places(name, point)
        tx, ty = q[:, node[2]], q[:, node[3]]
        start = self.scene.body(name).motion.angle
        angle = np.unwrap(np.arctan2(ty, tx))
        angle += 2.0 * np.pi * np.round((start - angle[0]) / (2.0 * np.pi))  # whole turns, which a slope does not show
        return angle, (tx * v[:, node[3]] - ty * v[:, node[2]]) / (tx**2 + ty**2)

    def spin(self, name: str) -> Vector:
        """Angular velocity (n,) rad/s of a rigid body, counter-clockwise."""
        return self.angle(name, np.zeros(2))[1]

    def mean_spin(self, name: str) -> Vector:
        """Angular velocity (n,) rad/s of a body; of a flexible link angular momentum over inertia about its centre."""
        if name in self.system.rigid:
            return self.spin(name)
        center, places = self.center(name)[0], np.array(self.nodes(name)).ravel()
        q, v = self.trajectory.q[:, places], self.trajectory.v[:, places]
        turn = np.empty_like(q)
        turn[:, 0::4], turn[:, 1::4] = center[:, [1]] - q[:, 1::4], q[:, 0::4] - center[:, [0]]
        turn[:, 2::4], turn[:, 3::4] = -q[:, 3::4], q[:, 2::4]
        momenta = turn @ self.trajectory.mass[places][:, places]
        spin: Vector = np.sum(momenta * v, axis=1) / np.sum(momenta * turn, axis=1)
        return spin

    def elastic(self) -> list[tuple[Vector, Vector]]:
        """Strain energy (n,) J of each flexible link, and the power (n,) W that its damping dissipates."""
        q, v, energies = self.trajectory.q, self.trajectory.v, []
        for name, handle in self.system.links.items():
            nodes = np.array(self.nodes(name))
            energies.append(elastic_energy_and_loss(q[:, nodes], v[:, nodes], handle.link))
        return energies

    def strains(self) -> dict[str, Strains]:
        """Strains and stresses of each flexible link."""
        strains = {}
        for name, handle in self.system.links.items():
            link, q = handle.link, self.trajectory.q[:, np.array(self.nodes(name))]
            length = link.length / link.elements
            first, last = curvatures(q, length)
            stretch = np.abs(np.hypot(q[..., 2], q[..., 3]) - 1.0)
            ends = [(first, stretch[:, :-1], 0.0), (last, stretch[:, 1:], length)]  # of elements
            strain = np.hstack([axial + 0.5 * link.thickness * np.abs(kappa) for kappa, axial, _ in ends])
            places = np.concatenate([length * np.arange(link.elements) + x for *_, x in ends])
            strains[name] = Strains(places, strain, link.modulus * strain, link.yield_stress)
        return strains

    def element_errors(self) -> dict[str, tuple[float, int]]:
        """By link made of rigid elements: discretisation error (m) of its tip, and number of elements."""
        return {}

    def mode_errors(self, doubtful: float) -> dict[str, float]:  # noqa: ARG002
        """By link in a few modes: error (m) of its deflection; in the plane there are none. See `space.mode_error`."""
        return {}

    def bends(self) -> dict[str, list[Vector]]:
        """Deflections (n,) m of the tip of each flexible link: one in the plane, two in space."""
        return {name: [self.bend(name).values] for name in self.system.links}

    def damped_balls(self) -> list[Vector]:
        """Work (n,) J of the dampers of ball joints, which have no joint coordinate; in the plane there are none."""
        return []

    def coordinate(self, joint: Any) -> tuple[Vector, Vector]:
        """Coordinate (n,) of a hinge or ball joint (rad) or slider (m), and its rate. It is computed once."""
        if joint.name not in self._coordinates:
            self._coordinates[joint.name] = self._coordinate(joint)
        return self._coordinates[joint.name]

    def _coordinate(self, joint: Joint) -> tuple[Vector, Vector]:
        """Coordinate (n,) of a hinge (rad, clockwise) or slider (m), and its rate."""
        parent, parent_rate = self.angle(joint.parent, joint.parent_point)
        if joint.kind == "hinge":
            child, child_rate = self.angle(joint.child, joint.child_point)
            return parent - child + joint.offset, parent_rate - child_rate
        assert joint.axis is not None
        c, s = np.cos(parent), np.sin(parent)
        axis = np.column_stack([c * joint.axis[0] - s * joint.axis[1], s * joint.axis[0] + c * joint.axis[1]])
        on_child, child_speed = self.position(joint.child, joint.child_point)
        on_parent, parent_speed = on_child * 0.0 + joint.parent_point, 0.0 * on_child
        if joint.parent is not None:
            on_parent, parent_speed = self.position(joint.parent, joint.parent_point)
        offset, speed = on_child - on_parent, child_speed - parent_speed
        # The offset is parallel to the axis, so the rotation of the axis adds nothing to the rate.
        return np.sum(axis * offset, axis=1), np.sum(axis * speed, axis=1)

    def center(self, name: str) -> tuple[Vector, Vector]:
        """Centre of mass (n, 2) m of a body, and its velocity."""
        t = self.trajectory
        if name in self._rigid:
            return self.position(name, np.zeros(2))
        shares = center_shares(t.mass, np.array(self._links[name]))
        return t.q @ shares.T, t.v @ shares.T

    @cached_property
    def common_center(self) -> tuple[Vector, Vector]:
        """Centre of mass (n, 2) m of all bodies together, and its velocity."""
        bodies = self.scene.bodies
        shares = [body.mass / self.scene.mass for body in bodies]
        centers = [self.center(body.name) for body in bodies]
        position: Vector = np.sum([share * r for share, (r, _) in zip(shares, centers, strict=True)], axis=0)
        velocity: Vector = np.sum([share * v for share, (_, v) in zip(shares, centers, strict=True)], axis=0)
        return position, velocity

    @cached_property
    def lever(self) -> Vector:
        """Factors (m,) from the rates of the trajectory to speeds of points (m/s)."""
        return self.system.levers

    @cached_property
    def speeds(self) -> Vector:
        """Greatest speed (n,) m/s of any point."""
        return np.asarray(np.abs(self.trajectory.v * self.lever).max(axis=1))

    @cached_property
    def work_beyond(self) -> Vector:
        """Correction (n,) J of the work of media and floor in the history, see `sand.work.work_correction`."""
        load = self.trajectory.load
        if load is None:
            return np.zeros(1)
        return work_correction(load, {name: (*self.center(name), self.mean_spin(name)) for name in load.body_names})

    def lifted(self) -> Vector:
        """First moment of mass (n,) kg m: mass times height above the origin, summed up."""
        moment: Vector = self.trajectory.q @ (self.trajectory.mass @ self.upward)
        return moment

    @cached_property
    def path_length(self) -> float:
        """Length (m) of the path of the fastest point."""
        return float(accumulate(self.trajectory.time, self.speeds)[-1])

    @cached_property
    def mean_rate(self) -> tuple[Vector, Vector]:
        """Angular momentum over moment of inertia about the pivot (n,) rad/s, clockwise, and that inertia (n,) kg m2.

        Free vibration of a hinged mechanism has no angular momentum about the hinge. So this is the rate of the motion
        as a whole, without vibration.
        """
        turn = self._turning
        momenta = turn @ self.trajectory.mass
        momentum, inertia = np.sum(momenta * self.trajectory.v, axis=1), np.sum(momenta * turn, axis=1)
        return -momentum / inertia, inertia

    def weight_moment(self) -> Vector:
        """Moment (n,) N m of gravity about the pivot, counter-clockwise."""
        moment: Vector = -self.scene.gravity * (self._turning @ (self.trajectory.mass @ self.upward))
        return moment

    @cached_property
    def upward(self) -> Vector:
        """Rates (m,) of all coordinates in a rigid translation upward at 1 m/s."""
        up = np.zeros(self.trajectory.q.shape[1])
        up[[node[1] for node in self._rigid.values()]] = 1.0
        up[[node[1] for nodes in self._links.values() for node in nodes]] = 1.0
        return up

    @cached_property
    def _turning(self) -> Vector:
        """Rates (n, m) of all coordinates in a rigid rotation about the pivot at 1 rad/s, counter-clockwise."""
        pivot = np.zeros(2) if self.scene.pivot is None else self.scene.pivot.parent_point
        q = self.trajectory.q
        turn = np.zeros_like(q)
        for x, y, phi in self._rigid.values():
            turn[:, x], turn[:, y], turn[:, phi] = pivot[1] - q[:, y], q[:, x] - pivot[0], 1.0
        for nodes in self._links.values():
            for x, y, dx, dy in nodes:
                turn[:, x], turn[:, y] = pivot[1] - q[:, y], q[:, x] - pivot[0]
                turn[:, dx], turn[:, dy] = -q[:, dy], q[:, dx]
        return turn

    def nodes(self, name: str) -> list[list[int]]:
        """Indices (4,) of the coordinates r_x, r_y, r'_x, r'_y of each node of a flexible link."""
        return self._links[name]

    def bend(self, name: str) -> Track:
        """Deflection (m) of a flexible link's tip from the tangent at its root, positive clockwise, and its rate."""
        nodes = self._links[name]
        q, v = self.trajectory.q, self.trajectory.v
        (ax, ay), (bx, by) = q[:, nodes[0][2:]].T, v[:, nodes[0][2:]].T
        (cx, cy), (dx, dy) = (x[:, nodes[-1][:2]].T - x[:, nodes[0][:2]].T for x in (q, v))
        size = np.hypot(ax, ay)
        across = (cx * ay - cy * ax) / size
        rate = (dx * ay + cx * by - dy * ax - cy * bx) / size - across * (ax * bx + ay * by) / size**2
        return Track(across, rate)

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """Outlines of the parts of the mechanism at an instant (index)."""
        outlines: list[Outline] = []
        q = self.trajectory.q[instant]
        for name, handle in self.system.rigid.items():
            x, y, angle = q[self._rigid[name]]
            c, s = np.cos(angle), np.sin(angle)
            turn = np.array([[c, s], [-s, c]])
            shapes = handle.body.shapes
            outlines += [
                Outline(shape.part, np.asarray(shape.points) @ turn + (x, y), shape.thickness) for shape in shapes
            ]
        for name, nodes in self._links.items():
            line = q[np.array(nodes)[:, :2]]
            outlines.append(Outline(name, line, self.system.links[name].link.thickness))
        return tuple(outlines)
