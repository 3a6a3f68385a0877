"""The scene in space: bodies, joints and bed, as frozen plain data. World: x ahead, y left, z up; SI units.

A body's frame has its origin at the centre of mass of all that is welded together. Angles are right-handed.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Scene, link_of

if TYPE_CHECKING:
    from granular_contact.scene.space.bed import SpatialBed

Vector = NDArray[np.float64]
Meets = Literal["surface", "bar", "ball"]


@dataclass(frozen=True)
class SpatialWheel:
    """Of a shape that is a wheel: a point (3,) m and the direction (3,) of its axle in the body's frame, to the left of
    where it rolls as it turns about it; radius (m) that counts for slip, and of the rim; pitch as of `Wheel`.
    """

    axle: Vector
    axis: Vector
    radius: float
    rim: float
    pitch: float = 0.0


@dataclass(frozen=True)
class Part:
    """A shape of a body as the medium meets it and as it is drawn, in the frame of the merged body.

    name: of the body in the config; shape: of `sand.space.shapes`, at a position (3,) m, turned by (3, 3); in_sand:
    whether the medium acts on it; facet_size (m): greatest edge of its facets, None for the usual; triangles (k, 3, 3)
    m: to be drawn; points (n, 3) m: the outermost of what the medium meets, which reaches `drop` (m) around them;
    notes: what makes its forces uncertain as a surface, in sentences. wheel: of a wheel.
    """

    name: str
    shape: Any
    meets: tuple[Meets, ...]
    position: Vector
    rotation: Vector
    in_sand: bool
    facet_size: float | None
    triangles: Vector
    points: Vector
    drop: float = 0.0
    notes: tuple[str, ...] = ()
    wheel: SpatialWheel | None = None

    def reach(self, rise_x: Vector, rise_y: Vector) -> Vector:
        """How much deeper (m) than its points it is below a surface that rises so much per length."""
        return reach(self.drop, self.meets == ("ball",), rise_x, rise_y)


def reach(drop: Vector | float, as_ball: Any, rise_x: Vector, rise_y: Vector) -> Vector:
    """How much deeper (m) than points is what reaches `drop` (m) around them, below a surface that rises so.

    What is met as a ball counts its depth straight down.
    """
    return np.asarray(drop * np.where(as_ball, 1.0, np.sqrt(1.0 + rise_x**2 + rise_y**2)))


@dataclass(frozen=True)
class SpatialMotion:
    """Initial pose and velocity of a body's frame: position (3,) m, rotation (3, 3), velocity (3,) m/s of its origin,
    rate (3,) rad/s, all in the world frame.
    """

    position: Vector
    rotation: Vector
    velocity: Vector
    rate: Vector

    def world(self, points: Vector) -> Vector:
        """World positions (n, 3) m of points of the body, (n, 3) or (3,)."""
        placed: Vector = self.position + points @ self.rotation.T
        return placed

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (3,) m."""
        placed: Vector = self.rotation.T @ (point - self.position)
        return placed

    def speed_at(self, world: Vector) -> Vector:
        """Velocity (3,) m/s of the body's point at a world position (3,) m."""
        speed: Vector = self.velocity + np.cross(self.rate, world - self.position)
        return speed


