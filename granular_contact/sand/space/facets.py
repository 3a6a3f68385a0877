"""Surfaces -> facets: triangles, parallelograms, and patches of round surfaces, by their moments.

A round surface is cut along its meridians and parallels. Each patch is a facet with the true area, centroid and mean
normal, half edges a, b along the two with the second moments (a a^T + b b^T) / 3 of the patch, and the two curvatures:
so what acts on it errs by the square of its size. Facets are alike on all sides of a shape that is.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.mesh import areas
from granular_contact.sand.kernels.facets import COLUMNS, CURVE, FORM, PARALLELOGRAM, PATCH, RIM, SIDE, TRIANGLE
from granular_contact.sand.space import triangles

Vector = NDArray[np.float64]
FACET_ERROR = 3e-3  # of the way: by how much they may put a motion off where no accuracy is asked for
# For such an error: facets that turn by ROUND (rad) and have edges of FLAT of the diagonal of
# their shape. Errors go with the squares of both [measured: 0.01 to 0.2 % on configs in space, 2 % where a ball rolls].
ROUND, FLAT = 0.12, 1.0 / 27.0
FINEST, COARSEST = 1e-4, 1e-2  # errors that are chosen for
MOST_TURN = np.pi / 6.0
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)


class Size(NamedTuple):
    """Greatest edge of facets (m), and greatest angle (rad) by which the surface turns in one."""

    edge: float
    turn: float = MOST_TURN

    def around(self, radius: float) -> float:
        """Greatest edge (m) along a circle."""
        return min(self.edge, self.turn * radius)


class Facets(NamedTuple):
    """Facets of a surface in a frame: triangles with corners a, b, -a - b from their centroid, or parallelograms.

    place, normal (n, 3); area (n,) m2; a, b (n, 3) m: of parallelograms half edges; form (n,): of `kernels.facets`;
    curve (n, 2) 1/m: by how much the normal turns along a and along b.
    """

    place: Vector
    normal: Vector
    area: Vector
    a: Vector
    b: Vector
    form: NDArray[np.int64]
    curve: Vector

    def taken(self, which: NDArray[Any]) -> Facets:
        """Some of them."""
        return Facets(*(np.asarray(column)[which] for column in self))


def chosen(extent: float, accuracy: float | None, share: float = 1.0) -> Size:
    """Size for a shape with this diagonal (m), by the error of the motion that is allowed (of the way), or a share."""
    allowed = min(COARSEST, max(FINEST, FACET_ERROR if accuracy is None else accuracy))
    factor = share * float(np.sqrt(allowed / FACET_ERROR))
    return Size(FLAT * factor * extent, ROUND * factor)


def joined(parts: Sequence[Facets]) -> Facets:
    """All facets of several surfaces."""
    return Facets(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def of_triangles(corners: Vector) -> Facets:
    """Triangles (n, 3, 3) m, counter-clockwise seen from outside."""
    cross, place = areas(corners), corners.mean(axis=1)
    area, n = np.linalg.norm(cross, axis=1), len(corners)
    arms = corners - place[:, None]
    return Facets(place, cross / area[:, None], area, arms[:, 0], arms[:, 1], np.full(n, TRIANGLE), np.zeros((n, 2)))


def of_rectangle(middle: Vector, a: Vector, b: Vector, size: Size) -> Facets:
    """Rectangle around a point (3,) m with half edges a, b (3,) m; its normal along a x b."""
    lengths = [2.0 * float(np.linalg.norm(edge)) for edge in (a, b)]
    counts = [_count(length, size.edge) for length in lengths]
    triangles.check_number(counts[0] * counts[1], size.edge, lengths[0] * lengths[1])
    u, v = ((2.0 * np.arange(count) + 1.0) / count - 1.0 for count in counts)
    place = middle + (u[:, None, None] * a + v[None, :, None] * b).reshape(-1, 3)
    return _alike(place, np.cross(a, b) / np.linalg.norm(np.cross(a, b)), a / counts[0], b / counts[1])


def _alike(place: Vector, normal: Vector, a: Vector, b: Vector) -> Facets:
    """Flat parallelograms with the same edges."""
    n = len(place)
    area = np.full(n, 4.0 * float(np.linalg.norm(np.cross(a, b))))
    normals, first, second = (np.tile(one, (n, 1)) for one in (normal, a, b))
    return Facets(place, normals, area, first, second, np.full(n, PARALLELOGRAM), np.zeros((n, 2)))


def rim(z: float, *, circle: float = 0.0, ball: float = 0.0) -> Vector:
    """What no point of a round body is deeper than (8,): place (m), axis, radius of a circle and of a sphere (m)."""
    return np.array([0.0, 0.0, z, 0.0, 0.0, 1.0, circle, ball])


def rows(facets: Facets, rims: Vector, thin: bool) -> Vector:
    """Rows of `kernels.facets`, neighbours beside each other; rims (k, 8): as of `rim`."""
    n, triangle = len(facets.area), facets.form == TRIANGLE
    third = np.where(triangle[:, None], -facets.a - facets.b, facets.a + facets.b)
    fourth = np.where(triangle[:, None], 0.0, facets.a - facets.b)
    made = np.zeros((n + len(rims), COLUMNS))
    made[:n, 0:3], made[:n, 4:7], made[:n, 7] = facets.place, facets.normal, facets.area
    made[:n, 3] = np.max([np.linalg.norm(one, axis=1) for one in (facets.a, facets.b, third, fourth)], axis=0)
    made[:n, 8:11], made[:n, 11:14] = facets.a, facets.b
    made[:n, FORM], made[:n, CURVE : CURVE + 2] = facets.form, facets.curve
    made[n:, 0:3], made[n:, 4:7], made[n:, 8:10], made[n:, FORM] = rims[:, :3], rims[:, 3:6], rims[:, 6:], RIM
    made[n:, 3] = rims[:, 6:].sum(axis=1)
    made[:, SIDE] = 0.0 if thin else 1.0
    return np.ascontiguousarray(made[triangles.neighbours(made[:, :3])])


def placed(rows: Vector, place: Vector, turn: Vector) -> Vector:
    """Rows in a frame in which theirs lies at a place (3,) m, turned by (3, 3)."""
    there, rims = rows.copy(), rows[:, FORM] == RIM
    for first in (0, 4, 8, 11):
        there[:, first : first + 3] = rows[:, first : first + 3] @ turn.T
    there[:, :3] += place
    there[rims, 8:11] = rows[rims, 8:11]  # radii
    return there


def sides(rows: Vector) -> Vector:
    """Half the sides (n, 3) m of boxes around the centroids of facets as `rows` has them, along the axes of a frame."""
    a, b, form = rows[:, 8:11], rows[:, 11:14], rows[:, [FORM]]
    corners = np.max(np.abs([a, b, a + b]), axis=0)
    found = np.where(form == TRIANGLE, corners, np.abs(a) + np.abs(b))
    return np.asarray(np.where(form == RIM, rows[:, [3]], found))


def moved(facets: Facets, place: Vector, turn: Vector) -> Facets:
    """The same in a frame in which theirs lies at a place (3,) m, turned by (3, 3)."""
    at, normal, a, b = (v @ turn.T for v in (facets.place, facets.normal, facets.a, facets.b))
    return facets._replace(place=at + place, normal=normal, a=a, b=b)


# ---- surfaces of revolution about z ----


class Strip(NamedTuple):
    """Ring of a surface of revolution: points of its meridian (k,), with weights (m), and the edge around it (m).

    r, z: of the points (m); nr, nz: of the outward normal there; least: number of patches around; pole: whether it is
    one patch around a pole.
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
        """Mean of r (m)."""
        return float(self.r @ self.weight / self.weight.sum())


