"""Surfaces of revolution about z -> facets: rings along the meridian, and patches around them.

Each ring is integrated by Gauss's rule along its meridian and around it; see `facets` for what a patch is.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.sand.space import triangles
from granular_contact.sand.space.facets import Facets, Size, patch_facets, piece_count

Vector = NDArray[np.float64]
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)


class Strip(NamedTuple):
    """Ring of a surface of revolution about z, by the quadrature points of its meridian.

    Parameters
    ----------
    r, z : (k,) array
        Radius and height of the points (m).
    nr, nz : (k,) array
        Components of the outward normal at the points.
    weight : (k,) array
        Weights of the quadrature along the meridian (m).
    edge : float
        Greatest edge around z (m).
    least : int
        Least number of patches around z.
    pole : bool
        Whether the ring is one patch around a pole.
    """

    r: Vector
    z: Vector
    nr: Vector
    nz: Vector
    weight: Vector
    edge: float
    least: int = 4
    pole: bool = False

    @property
    def radius(self) -> float:
        """Mean radius (m)."""
        return float(self.r @ self.weight / self.weight.sum())


def line(start: tuple[float, float], end: tuple[float, float], size: Size) -> list[Strip]:
    """Strips of a straight meridian, whose outside is to its right.

    Parameters
    ----------
    start, end : tuple of float
        r, z (m) of the ends.
    size : Size
        Size of the facets.

    Raises
    ------
    SceneError
        There would be more than `triangles.MOST_FACETS`.
    """
    (r0, z0), (r1, z1) = start, end
    length = float(np.hypot(r1 - r0, z1 - z0))
    normal, flat, edge = ((z1 - z0) / length, (r0 - r1) / length), z0 == z1, size.edge
    least = 4 if flat else 4 * piece_count(0.5 * np.pi, size.turn)  # a cone turns around its tip as far as at its base
    _check(length, max(np.pi * (r0 + r1), least * edge), edge, edge)
    pieces, strips = _pieces(0.0, 1.0, piece_count(length, edge), flat and r0 == 0.0, flat and r1 == 0.0), []
    for t, weight, pole in pieces:
        nr, nz = (np.full_like(t, component) for component in normal)
        strips.append(Strip(r0 + (r1 - r0) * t, z0 + (z1 - z0) * t, nr, nz, weight * length, edge, least, pole))
    return strips


def arc(radius: float, z: float, start: float, end: float, size: Size) -> list[Strip]:
    """Strips of a circular meridian about r = 0.

    Parameters
    ----------
    radius : float
        Radius (m).
    z : float
        Height of the centre (m).
    start, end : float
        Elevations of the ends (rad).
    size : Size
        Size of the facets.

    Raises
    ------
    SceneError
        There would be more than `triangles.MOST_FACETS`.
    """
    edge, length = size.around(radius), (end - start) * radius
    _check(length, 2.0 * length, edge, edge)
    pieces = _pieces(start, end, piece_count(length, edge), start == -0.5 * np.pi, end == 0.5 * np.pi)
    return [
        Strip(radius * np.cos(t), z + radius * np.sin(t), np.cos(t), np.sin(t), weight * radius, edge, pole=pole)
        for t, weight, pole in pieces
    ]


def _check(length: float, around: float, *edges: float) -> None:
    """Refuse strips with too many patches, by the lengths (m) of a meridian and of a mean parallel."""
    triangles.check_number(piece_count(length, edges[0]) * piece_count(around, edges[1]), min(edges), length * around)


def _pieces(start: float, end: float, count: int, first: bool, last: bool) -> list[tuple[Vector, Vector, bool]]:
    """Gauss points and weights in each piece of an interval, and whether the piece is a pole.

    first, last: whether the interval begins or ends at a pole. There the piece has half the length, for one patch
    around the pole.
    """
    halves = 0.5 * first + 0.5 * last
    count = max(count, 2) + (halves == 1.0) if halves else count
    step, pieces = (end - start) / (count - halves), []
    at = start + step * np.clip(np.arange(count + 1) - 0.5 * first, 0.0, count - halves)
    for i, (a, b) in enumerate(pairwise(at.tolist())):
        pole = (first and i == 0) or (last and i == count - 1)
        pieces.append((0.5 * (a + b) + 0.5 * (b - a) * POINTS, 0.5 * (b - a) * WEIGHTS, pole))
    return pieces


def revolved(strips: Sequence[Strip]) -> Facets:
    """Patches of a surface of revolution: one patch of each strip is computed at the x axis and rotated about z.

    Parameters
    ----------
    strips : sequence of Strip
        The strips.

    Raises
    ------
    SceneError
        There would be more than `triangles.MOST_FACETS`.
    """
    counts = np.array([_patch_count(strip) for strip in strips])
    area = sum(2.0 * np.pi * float(strip.r @ strip.weight) for strip in strips)
    triangles.check_number(int(counts.sum()), min(strip.edge for strip in strips), area)
    half, around = (np.pi / counts)[:, None, None], counts[:, None, None] > 1
    phi = half * np.where(around, POINTS[:, None], np.array([-0.75, -0.25, 0.25, 0.75])[:, None])
    r, z, nr, nz, weight = (np.array([getattr(strip, name) for strip in strips])[:, None] for name in Strip._fields[:5])
    weights = half * np.where(around, WEIGHTS[:, None], 0.5) * weight * r
    place, normal = (
        np.stack([across * np.cos(phi), across * np.sin(phi), up + 0.0 * phi], axis=-1).reshape(len(strips), -1, 3)
        for across, up in ((r, z), (nr, nz))
    )
    along = np.column_stack([-nz.mean(axis=(1, 2)), np.zeros(len(strips)), nr.mean(axis=(1, 2))])
    patches = patch_facets(place, normal, weights.reshape(len(strips), -1), along)
    ring = np.repeat(np.arange(len(strips)), counts)
    angle = np.pi / counts[ring] * (2.0 * (np.arange(len(ring)) - np.repeat(np.cumsum(counts) - counts, counts)) + 1.0)
    angle[counts[ring] == 1] = 0.0
    turn = np.zeros((len(ring), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1], turn[:, 2, 2] = -turn[:, 1, 0], 1.0
    copies = patches.subset(ring)
    vectors = (np.einsum("nij,nj->ni", turn, v) for v in (copies.place, copies.normal, copies.a, copies.b))
    return copies._replace(**dict(zip(("place", "normal", "a", "b"), vectors, strict=True)))


def _patch_count(strip: Strip) -> int:
    """Number of patches of a strip: 1 at a pole, else a multiple of four."""
    return 1 if strip.pole else max(strip.least, 4 * piece_count(0.5 * np.pi * strip.radius, strip.edge))
