"""What of a mechanism can get below the surface, however its joints turn."""

from __future__ import annotations

from granular_contact.scene.bed import Bed
from granular_contact.scene.types import FlexibleLink, RigidBody, Shape, Vector

# A stretched beam may be a little longer than its reference; what is this close to reaching the surface gets the load.
MARGIN = 1.02


def reaches(bed: Bed, body: RigidBody | FlexibleLink, *points: Vector, drop: float = 0.0, depth: float = 0.0) -> bool:
    """Whether one of the points (2,) m of a body's frame, or what is `drop` (m) below it, can get deeper than `depth`.

    Depth (m) below the free surface. A point can get to all places that are as near to the root of its body as the
    joints between them let it: their angles are not looked at.
    """
    root = body.tether.root
    deepest = (bed.greatest_depth(root, MARGIN * body.tether.reach(point)) + MARGIN * drop for point in points)
    return any(one > depth for one in deepest)


def dips(bed: Bed, body: RigidBody, shape: Shape, depth: float = 0.0) -> bool:
    """Whether the medium deeper than `depth` (m) may act on a shape of a body."""
    return shape.in_sand and reaches(bed, body, *shape.points, drop=shape.drop, depth=depth)