def line(start: tuple[float, float], end: tuple[float, float], size: Size) -> list[Strip]:
    """Strips of a straight meridian from r, z (m) to r, z, whose outside is to its right."""
    (r0, z0), (r1, z1) = start, end
    length = float(np.hypot(r1 - r0, z1 - z0))
    normal, flat, edge = ((z1 - z0) / length, (r0 - r1) / length), z0 == z1, size.edge
    least = 4 if flat else 4 * _count(0.5 * np.pi, size.turn)  # around a tip the surface turns as far as at its base
    _check(length, max(np.pi * (r0 + r1), least * edge), edge, edge)
    pieces, made = _pieces(0.0, 1.0, _count(length, edge), flat and r0 == 0.0, flat and r1 == 0.0), []
    for t, weight, pole in pieces:
        nr, nz = (np.full_like(t, one) for one in normal)
        made.append(Strip(r0 + (r1 - r0) * t, z0 + (z1 - z0) * t, nr, nz, weight * length, edge, least, pole))
    return made


def arc(radius: float, z: float, start: float, end: float, size: Size) -> list[Strip]:
    """Strips of a circular meridian about r = 0, z (m), between two elevations (rad)."""
    edge, length = size.around(radius), (end - start) * radius
    _check(length, 2.0 * length, edge, edge)
    pieces = _pieces(start, end, _count(length, edge), start == -0.5 * np.pi, end == 0.5 * np.pi)
    return [
        Strip(radius * np.cos(t), z + radius * np.sin(t), np.cos(t), np.sin(t), weight * radius, edge, pole=pole)
        for t, weight, pole in pieces
    ]


