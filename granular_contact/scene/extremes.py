"""Points of arcs that are lowest, or farthest from another point: of the geometry, wherever it is cut into chords."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from granular_contact.scene.types import InitialMotion, Shape, Vector

DOWN = np.array([0.0, -1.0])
AT_CENTRE = 1e-9  # of the radius: no point of a circle around the other point is farthest


def lowest(shape: Shape, motion: InitialMotion) -> Iterator[Vector]:
    """Points (2,) m, in the frame of the body, where arcs of a shape are lowest within a side."""
    yield from _within(shape, motion, None)


def farthest(shape: Shape, motion: InitialMotion, root: Vector) -> Iterator[Vector]:
    """Points (2,) m, in the frame of the body, where arcs are farthest from a point (2,) m of the world."""
    yield from _within(shape, motion, root)


def _within(shape: Shape, motion: InitialMotion, root: Vector | None) -> Iterator[Vector]:
    if shape.turns is None:
        return
    points = motion.world(shape.points)
    for a, b, turn in zip(points, points[1:], shape.turns, strict=False):
        if turn == 0.0:
            continue
        chord, middle = b - a, 0.5 * (a + b)
        left = np.array([-chord[1], chord[0]])
        centre = middle + 0.5 * left / np.tan(0.5 * turn)  # to the left where it turns counter-clockwise
        radius = float(np.linalg.norm(a - centre))
        way = DOWN if root is None else centre - root
        length = float(np.linalg.norm(way))
        if length <= AT_CENTRE * radius:
            continue
        # Of the side's circle the point in that direction, if it is as near to the middle of the side as its ends.
        if float((middle - centre) @ way) >= np.cos(0.5 * turn) * float(np.linalg.norm(middle - centre)) * length:
            yield motion.local(centre + radius * way / length)
