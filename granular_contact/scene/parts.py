"""Parts of a scene: shapes, where bodies are and how they move at the start, rigid bodies and beams. SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Wheel:
    """Of a shape that is a wheel: axle (2,) m in the body's frame; radius (m) that counts for slip, and of the rim.

    pitch (rad): between two grousers, 0 without any.
    """

    axle: Vector
    radius: float
    rim: float
    pitch: float = 0.0


@dataclass(frozen=True)
class Shape:
    """A part of a body as the medium meets it and as it is drawn.

    points (k, 2) m in the body's frame: the middle line of a bar or plate, the closed outline of a solid (the first
    point repeated), or the centre of a ball. width (m): a diameter, or the extent normal to the plane; thickness (m):
    of a bar or plate in the plane, a ball's diameter, 0 of an outline. `free`: whether the end of a line is a free
    face. mass (kg): of a ball by itself, for laws that ask for it. turns (k - 1,) rad: angle by which each side between
    two points turns where it is the chord of an arc, counter-clockwise; None: all sides are straight.
    """

    part: str
    kind: Kind
    points: Vector
    width: float
    thickness: float
    in_sand: bool = True
    free: bool = False
    mass: float = 0.0
    turns: Vector | None = None
    wheel: Wheel | None = None

    @property
    def drop(self) -> float:
        """How far it reaches below its points (m), for the medium."""
        return self.width / 2 if self.kind == "ball" else 0.0


@dataclass(frozen=True)
class InitialMotion:
    """Initial pose and velocity of a body's frame: position (2,) m, angle rad, velocity (2,) m/s, rate rad/s."""

    position: Vector
    angle: float
    velocity: Vector
    rate: float

    def world(self, point: Vector) -> Vector:
        """World position of a point (2,) m of the body, or of several (n, 2)."""
        placed: Vector = self.position + point @ rotation(self.angle).T
        return placed

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (2,) m, or of several (n, 2)."""
        placed: Vector = (point - self.position) @ rotation(-self.angle).T
        return placed

    def speed_at(self, world: Vector) -> Vector:
        """Velocity (2,) m/s of the body's point at a world position (2,) m."""
        arm = world - self.position
        return self.velocity + self.rate * np.array([-arm[1], arm[0]])


@dataclass(frozen=True)
class WorkspaceBound:
    """Bound of where a body can get: its `point` (2,) m, body frame, stays within `length` (m) of a fixed `root`.

    root: (2,) m, world frame, the joint on the ground that carries the body, directly or through other bodies.
    """

    root: Vector
    point: Vector
    length: float

    def radius(self, point: Vector) -> float:
        """Greatest distance (m) between the root and a point (2,) of the body, or the farthest of several (n, 2)."""
        return self.length + float(np.linalg.norm(np.atleast_2d(point) - self.point, axis=1).max())


@dataclass(frozen=True)
class RigidBody:
    """Parts that are welded together. Mass kg; inertia kg m2 about the centre of mass, the origin of its frame."""

    name: str
    mass: float
    inertia: float
    shapes: tuple[Shape, ...]
    motion: InitialMotion
    workspace: WorkspaceBound

    @property
    def wheel(self) -> Wheel | None:
        """The first of its wheels."""
        return next((shape.wheel for shape in self.shapes if shape.wheel is not None), None)

    @property
    def turning_places(self) -> tuple[int, ...]:
        """Which of its coordinates (x, y, phi) turn it."""
        return (2,)

    def levers(self, radius: float) -> tuple[float, ...]:
        """Factors from the rates of its coordinates to speeds (m/s) of points within a radius (m)."""
        return 1.0, 1.0, radius

    def mass_matrix(self) -> Vector:
        """Mass matrix (3, 3) of its coordinates."""
        return np.diag([self.mass, self.mass, self.inertia])

    def weight(self, gravity: float) -> Vector:
        """Generalised forces (3,) of the weight."""
        return np.array([0.0, -gravity * self.mass, 0.0])


@dataclass(frozen=True)
class FlexibleLink:
    """Straight beam from the origin of its frame along x. m, kg/m, N m2, N, N m2 s, N s.

    kind, width and thickness as of a `Shape`; modulus (Pa): of its section and bending stiffness; yield_stress (Pa):
    None where it is not looked at.
    """

    name: str
    length: float
    kind: Kind
    width: float
    thickness: float
    mass_per_length: float
    bending_stiffness: float
    axial_stiffness: float
    bending_damping: float
    axial_damping: float
    elements: int
    motion: InitialMotion
    workspace: WorkspaceBound
    free: bool
    modulus: float = 0.0
    yield_stress: float | None = None

    @property
    def mass(self) -> float:
        """Mass (kg)."""
        return self.mass_per_length * self.length


def turned(clockwise_deg: float) -> float:
    """Angle (rad) as scenes have it, counter-clockwise, of one of a config (deg), clockwise.

    Fixed angles change their sense only here; coordinates of hinges stay clockwise, see `layout.pose`.
    """
    return -math.radians(clockwise_deg)


def rotation(angle: float) -> NDArray[np.float64]:
    """Matrix (2, 2) that turns counter-clockwise by angle (rad)."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])