def _check(length: float, around: float, *edges: float) -> None:
    """Refuse strips of patches of which there would be too many: as long as a meridian and as a mean parallel (m)."""
    triangles.check_number(_count(length, edges[0]) * _count(around, edges[1]), min(edges), length * around)


def _count(length: float, edge: float) -> int:
    """Pieces of at most an edge that a length has; a bounded number, as there can be too many."""
    return max(1, int(np.ceil(min(length / edge - 1e-9, triangles.MOST_FACETS + 1.0))))


def _pieces(start: float, end: float, count: int, first: bool, last: bool) -> list[tuple[Vector, Vector, bool]]:
    """Points and weights of Gauss's rule in each piece of an interval, and whether it is a pole.

    first, last: whether there is a pole at its ends; there the piece is half as long, for one patch around it.
    """
    halves = 0.5 * first + 0.5 * last
    count = max(count, 2) + (halves == 1.0) if halves else count
    step, made = (end - start) / (count - halves), []
    at = start + step * np.clip(np.arange(count + 1) - 0.5 * first, 0.0, count - halves)
    for i, (a, b) in enumerate(pairwise(at.tolist())):
        pole = (first and i == 0) or (last and i == count - 1)
        made.append((0.5 * (a + b) + 0.5 * (b - a) * POINTS, 0.5 * (b - a) * WEIGHTS, pole))
    return made


def revolved(strips: Sequence[Strip]) -> Facets:
    """Patches of a surface of revolution: of each strip one about the x axis, turned about z."""
    numbers = np.array([_patches(one) for one in strips])
    area = sum(2.0 * np.pi * float(one.r @ one.weight) for one in strips)
    triangles.check_number(int(numbers.sum()), min(one.edge for one in strips), area)
    half, around = (np.pi / numbers)[:, None, None], numbers[:, None, None] > 1
    phi = half * np.where(around, POINTS[:, None], np.array([-0.75, -0.25, 0.25, 0.75])[:, None])
    r, z, nr, nz, weight = (np.array([getattr(one, name) for one in strips])[:, None] for name in Strip._fields[:5])
    weights = half * np.where(around, WEIGHTS[:, None], 0.5) * weight * r
    place, normal = (
        np.stack([across * np.cos(phi), across * np.sin(phi), up + 0.0 * phi], axis=-1).reshape(len(strips), -1, 3)
        for across, up in ((r, z), (nr, nz))
    )
    along = np.column_stack([-nz.mean(axis=(1, 2)), np.zeros(len(strips)), nr.mean(axis=(1, 2))])
    first = of_points(place, normal, weights.reshape(len(strips), -1), along)
    of = np.repeat(np.arange(len(strips)), numbers)
    angle = np.pi / numbers[of] * (2.0 * (np.arange(len(of)) - np.repeat(np.cumsum(numbers) - numbers, numbers)) + 1.0)
    angle[numbers[of] == 1] = 0.0
    turn = np.zeros((len(of), 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1], turn[:, 2, 2] = -turn[:, 1, 0], 1.0
    all_of = first.taken(of)
    vectors = (np.einsum("nij,nj->ni", turn, v) for v in (all_of.place, all_of.normal, all_of.a, all_of.b))
    return all_of._replace(**dict(zip(("place", "normal", "a", "b"), vectors, strict=True)))


def _patches(strip: Strip) -> int:
    """Into how many patches a strip is cut: one at a pole, else a multiple of four."""
    return 1 if strip.pole else max(strip.least, 4 * _count(0.5 * np.pi * strip.radius, strip.edge))


def of_points(place: Vector, normal: Vector, weight: Vector, along: Vector) -> Facets:
    """Patches of points (n, k, 3) m with normals there and weights (n, k) m2, one edge of which goes along (n, 3)."""
    area = weight.sum(axis=1)
    centre = (weight[:, :, None] * place).sum(axis=1) / area[:, None]
    mean = (weight[:, :, None] * normal).sum(axis=1)
    length = np.linalg.norm(mean, axis=1)
    mean /= length[:, None]
    first = along - np.sum(along * mean, axis=1)[:, None] * mean
    first /= np.linalg.norm(first, axis=1)[:, None]
    arms, edges, curve = place - centre[:, None], [], []
    for e in (first, np.asarray(np.cross(mean, first))):
        far, turned = (np.einsum("nkj,nj->nk", v, e) for v in (arms, normal))
        square = np.sum(weight * far**2, axis=1) / area
        edges.append(np.sqrt(3.0 * square)[:, None] * e)
        curve.append(np.sum(weight * far * turned, axis=1) / length / square)
    curves = np.stack(curve, axis=1)
    extent = np.sqrt(area)[:, None]
    curves[np.abs(curves) * extent < 1e-9] = 0.0  # round-off of flat ones
    a, b = edges
    return Facets(centre, mean, area, a, b, np.full(len(area), PATCH), curves)
