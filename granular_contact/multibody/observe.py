"""Trajectory -> time series: what a run is asked for, computed from the coordinates of all accepted steps at once."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from granular_contact import series
from granular_contact.energy import accumulate, damping_power, elastic_energy, strain
from granular_contact.limits import Reach
from granular_contact.media.kinds import term_names
from granular_contact.multibody import observe_mechanism as mechanism
from granular_contact.multibody.medium_work import medium_works
from granular_contact.multibody.recorder import levers
from granular_contact.multibody.solve import Trajectory
from granular_contact.multibody.system import System
from granular_contact.results import Column, Outline
from granular_contact.scene.types import Connection, Vector


class Observer:
    """Reads positions, angles and energies out of a trajectory; (n,) and (n, 2) arrays over its instants."""

    def __init__(self, system: System, trajectory: Trajectory) -> None:
        self.system = system
        self.scene = system.scene
        self.trajectory = trajectory
        data = system.mbs.systemData
        self._rigid = {name: data.GetNodeLTGODE2(h.node) for name, h in system.rigid.items()}
        self._links = {name: [data.GetNodeLTGODE2(n) for n in h.nodes] for name, h in system.links.items()}

    def columns(self) -> tuple[tuple[Column, ...], Vector]:
        """All columns, with the table (instants, columns)."""
        everything: series.Series = {"time_s": ("time since the start", self.trajectory.time)}
        everything |= mechanism.joint_columns(self) | mechanism.drive_columns(self) | mechanism.body_columns(self)
        with np.errstate(over="ignore", invalid="ignore"):  # of a run that failed by running away
            return series.tabulate(everything | self._shape() | self._load() | self._energies())

    # ---- motion ----

    def position(self, name: str, point: Vector) -> tuple[Vector, Vector]:
        """Position and velocity (n, 2) of a body-frame point; on a flexible link its root or tip."""
        q, v = self.trajectory.q, self.trajectory.v
        if name in self._links:
            node = self._links[name][-1 if point[0] > 0.5 * self.system.links[name].link.length else 0]
            return q[:, node[:2]], v[:, node[:2]]
        x, y, phi = self._rigid[name]
        c, s = np.cos(q[:, phi]), np.sin(q[:, phi])
        arm = np.column_stack([c * point[0] - s * point[1], s * point[0] + c * point[1]])
        swing = v[:, [phi]] * np.column_stack([-arm[:, 1], arm[:, 0]])
        return q[:, [x, y]] + arm, v[:, [x, y]] + swing

    def angle(self, name: str | None, point: Vector) -> tuple[Vector, Vector]:
        """Angle (rad) and rate (rad/s) of a body at a joint's point, counter-clockwise; zeros for the ground."""
        if name is None:
            return np.zeros_like(self.trajectory.time), np.zeros_like(self.trajectory.time)
        q, v = self.trajectory.q, self.trajectory.v
        if name in self._rigid:
            phi = self._rigid[name][2]
            return q[:, phi], v[:, phi]
        node = self._links[name][-1 if point[0] > 0.5 * self.system.links[name].link.length else 0]
        tx, ty = q[:, node[2]], q[:, node[3]]
        start = self.scene.body(name).motion.angle
        turned = np.unwrap(np.arctan2(ty, tx))
        turned += 2.0 * np.pi * np.round((start - turned[0]) / (2.0 * np.pi))  # the turn that the slope can't tell
        return turned, (tx * v[:, node[3]] - ty * v[:, node[2]]) / (tx**2 + ty**2)

    def coordinate(self, joint: Connection) -> tuple[Vector, Vector]:
        """Coordinate (n,) rad clockwise, or m, of a hinge or slider, and its rate."""
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
        way, speed = on_child - on_parent, child_speed - parent_speed
        # The axis turns with the parent.
        along = np.sum(axis * speed, axis=1) + parent_rate * (axis[:, 0] * way[:, 1] - axis[:, 1] * way[:, 0])
        return np.sum(axis * way, axis=1), along

    def center(self, name: str) -> tuple[Vector, Vector]:
        """Centre of mass (n, 2) m of a body, and its velocity."""
        t = self.trajectory
        if name in self._rigid:
            return self.position(name, np.zeros(2))
        nodes = np.array(self._links[name])
        centers = []
        for axis in (0, 1):
            along = np.zeros(t.q.shape[1])
            along[nodes[:, axis]] = 1.0
            # Row of the mass matrix that gives the link's momentum: its nodes are its own.
            shares = t.mass @ along / (along @ t.mass @ along)
            centers.append((t.q @ shares, t.v @ shares))
        (x, vx), (y, vy) = centers
        return np.column_stack([x, y]), np.column_stack([vx, vy])

    @cached_property
    def drive_forces(self) -> dict[str, tuple[Vector, Vector]]:
        """Torque or force of every drive (n,), and its power (n,) W, by joint."""
        return {drive.joint: mechanism.drive_force(self, drive) for drive in self.scene.drives}

    @cached_property
    def speeds(self) -> Vector:
        """Greatest speed (n,) m/s of any point."""
        return np.asarray(np.abs(self.trajectory.v * levers(self.system)).max(axis=1))

    @property
    def way(self) -> float:
        """Way (m) of whatever is fastest."""
        return float(np.sum(np.diff(self.trajectory.time) * self.speeds[1:]))

    def mean_rate(self) -> tuple[Vector, Vector]:
        """Angular momentum over moment of inertia about the pivot (rad/s, clockwise), and that inertia (kg m2).

        Free vibration of a hinged mechanism has no angular momentum about its hinge, so this is the rate of the motion
        as a whole, without the trembling of any one part.
        """
        turn = self._turning()
        momenta = turn @ self.trajectory.mass
        momentum, inertia = np.sum(momenta * self.trajectory.v, axis=1), np.sum(momenta * turn, axis=1)
        return -momentum / inertia, inertia

    def weight_moment(self) -> Vector:
        """Moment (n,) N m of gravity about the pivot, counter-clockwise."""
        moment: Vector = -self.scene.gravity * (self._turning() @ (self.trajectory.mass @ self._up()))
        return moment

    def _up(self) -> Vector:
        """Rates (m,) of all coordinates while everything moves upward at 1 m/s."""
        up = np.zeros(self.trajectory.q.shape[1])
        up[[node[1] for node in self._rigid.values()]] = 1.0
        up[[node[1] for nodes in self._links.values() for node in nodes]] = 1.0
        return up

    def _turning(self) -> Vector:
        """Rates (n, m) of all coordinates while everything turns about the pivot at 1 rad/s, counter-clockwise."""
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

    def _shape(self) -> series.Series:
        tip, _ = self.position(*self.scene.tip)
        deflection = self.deflection() if self.scene.links else None
        depth = None if self.scene.surface is None else self.depth()
        rate = None if self.scene.pivot is None else self.mean_rate()[0]
        return series.shape(rate, tip, deflection, depth)

    def nodes(self, name: str) -> list[Vector]:
        """Places (4,) of the coordinates of a flexible link's nodes: r_x, r_y, r'_x, r'_y."""
        return self._links[name]

    def deflection(self) -> Vector:
        """Deflection (n,) m of the last flexible link, see `bend`."""
        return self.bend(list(self._links)[-1])

    def bend(self, name: str) -> Vector:
        """Deflection (n,) m of a flexible link's tip from the tangent at its root, clockwise positive."""
        nodes = self._links[name]
        q = self.trajectory.q
        axis = q[:, nodes[0][2:]] / np.linalg.norm(q[:, nodes[0][2:]], axis=1, keepdims=True)
        chord = q[:, nodes[-1][:2]] - q[:, nodes[0][:2]]
        deflection: Vector = chord[:, 0] * axis[:, 1] - chord[:, 1] * axis[:, 0]
        return deflection

    def depth(self) -> Vector | None:
        """Depth (n,) m of the deepest shape or node, negative above the surface; None if nothing may get in.

        A surface with a peak meets a body between its corners too, at the stations where the bed looks.
        """
        assert self.scene.bed is not None
        height = self.scene.bed.height
        depths = [self.trajectory.q[:, node[:2]] for nodes in self._links.values() for node in nodes]
        depths = [height(place[:, 0]) - place[:, 1] for place in depths]
        for name, handle in self.system.rigid.items():
            for shape in (shape for shape in handle.body.shapes if shape.in_sand):
                places = [self.position(name, point)[0] for point in shape.points]
                depths += [height(place[:, 0]) - place[:, 1] + shape.drop for place in places]
        if self.trajectory.load is not None:
            depths.append(self.trajectory.load.depth)
        return np.max(depths, axis=0) if depths else None

    def reach(self) -> Reach | None:
        """Extremes of what was immersed; None where nothing could meet the medium."""
        load, bed = self.trajectory.load, self.system.bed
        if load is None:
            return None
        return Reach(
            speed=float(load.speed.max()),
            depth=float(load.depth.max()),
            lowest=float(load.lowest.min()),
            left=float(load.left.min()),
            right=float(load.right.max()),
            sizes=tuple(sorted({width for group in bed.groups for width in group.widths()})),
        )

    # ---- forces and energies ----

    @property
    def terms(self) -> tuple[str, ...]:
        """Names of the terms of the granular force; none in vacuum."""
        if not self.scene.media:
            return ()
        load = self.trajectory.load
        return term_names(self.scene.media) if load is None else load.term_names

    def _load(self) -> series.Series:
        if not self.scene.media:
            return {}
        load = self.trajectory.load
        terms = np.zeros((len(self.trajectory.time), len(self.terms), 3)) if load is None else load.terms
        pivot = np.zeros(2) if self.scene.pivot is None else self.scene.pivot.parent_point
        return series.forces(self.terms, terms, pivot)

    def _energies(self) -> series.Series:
        t = self.trajectory
        kinetic = 0.5 * np.sum((t.v @ t.mass) * t.v, axis=1)
        gravity = self.scene.gravity * (t.q @ (t.mass @ self._up()))
        elastic, damping = np.zeros_like(kinetic), np.zeros_like(kinetic)
        for name, nodes in self._links.items():
            link = self.system.links[name].link
            s = strain(t.q[:, nodes], t.v[:, nodes], link.length / link.elements)
            elastic += elastic_energy(s, link.axial_stiffness, link.bending_stiffness)
            damping -= accumulate(t.time, damping_power(s, link.axial_damping, link.bending_damping))
        work = np.zeros_like(kinetic) if t.load is None else medium_works(self)[0]
        shown = elastic if self._links else None
        return series.energies(kinetic, gravity - gravity[0], shown, work, damping, mechanism.joint_energies(self))

    # ---- pictures ----

    def outlines(self, instant: int) -> tuple[Outline, ...]:
        """The mechanism as drawn at an instant (index)."""
        outlines = []
        for name, handle in self.system.rigid.items():
            for shape in handle.body.shapes:
                points = np.array([self.position(name, p)[0][instant] for p in shape.points])
                outlines.append(Outline(shape.part, points, shape.thickness))
        for name, nodes in self._links.items():
            line = self.trajectory.q[instant][np.array(nodes)[:, :2]]
            outlines.append(Outline(name, line, self.system.links[name].link.thickness))
        return tuple(outlines)