@dataclass(frozen=True)
class SpatialRigidBody:
    """Parts that are welded together. Mass kg; inertia (3, 3) kg m2 about the centre of mass, its frame's origin.

    members: names of the bodies of the config, and of elements of links that bend, that it is made of.
    """

    name: str
    mass: float
    inertia: Vector
    parts: tuple[Part, ...]
    motion: SpatialMotion
    members: tuple[str, ...] = ()

    @property
    def is_element(self) -> bool:
        """Whether it is nothing but an element of a link that bends."""
        return all("." in name for name in self.members)

    @property
    def wheel(self) -> SpatialWheel | None:
        """The first of its wheels."""
        return next((part.wheel for part in self.parts if part.wheel is not None), None)

    @property
    def turning_places(self) -> tuple[int, ...]:
        """Which of its coordinates, its position and four Euler parameters, turn it."""
        return 3, 4, 5, 6

    def levers(self, radius: float) -> tuple[float, ...]:
        """Factors from the rates of its coordinates to speeds of points within a radius (m): it turns by w = 2 e'."""
        return (1.0,) * 3 + (2.0 * radius,) * 4

    def mass_matrix(self) -> Vector:
        """Measure of the coordinates' rates, near enough to the mass matrix where inertia plays no part."""
        turning = 4.0 * float(np.linalg.eigvalsh(self.inertia).max())
        return np.diag([self.mass] * 3 + [turning] * 4)

    def weight(self, gravity: float) -> Vector:
        """Generalised forces (7,) of the weight."""
        return np.array([0.0, 0.0, -gravity * self.mass, 0.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Elastic:
    """Moments (N m) about x, y, z of a joint's frame, by the rotation vector theta (rad) from parent to child.

    stiffness (3,) N m/rad, damping (3,) N m s/rad: its energy is sum(stiffness theta^2) / 2, and dampers take
    sum(damping theta'^2). axial: stiffness (N/m) and damping (N s/m) of one that slides along x of the frame as well,
    None of one that does not.
    """

    stiffness: Vector
    damping: Vector
    axial: tuple[float, float] | None = None


@dataclass(frozen=True)
class SpatialBeam:
    """A link that bends, made of rigid elements, see `scene.space.beams`; its frame's x axis is along it. m, N m2.

    section: width along y and thickness along z, of a round one its diameter twice; stiffness (3,): G J, E I_y, E I_z;
    moduli (Pa): E of the bending stiffness, G of the torsion, and of what stretches it; yield_stress (Pa): None where
    it is not looked at; stretches: whether it does;
    pieces: its elements from root to tip, each with its body (None: fixed to the ground), its centre of mass (3,) m in
    that and its mass (kg); joints: between these. root, tip: the body of its first and its last element, with the
    origin (3,) m and the axes (3, 3) of the link's frame in it.
    """

    name: str
    length: float
    section: tuple[float, float]
    round: bool
    stiffness: Vector
    moduli: tuple[float, float, float]
    yield_stress: float | None
    stretches: bool
    elements: int
    pieces: tuple[tuple[str | None, Vector, float], ...]
    joints: tuple[str, ...]
    root: tuple[str | None, Vector, Vector]
    tip: tuple[str | None, Vector, Vector]


@dataclass(frozen=True)
class SpatialJoint:
    """Joint of two bodies; parent None is the ground. Its frame is at a point (3,) m of each, turned by (3, 3) in it.

    law: what acts along the coordinate; in a ball joint along the angle of the rotation from home (rad), its damper on
    the whole relative angular velocity. elastic: of one between two elements of a link that bends; a joint of the kind
    `stretching` slides along x of its frame as well.

    z of the joint's frame is the axis of a hinge or slider; at coordinate 0 both frames coincide. constrained: which of
    the displacements along x, y, z of the joint's frame and rotations about them are held. start, rate: coordinate of a
    hinge or slider (rad, right-handed, or m) and its rate at the start. closes: whether it closes a loop.
    """

    name: str
    kind: str  # the type of the config; of one between elements of a link `elastic` or `stretching`
    parent: str | None
    parent_point: Vector
    parent_turn: Vector
    child: str
    child_point: Vector
    child_turn: Vector
    constrained: tuple[bool, ...]
    start: float = 0.0
    rate: float = 0.0
    closes: bool = False
    law: JointLaw = field(default_factory=JointLaw)
    elastic: Elastic | None = None

    @property
    def has_coordinate(self) -> bool:
        """Whether it is a hinge or a slider."""
        return self.kind in ("hinge", "slider")

    @property
    def is_idle(self) -> bool:
        """As of `Joint`."""
        return self.law.is_idle and self.elastic is None

    @property
    def is_sprung(self) -> bool:
        """Whether it is a ball joint in which something acts."""
        return self.kind == "ball" and not self.law.is_idle

    @property
    def acts(self) -> bool:
        """Whether it is a ball joint in which something acts, or one between elements of a link that bends."""
        return self.is_sprung or self.elastic is not None

    @property
    def axis(self) -> Vector | None:
        """Direction (3,) of a slider in the frame of its parent."""
        return self.parent_turn[:, 2] if self.kind == "slider" else None


@dataclass(frozen=True, repr=False)
class SpatialScene(Scene):
    """A scene in space; fields as of `Scene`. tip: body and point (3,) m of what is lowest, or farthest from the joint
    on the ground. beams: the links that bend, whose elements are among the rigid bodies. facet_shares: by body, of
    the size of facets that its parts have, which is taken; 1 unless it is named. modes: in how many a plane the links
    bend; None: in all that their elements have.
    """

    rigid: tuple[SpatialRigidBody, ...]  # type: ignore[assignment]
    joints: tuple[SpatialJoint, ...]  # type: ignore[assignment]
    bed: SpatialBed | None  # type: ignore[assignment]
    beams: tuple[SpatialBeam, ...] = ()
    facet_shares: Mapping[str, float] = field(default_factory=dict)
    modes: int | None = None

    in_space = True

    def __repr__(self) -> str:
        counts = f"{len(self.rigid)} rigid and 0 flexible bodies"
        rigid = sum(not body.is_element for body in self.rigid)
        return super().__repr__().replace(counts, f"{rigid} rigid and {len(self.beams)} flexible bodies")

    @cached_property
    def surface(self) -> float | None:
        """Height of the free surface at the origin (m); None without one."""
        return None if self.bed is None else float(self.bed.height(np.zeros(1), np.zeros(1))[0])

    @cached_property
    def mechanisms(self) -> dict[str, str]:
        """By body the mechanism that it is of: bodies that joints connect, by the name of the first."""
        found = {body.name: body.name for body in self.rigid}
        for joint in self.joints:
            if joint.parent is not None:
                one, other = found[joint.parent], found[joint.child]
                found = {body: one if of == other else of for body, of in found.items()}
        return found

    @cached_property
    def in_sand(self) -> dict[str, int]:
        """By mechanism how many of its bodies the medium can meet; a link that bends is one."""
        met = {
            link_of(body.name): self.mechanisms[body.name] for body in self.rigid if any(p.in_sand for p in body.parts)
        }
        return dict(Counter(met.values()))

    def with_facets(self, share: float) -> SpatialScene:
        """The same with a share of the size of all facets."""
        shares = {body.name: share * self.facet_shares.get(body.name, 1.0) for body in self.rigid}
        return replace(self, facet_shares=shares)

    def radius(self, body: SpatialRigidBody) -> float:  # type: ignore[override]
        """Distance (m) from a body's centre of mass to the farthest point of its parts and joints; without such its
        radius of gyration, so that its turning counts.
        """
        joints = [c.child_point for c in self.joints if c.child == body.name and c.kind != "free"]
        joints += [c.parent_point for c in self.joints if c.parent == body.name]
        far = [float(np.linalg.norm(point)) for point in joints]
        far += [float(np.linalg.norm(part.points, axis=1).max()) + part.drop for part in body.parts]
        return max(far, default=0.0) or math.sqrt(float(np.linalg.norm(body.inertia, 2)) / body.mass)

    @property
    def bends(self) -> bool:
        """As of `Scene`."""
        return bool(self.beams)

    def link_length(self, name: str) -> float:
        """As of `Scene`."""
        return next(beam.length for beam in self.beams if beam.name == name)

    def joint(self, name: str) -> SpatialJoint:  # type: ignore[override]
        """As of `Scene`."""
        return next(joint for joint in self.joints if joint.name == name)

    def body(self, name: str) -> SpatialRigidBody:  # type: ignore[override]
        """As of `Scene`."""
        return next(body for body in self.rigid if body.name == name)

    @cached_property
    def reported(self) -> tuple[str, ...]:
        """Names under which bodies are reported: of what is rigid its own, then of links that bend, as wholes."""
        return tuple(body.name for body in self.rigid if not body.is_element) + tuple(one.name for one in self.beams)

    @cached_property
    def speed(self) -> float:
        """Greatest speed (m/s) of a point at the start, a bound."""
        return max(
            math.hypot(*body.motion.velocity) + math.hypot(*body.motion.rate) * self.radius(body) for body in self.rigid
        )

    @property
    def pivot(self) -> None:
        """There is none in space: nothing is reported of one hinge on the ground alone."""
        return
