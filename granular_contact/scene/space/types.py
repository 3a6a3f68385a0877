"""The scene in space: bodies, joints and bed, as frozen plain data, in SI units.

World frame: x ahead, y left, z up. The origin of a body's frame is the common centre of mass of all bodies of the
config that are welded together. Angles are right-handed.
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

from granular_contact.geometry.rotations import vector_products
from granular_contact.scene.joint_law import JointLaw
from granular_contact.scene.types import Scene, link_of, with_name

if TYPE_CHECKING:
    from granular_contact.scene.space.bed import SpatialBed

Vector = NDArray[np.float64]
Meets = Literal["surface", "bar", "ball"]


@dataclass(frozen=True)
class SpatialWheel:
    """Wheel of a shape in the body's frame: a point (3,) m of its axle, radius (m) for slip, radius of the rim (m).

    axis: direction (3,) of the axle, to the left of the rolling direction for a positive rate. pitch: as in `Wheel`.
    """

    axle: Vector
    axis: Vector
    radius: float
    rim: float
    pitch: float = 0.0


@dataclass(frozen=True)
class Part:
    """Shape of a body, for the forces of the medium and for drawings, in the frame of the merged body.

    name: of the body in the config. shape: of `sand.space.shapes`. meets: kinds of shape that it can be for a law.
    position (3,) m, rotation (3, 3): of the shape's frame. in_sand: whether the medium acts on it. facet_size (m):
    greatest edge of its facets, None for the default. triangles (k, 3, 3) m: to draw. points (n, 3) m: outermost points
    of the shape, which reaches `drop` (m) around them. notes: sentences on what makes its forces uncertain as a
    surface. wheel: of a wheel.
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
        """How much deeper (m) than its points the part is, see `reach`."""
        return reach(self.drop, self.meets == ("ball",), rise_x, rise_y)


def reach(drop: Vector | float, as_ball: Any, rise_x: Vector, rise_y: Vector) -> Vector:
    """How much deeper (m) than its points a part is below a surface with these slopes along x and y.

    The part reaches `drop` (m) around its points in all directions; a ball for a law of balls only straight down.
    """
    return np.asarray(drop * np.where(as_ball, 1.0, np.sqrt(1.0 + rise_x**2 + rise_y**2)))


@dataclass(frozen=True)
class SpatialMotion:
    """Initial pose and velocity of a body's frame, in the world frame.

    position (3,) m and velocity (3,) m/s of its origin; rotation (3, 3); angular velocity `rate` (3,) rad/s.
    """

    position: Vector
    rotation: Vector
    velocity: Vector
    rate: Vector

    def world(self, points: Vector) -> Vector:
        """World positions (n, 3) m of points of the body, (n, 3) or (3,)."""
        positions: Vector = self.position + points @ self.rotation.T
        return positions

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (3,) m."""
        points: Vector = self.rotation.T @ (point - self.position)
        return points

    def speed_at(self, world: Vector) -> Vector:
        """Velocity (3,) m/s of the body's point at a world position (3,) m."""
        speed: Vector = self.velocity + vector_products(self.rate, world - self.position)
        return speed


