"""Data of a robot file with the lines of its elements. SI units, angles in rad, as in URDF."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry import rotations

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """Pose of a frame in another: xyz (3,) m, rpy (3,) rad, with R = Rz(yaw) Ry(pitch) Rx(roll)."""

    xyz: Vector = field(default_factory=lambda: np.zeros(3))
    rpy: Vector = field(default_factory=lambda: np.zeros(3))

    @property
    def rotation(self) -> Vector:
        """Rotation matrix (3, 3) from this frame to the other."""
        return rotations.of_rpy(self.rpy)

    def then(self, inner: Pose) -> Pose:
        """Pose in the other frame of a frame that has the pose `inner` in this frame."""
        turn = self.rotation
        return Pose(self.xyz + turn @ inner.xyz, rotations.rpy_of(turn @ inner.rotation))


@dataclass(frozen=True)
class Geometry:
    """Geometry of a shape in its own frame.

    kind: box, cylinder, sphere, capsule or mesh. size (m): sides of a box; diameter and length of a cylinder or capsule
    (of a capsule between the centres of its ends); diameter of a sphere. file: of a mesh, as written; scale (3,): of a
    mesh.
    """

    kind: str
    size: tuple[float, ...] = ()
    file: str = ""
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Shape:
    """Shape of a link: a geometry with its pose in the frame of the link; line, key, link: as in the file."""

    geometry: Geometry
    pose: Pose
    line: int
    key: str
    link: str


@dataclass(frozen=True)
class Inertial:
    """Mass (kg), centre of mass (3,) m and inertia (3, 3) kg m^2 about it, in the frame of the link."""

    mass: float
    center: Vector
    tensor: Vector
    line: int


@dataclass(frozen=True)
class Link:
    """Rigid part of a robot; inertial: None without mass."""

    name: str
    line: int
    inertial: Inertial | None = None
    visual: tuple[Shape, ...] = ()
    collision: tuple[Shape, ...] = ()

    def shapes(self, which: str) -> tuple[Shape, ...]:
        """Shapes of a kind, "collision" or "visual"."""
        return self.collision if which == "collision" else self.visual


@dataclass(frozen=True)
class Joint:
    """Joint between two links; origin: pose of the child's frame in the parent's frame at coordinate 0.

    kind: revolute, continuous, prismatic, fixed, floating or planar. axis: unit vector (3,) in the frame of the child.
    lower, upper (rad or m), effort (N m or N), velocity (rad/s or m/s), damping (SI units), friction (N m or N): None
    if the file does not give them. mimic: the joint that this one follows. lines: of its elements, by tag.
    """

    name: str
    line: int
    kind: str
    parent: str
    child: str
    origin: Pose
    axis: Vector
    lower: float | None = None
    upper: float | None = None
    effort: float | None = None
    velocity: float | None = None
    damping: float | None = None
    friction: float | None = None
    mimic: str | None = None
    lines: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Robot:
    """Robot: links and joints by name, in the order of the file; root: the link that is the child of no joint."""

    name: str
    file: str
    links: dict[str, Link]
    joints: dict[str, Joint]
    root: str

    def below(self, name: str) -> Iterator[Joint]:
        """Joints whose parent is a link."""
        return (joint for joint in self.joints.values() if joint.parent == name)

    def above(self, name: str) -> Joint | None:
        """The joint whose child is a link; None for the root."""
        return next((joint for joint in self.joints.values() if joint.child == name), None)
