"""The scene that the engine gets: bodies, joints, medium and numbers, as frozen plain data.

World frame: x horizontal, y up, origin where the mechanism is joined to the ground. A body's frame has its x axis along
the body. Angles turn counter-clockwise here; the angle below the horizontal that configs and results speak of is their
negative.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from granular_contact.media.kinds import Medium
from granular_contact.media.static_friction import Elastoplastic, Smooth
from granular_contact.scene.bed import Bed

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Cylinder:
    """Straight round bar from start to end, (2,) m in its body's frame; diameter in m; `free` tells a free end face."""

    part: str
    start: Vector
    end: Vector
    diameter: float
    free: bool = False


@dataclass(frozen=True)
class Disc:
    """Round disc whose axis is normal to the plane; center (2,) m in its body's frame, diameter in m."""

    part: str
    center: Vector
    diameter: float


@dataclass(frozen=True)
class Motion:
    """Initial pose and velocity of a body's frame: position (2,) m, angle rad, velocity (2,) m/s, rate rad/s."""

    position: Vector
    angle: float
    velocity: Vector
    rate: float


@dataclass(frozen=True)
class Tether:
    """Where a body hangs from the rest: its point (2,) m in its frame, at most `length` (m) away from the origin."""

    point: Vector
    length: float

    def reach(self, point: Vector) -> float:
        """Greatest distance (m) from the origin that a point (2,) of the body can get."""
        return self.length + float(np.linalg.norm(point - self.point))


@dataclass(frozen=True)
class RigidBody:
    """Parts that are welded together. Mass kg; inertia kg m2 about the centre of mass, the origin of its frame."""

    name: str
    mass: float
    inertia: float
    cylinders: tuple[Cylinder, ...]
    discs: tuple[Disc, ...]
    motion: Motion
    tether: Tether


@dataclass(frozen=True)
class FlexibleLink:
    """Straight beam from the origin of its frame along x. m, kg/m, N m2, N, N m2 s, N s."""

    name: str
    length: float
    diameter: float
    mass_per_length: float
    bending_stiffness: float
    axial_stiffness: float
    bending_damping: float
    axial_damping: float
    elements: int
    motion: Motion
    tether: Tether
    free: bool

    @property
    def mass(self) -> float:
        """Mass (kg)."""
        return self.mass_per_length * self.length


@dataclass(frozen=True)
class Connection:
    """Joint of two bodies at a point of each, (2,) m in their frames; parent None is the ground."""

    name: str
    kind: Literal["hinge", "weld"]
    parent: str | None
    parent_point: Vector
    child: str
    child_point: Vector


@dataclass(frozen=True)
class Load:
    """How the medium acts: resultant form or distributed, end caps, strips, static friction."""

    resultant: bool
    end_cap: bool
    strips_per_element: int
    strips_per_rigid_part: int
    static: Elastoplastic | Smooth


@dataclass(frozen=True)
class Solver:
    """Times in s, speeds in m/s; tolerance relative to the forces of the scene."""

    end_time: float
    step: float
    rest_time: float | None
    rest_speed: float
    spectral_radius: float
    tolerance: float


@dataclass(frozen=True)
class Reduced:
    """Reduced model in place of the engine; see `granular_contact.reduced`.

    modes: of the flexible link, 0 for a rigid one; static: "true_sign", or the kind of static friction that the load
    has; rtol: error of a step relative to the size and speed of the mechanism; integrator: the project's own
    "dormand_prince" or one of scipy's by its name there.
    """

    modes: int
    static: Literal["true_sign", "elastoplastic", "smooth"]
    rtol: float
    integrator: str


@dataclass(frozen=True)
class Scene:
    """All that a solver needs. gravity m/s2, downward; bed: None in vacuum; impact angle rad and speed rad/s.

    method: None for the engine.
    """

    name: str
    rigid: tuple[RigidBody, ...]
    links: tuple[FlexibleLink, ...]
    connections: tuple[Connection, ...]
    gravity: float
    bed: Bed | None
    load: Load
    solver: Solver
    impact_angle: float
    impact_speed: float
    tip: tuple[str, Vector]
    output_interval: float | None
    method: Reduced | None = None

    @property
    def surface(self) -> float | None:
        """Height of the highest point of the free surface (m); None without one."""
        return None if self.bed is None else self.bed.top

    @property
    def media(self) -> tuple[Medium, ...]:
        """All media of the bed, from the top; none in vacuum."""
        return () if self.bed is None else self.bed.media

    @property
    def bodies(self) -> list[RigidBody | FlexibleLink]:
        """All bodies, the rigid ones first."""
        return [*self.rigid, *self.links]

    @property
    def mass(self) -> float:
        """Moving mass (kg)."""
        return sum(body.mass for body in self.bodies)

    def body(self, name: str) -> RigidBody | FlexibleLink:
        """Body of this name."""
        return next(body for body in self.bodies if body.name == name)

    @property
    def tip_position(self) -> Vector:
        """Initial world position (2,) m of the tip, the farthest end of the mechanism."""
        name, point = self.tip
        return place(self.body(name).motion, point)

    @property
    def pivot(self) -> Connection | None:
        """First hinge to the ground."""
        return next((c for c in self.connections if c.kind == "hinge" and c.parent is None), None)


def rotation(angle: float) -> NDArray[np.float64]:
    """Matrix (2, 2) that turns counter-clockwise by angle (rad)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def place(motion: Motion, point: Vector) -> Vector:
    """World position (2,) m of a body-frame point at the initial pose."""
    placed: Vector = motion.position + rotation(motion.angle) @ point
    return placed