@dataclass(frozen=True)
class SpatialRigidBody:
    """Bodies of the config that are welded together; the origin of its frame is the common centre of mass.

    mass: kg. inertia: (3, 3) kg m2 about the centre of mass. members: names of its bodies of the config and of its
    elements of links that bend.
    """

    name: str
    mass: float
    inertia: Vector
    parts: tuple[Part, ...]
    motion: SpatialMotion
    members: tuple[str, ...] = ()

    @property
    def is_element(self) -> bool:
        """Whether all its members are elements of links that bend."""
        return all("." in name for name in self.members)

    @property
    def wheel(self) -> SpatialWheel | None:
        """The first wheel of the body; None without one."""
        return next((part.wheel for part in self.parts if part.wheel is not None), None)

    @property
    def rotation_indices(self) -> tuple[int, ...]:
        """Indices of the coordinates (position and four Euler parameters) that are rotations."""
        return 3, 4, 5, 6

    def levers(self, radius: float) -> tuple[float, ...]:
        """Factors from coordinate rates to greatest speeds (m/s) of points within a radius (m); |w| <= 2 |e'|."""
        return (1.0,) * 3 + (2.0 * radius,) * 4

    def mass_matrix(self) -> Vector:
        """Mass matrix (7, 7) with the greatest moment of inertia for all rotations, for uses without inertia forces."""
        turning = 4.0 * float(np.linalg.eigvalsh(self.inertia).max())
        return np.diag([self.mass] * 3 + [turning] * 4)

    def weight(self, gravity: float) -> Vector:
        """Generalised forces (7,) of the weight."""
        return np.array([0.0, 0.0, -gravity * self.mass, 0.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Elastic:
    """Elastic law of a joint between elements of a link: moments (N m) about x, y, z of the joint's frame.

    They are functions of the rotation vector theta (rad) from parent to child: with stiffness (3,) N m/rad and damping
    (3,) N m s/rad, the energy is sum(stiffness theta^2) / 2 and the dissipated power sum(damping theta'^2). axial:
    stiffness (N/m) and damping (N s/m) of a joint that also slides along x of the frame, else None.
    """

    stiffness: Vector
    damping: Vector
    axial: tuple[float, float] | None = None


@dataclass(frozen=True)
class SpatialBeam:
    """Link that bends, made of rigid elements, see `scene.space.beams`; the x axis of its frame is along it.

    length: m. section (m): width along y and thickness along z, for a round section twice the diameter. stiffness (3,)
    N m2: G J, E I_y, E I_z. moduli (Pa): E for bending, G for torsion, E for stretch. yield_stress (Pa): None if
    stresses are not compared with it. stretches: whether it has an axial stiffness. elements: their number. pieces: the
    rigid pieces from root to tip, each with its body (None: the ground), its centre of mass (3,) m in the frame of that
    body, and its mass (kg). joints: names of the joints between the pieces. root, tip: body of the first and of the
    last piece, with origin (3,) m and axes (3, 3) of the link's frame in it.
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
    """Joint between two bodies; parent None is the ground.

    parent_point, parent_turn: origin (3,) m and axes (3, 3) of the joint's frame on the parent, in the frame of the
    parent; child_point, child_turn: the same on the child. z of the joint's frame is the axis of a hinge or slider; at
    coordinate 0 both frames coincide. constrained (6,): whether the displacements along x, y, z of the joint's frame
    and the rotations about them are constrained. start, rate: coordinate of a hinge or slider (rad, right-handed, or m)
    and its rate at the start. closes: whether the joint closes a loop. law: of the coordinate; in a ball joint of the
    angle of the rotation from home (rad), with its damper on the whole relative angular velocity. elastic: law of a
    joint between two elements of a link that bends; a joint of the kind `stretching` also slides along x of its frame.
    effort_limit, rate_limit: of its actuator (N m or N; rad/s or m/s).
    """

    name: str
    kind: str  # the type in the config; between elements of a link `elastic` or `stretching`
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
    effort_limit: float = math.inf
    rate_limit: float = math.inf
    elastic: Elastic | None = None

    @property
    def has_coordinate(self) -> bool:
        """Whether the joint is a hinge or a slider."""
        return self.kind in ("hinge", "slider")

    @property
    def is_idle(self) -> bool:
        """Whether the joint has no spring, damper, stops, friction or elastic law; it may have a drive."""
        return self.law.is_idle and self.elastic is None

    @property
    def is_sprung(self) -> bool:
        """Whether the joint is a ball joint with a law that is not idle."""
        return self.kind == "ball" and not self.law.is_idle

    @property
    def acts(self) -> bool:
        """Whether the joint is a ball joint with a law that is not idle, or one between elements of a link."""
        return self.is_sprung or self.elastic is not None

    @property
    def axis(self) -> Vector | None:
        """Unit vector (3,) along the axis of a slider in the frame of its parent; None for other joints."""
        return self.parent_turn[:, 2] if self.kind == "slider" else None


@dataclass(frozen=True, repr=False)
class SpatialScene(Scene):
    """Scene in space; fields as in `Scene`.

    tip: body and point (3,) m, the lowest one or the farthest from the joint on the ground. beams: the links that bend;
    their elements are among the rigid bodies. facet_shares: factor on the facet size of all parts of a body, by name; 1
    for other bodies. modes: number of modes of a link for torsion and for each plane of bending; None: elements are not
    reduced to modes.
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
        """Height (m) of the free surface at x = y = 0; None without a surface."""
        return None if self.bed is None else float(self.bed.height(np.zeros(1), np.zeros(1))[0])

    @cached_property
    def mechanisms(self) -> dict[str, str]:
        """The mechanism of each body, by name: bodies connected by joints, with the name of one of them."""
        mechanism_of = {body.name: body.name for body in self.rigid}
        for joint in self.joints:
            if joint.parent is not None:
                kept, joined = mechanism_of[joint.parent], mechanism_of[joint.child]
                mechanism_of = {body: kept if name == joined else name for body, name in mechanism_of.items()}
        return mechanism_of

    @cached_property
    def in_sand(self) -> dict[str, int]:
        """Number of bodies of each mechanism that the medium can act on; a link that bends counts as one."""
        in_sand = [body for body in self.rigid if any(part.in_sand for part in body.parts)]
        mechanism_of = {link_of(body.name): self.mechanisms[body.name] for body in in_sand}
        return dict(Counter(mechanism_of.values()))

    def with_facets(self, share: float) -> SpatialScene:
        """The same scene with the size of all facets multiplied by a factor."""
        shares = {body.name: share * self.facet_shares.get(body.name, 1.0) for body in self.rigid}
        return replace(self, facet_shares=shares)

    def radius(self, body: SpatialRigidBody) -> float:  # type: ignore[override]
        """Distance (m) from a body's centre of mass to the farthest point of its parts and joints, as in `Scene`."""
        return self._radii[body.name]

    @cached_property
    def _radii(self) -> dict[str, float]:
        """Radius (m) of each body, see `radius`."""
        distances: dict[str | None, list[float]] = {body.name: [] for body in self.rigid}
        for joint in self.joints:
            if joint.kind != "free":
                distances[joint.child].append(math.hypot(*joint.child_point))
            if joint.parent is not None:
                distances[joint.parent].append(math.hypot(*joint.parent_point))
        for body in self.rigid:
            distances[body.name] += [
                float(np.linalg.norm(part.points, axis=1).max()) + part.drop for part in body.parts
            ]
        return {
            body.name: max(distances[body.name], default=0.0)
            or math.sqrt(float(np.linalg.norm(body.inertia, 2)) / body.mass)
            for body in self.rigid
        }

    @property
    def bends(self) -> bool:
        """As in `Scene`."""
        return bool(self.beams)

    def link_length(self, name: str) -> float:
        """Length (m) of a link that bends, one of `beams`; see `Scene.link_length`."""
        return with_name(self.beams, name, "link that bends").length

    def joint(self, name: str) -> SpatialJoint:  # type: ignore[override]
        """Joint with this name; see `Scene.joint`."""
        return with_name(self.joints, name, "joint")

    def body(self, name: str) -> SpatialRigidBody:  # type: ignore[override]
        """Rigid body with this name, which may be an element of a link that bends; see `Scene.body`."""
        return with_name(self.rigid, name, "body")

    @cached_property
    def reported(self) -> tuple[str, ...]:
        """Names under which bodies are reported: those of rigid bodies, then those of links that bend."""
        return tuple(body.name for body in self.rigid if not body.is_element) + tuple(beam.name for beam in self.beams)

    @cached_property
    def speed(self) -> float:
        """Upper bound of the speed (m/s) of all points at the start."""
        return max(
            math.hypot(*body.motion.velocity) + math.hypot(*body.motion.rate) * self.radius(body) for body in self.rigid
        )

    @property
    def pivot(self) -> None:
        """None: in space, a single hinge on the ground has no reports of its own."""
        return
