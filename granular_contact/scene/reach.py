"""What of a mechanism can get below the surface, however its joints turn."""

from __future__ import annotations

from granular_contact.scene.types import FlexibleLink, RigidBody, Shape, Vector

# A stretched beam may be a little longer than its reference; what is this close to reaching the surface gets the load.
MARGIN = 1.02


def reaches(surface: float, body: RigidBody | FlexibleLink, *points: Vector, drop: float = 0.0) -> bool:
    """Whether one of the points (2,) m of a body's frame, or what is `drop` (m) below it, can get below the surface."""
    return any(-MARGIN * (body.tether.reach(point) + drop) < surface for point in points)


def dips(surface: float, body: RigidBody, shape: Shape) -> bool:
    """Whether the medium may act on a shape of a body."""
    return shape.in_sand and reaches(surface, body, *shape.points, drop=shape.drop)
