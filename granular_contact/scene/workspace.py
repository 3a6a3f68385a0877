"""Parts of a mechanism that can get below the surface, for all coordinates of its joints."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from granular_contact.scene.bed import Bed
from granular_contact.scene.parts import FlexibleLink, RigidBody, Shape
from granular_contact.scene.types import Vector

# Factor on distances, as a stretched beam is a little longer than its reference length.
MARGIN = 1.02


def can_get_below(
    bed: Bed, body: RigidBody | FlexibleLink, points: Vector, drop: float = 0.0, depth: float = 0.0
) -> bool:
    """Whether points (n, 2) m of a body's frame, or places `drop` (m) below them, can get deeper than `depth` (m).

    Depths are below the free surface. The check uses the greatest distance from the root that the links between allow;
    it does not use the ranges of the joints.
    """
    farthest = MARGIN * body.workspace.radius(points)
    return bed.greatest_depth(body.workspace.root, farthest) + MARGIN * drop > depth


def can_be_immersed(bed: Bed, body: RigidBody, shape: Shape, depth: float = 0.0) -> bool:
    """Whether a shape of a body is in the sand and can get deeper than `depth` (m)."""
    return shape.in_sand and can_get_below(bed, body, shape.points, drop=shape.drop, depth=depth)


def immersible(bed: Bed, bodies: Iterable[RigidBody], depth: float = 0.0) -> list[tuple[RigidBody, Shape]]:
    """All shapes that can be immersed deeper than `depth` (m), with their bodies."""
    return [(body, shape) for body in bodies for shape in body.shapes if can_be_immersed(bed, body, shape, depth)]


def immersible_elements(bed: Bed, link: FlexibleLink) -> range:
    """Indices of the elements of a link that bends, from the first to the last that can get below the surface."""
    nodes = np.linspace(0.0, link.length, link.elements + 1)
    below = [can_get_below(bed, link, np.array([[a, 0.0], [b, 0.0]])) for a, b in pairwise(nodes)]
    return range(below.index(True), len(below) - below[::-1].index(True)) if any(below) else range(0)
