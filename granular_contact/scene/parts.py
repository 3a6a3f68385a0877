"""Parts of a scene: shapes, initial poses and velocities of bodies, rigid bodies and beams. SI units."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Wheel:
    """Wheel of a shape: its axle (2,) m in the body's frame; radius (m) for slip, and rim: radius of the rim (m).

    pitch (rad): angle between two grousers, 0 without grousers.
    """

    axle: Vector
    radius: float
    rim: float
    pitch: float = 0.0


@dataclass(frozen=True)
class Shape:
    """Shape of a body, for the forces of the medium and for drawings.

    part: name of the body in the config. points (k, 2) m in the body's frame: the middle line of a bar or plate, the
    closed outline of a solid (the first point repeated), or the centre of a ball. width (m): a diameter, or the extent
    normal to the plane. thickness (m): extent of a bar or plate in the plane, diameter of a ball, 0 for an outline.
    free: whether nothing is joined to the last point, so that the end of a line is a free face. mass (kg): of a ball
    alone, for laws that need it. turns (k - 1,) rad: counter-clockwise angle of the arc of which the side between two
    points is the chord, 0 for a straight side; None: all sides are straight.
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
        """How far (m) the shape reaches below its points: the radius of a ball, else 0."""
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
        positions: Vector = self.position + point @ rotation(self.angle).T
        return positions

    def local(self, point: Vector) -> Vector:
        """Body-frame position of a world point (2,) m, or of several (n, 2)."""
        points: Vector = (point - self.position) @ rotation(-self.angle).T
        return points

    def speed_at(self, world: Vector) -> Vector:
        """Velocity (2,) m/s of the body's point at a world position (2,) m."""
        arm = world - self.position
        return self.velocity + self.rate * np.array([-arm[1], arm[0]])


@dataclass(frozen=True)
class WorkspaceBound:
    """Bound of the workspace of a body: its `point` (2,) m, body frame, stays within `length` (m) of the fixed `root`.

    root: (2,) m, world frame: the joint on the ground that carries the body, directly or through other bodies.
    """

    root: Vector
    point: Vector
    length: float

    def radius(self, point: Vector) -> float:
        """Greatest possible distance (m) of a point (2,) m of the body, or of any of several (n, 2), from the root."""
        return self.length + float(np.linalg.norm(np.atleast_2d(point) - self.point, axis=1).max())


@dataclass(frozen=True)
class RigidBody:
    """Bodies of the config that are welded together; the origin of its frame is the common centre of mass.

    mass: kg. inertia: kg m2 about the centre of mass.
    """

    name: str
    mass: float
    inertia: float
    shapes: tuple[Shape, ...]
    motion: InitialMotion
    workspace: WorkspaceBound

    @property
    def wheel(self) -> Wheel | None:
        """The first wheel of the body; None without one."""
        return next((shape.wheel for shape in self.shapes if shape.wheel is not None), None)

    @property
    def rotation_indices(self) -> tuple[int, ...]:
        """Indices of the coordinates (x, y, phi) that are rotations."""
        return (2,)

    def levers(self, radius: float) -> tuple[float, ...]:
        """Factors from the rates of the coordinates to greatest speeds (m/s) of points within a radius (m)."""
        return 1.0, 1.0, radius

    def mass_matrix(self) -> Vector:
        """Mass matrix (3, 3) for the coordinates (x, y, phi)."""
        return np.diag([self.mass, self.mass, self.inertia])

    def weight(self, gravity: float) -> Vector:
        """Generalised forces (3,) of the weight."""
        return np.array([0.0, -gravity * self.mass, 0.0])


@dataclass(frozen=True)
class FlexibleLink:
    """Straight beam along the x axis of its frame, from the origin. Units: m, kg/m, N m2, N, N m2 s, N s.

    kind, width, thickness, free: as in `Shape`. modulus (Pa): bending stiffness over second moment of area.
    yield_stress (Pa): None if stresses are not compared with it.
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


def scene_angle(clockwise_deg: float) -> float:
    """Convert a clockwise angle of a config (deg) to the counter-clockwise angle of a scene (rad).

    Fixed angles change their sense only here. Coordinates of hinges stay clockwise, see `layout.pose_of`.
    """
    return -math.radians(clockwise_deg)


def rotation(angle: float) -> NDArray[np.float64]:
    """Rotation matrix (2, 2) of a counter-clockwise angle (rad)."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])
