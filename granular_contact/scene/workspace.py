"""Which parts of a mechanism can get below the surface, whatever the coordinates of its joints."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from granular_contact.scene.bed import Bed
from granular_contact.scene.parts import FlexibleLink, RigidBody, Shape
from granular_contact.scene.types import Vector

# A stretched beam may be a little longer than its reference; what is this close to reaching the surface gets the load.
MARGIN = 1.02


def can_get_below(
    bed: Bed, body: RigidBody | FlexibleLink, points: Vector, drop: float = 0.0, depth: float = 0.0
) -> bool:
    """Whether points (n, 2) m of a body's frame, or what extends `drop` (m) below them, can get deeper than `depth`.

    Depth (m) is below the free surface. Only the greatest distance from the root that the links between them allow
    counts, not the angles of the joints.
    """
    farthest = MARGIN * body.workspace.radius(points)
    return bed.greatest_depth(body.workspace.root, farthest) + MARGIN * drop > depth


def can_be_immersed(bed: Bed, body: RigidBody, shape: Shape, depth: float = 0.0) -> bool:
    """Whether the medium deeper than `depth` (m) may act on a shape of a body."""
    return shape.in_sand and can_get_below(bed, body, shape.points, drop=shape.drop, depth=depth)


def immersible(bed: Bed, bodies: Iterable[RigidBody], depth: float = 0.0) -> list[tuple[RigidBody, Shape]]:
    """All shapes that the medium deeper than `depth` (m) may act on, with their bodies."""
    return [(body, shape) for body in bodies for shape in body.shapes if can_be_immersed(bed, body, shape, depth)]


def immersible_elements(bed: Bed, link: FlexibleLink) -> range:
    """Elements of a link that bends, from the first to the last that can get below the surface."""
    places = np.linspace(0.0, link.length, link.elements + 1)
    near = [can_get_below(bed, link, np.array([[a, 0.0], [b, 0.0]])) for a, b in pairwise(places)]
    return range(near.index(True), len(near) - near[::-1].index(True)) if any(near) else range(0)
