"""Pieces of bars, open at the ends where the bar goes on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from granular_contact.sand.space import facets, triangles
from granular_contact.sand.space.facets import Facets, Size, rectangle_facets
from granular_contact.sand.space.revolution import line, revolved
from granular_contact.sand.space.round_shapes import SIDES
from granular_contact.sand.space.shapes import PARTS, Shape

Vector = NDArray[np.float64]
LEAST_AROUND = 12  # least number of sides of a round section
ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # rotation that takes the z axis to the x axis


@dataclass(frozen=True)
class Beam(Shape):
    """Piece of a bar around the x axis, from -length/2 to length/2, without the end faces at which the bar goes on.

    Parameters
    ----------
    length : float
        Length (m), above 0.
    section : (2,) sequence
        Lengths of the section along y and z (m), above 0; of a round section its diameter twice.
    round : bool
        Whether the section is round; else it is rectangular.
    ends : (2,) sequence of bool
        Whether the bar ends at -length/2, and at length/2.
    """

    length: float
    section: tuple[float, float]
    round: bool
    ends: tuple[bool, bool]

    def corners(self, size: float | None = None) -> Vector:
        """Triangles of the sides, and of the ends at which the bar ends; see `Shape.corners`."""
        edge = float(np.hypot(self.length, np.hypot(*self.section))) / PARTS if size is None else size
        return triangles.cut(self._triangles(self._outline(edge)), edge)

    def drawn(self) -> Vector:
        """Triangles for drawings; see `Shape.drawn`."""
        return self._triangles(self._outline(np.pi * self.section[0] / SIDES))

    def _triangles(self, outline: Vector) -> Vector:
        """Triangles of the surface between outlines (k, 2) m of the section at both ends."""
        low, high = (np.insert(outline, 0, x, axis=1) for x in (-0.5 * self.length, 0.5 * self.length))
        a, b, c, d = low, np.roll(low, -1, axis=0), np.roll(high, -1, axis=0), high
        faces = [np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]
        for closed, (first, second), middle in ((self.ends[0], (b, a), low), (self.ends[1], (d, c), high)):
            if closed:
                faces.append(np.stack([np.broadcast_to(middle.mean(axis=0), a.shape), first, second], axis=1))
        return np.concatenate(faces)

    def cut_facets(self, size: Size) -> Facets:
        """Patches of a round bar, rectangles of a rectangular one; see `Shape.cut_facets`."""
        h, (a, b) = 0.5 * self.length, 0.5 * np.array(self.section)
        if self.round:
            strips = line((a, -h), (a, h), size)
            strips += line((0.0, -h), (a, -h), size) if self.ends[0] else []
            strips += line((a, h), (0.0, h), size) if self.ends[1] else []
            return facets.transformed(revolved(strips), np.zeros(3), ALONG_X)
        x, y, z = h * np.eye(3)[0], a * np.eye(3)[1], b * np.eye(3)[2]
        sides = [(y, z, x), (-y, x, z), (z, x, y), (-z, y, x)]
        sides += [(-x, z, y)] if self.ends[0] else []
        sides += [(x, y, z)] if self.ends[1] else []
        return facets.joined([rectangle_facets(*side, size) for side in sides])

    def rims(self) -> Vector:
        """Circles of both ends of a round bar; see `Shape.rims`."""
        h, r = 0.5 * self.length, 0.5 * self.section[0]
        return np.array([[x, 0.0, 0.0, 1.0, 0.0, 0.0, r, 0.0] for x in (-h, h)]) if self.round else np.zeros((0, 8))

    def _outline(self, edge: float) -> Vector:
        """Corners (k, 2) m of the section, counter-clockwise seen from the tip; of a round section with its area."""
        if not self.round:
            return 0.5 * np.array(self.section) * [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        count = min(max(LEAST_AROUND, int(np.ceil(np.pi * self.section[0] / edge))), triangles.MOST_FACETS)
        turn = 2.0 * np.pi / count
        angle = turn * (np.arange(count) + 0.5)
        radius = 0.5 * self.section[0] * np.sqrt(turn / np.sin(turn))
        corners: Vector = radius * np.column_stack([np.cos(angle), np.sin(angle)])
        return corners
