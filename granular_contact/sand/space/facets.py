"""Facets of surfaces: triangles, parallelograms, and patches of round surfaces, by their moments.

A round surface is cut along its meridians and parallels. Each patch is a facet with the true area, centroid and mean
normal. It has half edges a, b along meridian and parallel, with the second moments (a a^T + b b^T) / 3 of the patch,
and two curvatures. So the error of the forces is of second order in the size of a patch. A shape with a symmetry has
facets with the same symmetry.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.mesh import areas
from granular_contact.geometry.rotations import vector_products
from granular_contact.sand.kernels.facet_records import COLUMNS, FACET, PARALLELOGRAM, PATCH, RIM, TRIANGLE
from granular_contact.sand.space import triangles

Vector = NDArray[np.float64]
FACET_ERROR = 3e-3  # allowed error of a motion by its facets, relative to the path, where no accuracy is given
# Facets for that error turn by ROUND (rad), and their edges are FLAT times the diagonal of the shape. The error grows
# with the squares of both [measured: 0.01 to 0.2 % on configs in space, 2 % where a ball rolls].
ROUND, FLAT = 0.12, 1.0 / 27.0
FINEST, COARSEST = 1e-4, 1e-2  # range of errors for which a size is chosen
MOST_TURN = np.pi / 6.0  # greatest turn (rad) of the surface within a facet whose edge is given


class Size(NamedTuple):
    """Limits of the size of facets.

    Parameters
    ----------
    edge : float
        Greatest edge (m).
    turn : float
        Greatest angle (rad) by which the surface turns within a facet.
    """

    edge: float
    turn: float = MOST_TURN

    def around(self, radius: float) -> float:
        """Greatest edge along a circle.

        Parameters
        ----------
        radius : float
            Radius (m).

        Returns
        -------
        float
            m.
        """
        return min(self.edge, self.turn * radius)


class Facets(NamedTuple):
    """Facets of a surface in a frame.

    Parameters
    ----------
    place : (n, 3) array
        Centroids (m).
    normal : (n, 3) array
        Unit normals, outward.
    area : (n,) array
        Areas (m2).
    a, b : (n, 3) array
        Of a triangle the vectors (m) from the centroid to two corners, the third being -a - b; else half edges (m).
    form : (n,) array of int
        Forms of `kernels.facet_records`.
    curve : (n, 2) array
        Curvatures (1/m): by how much the normal turns per length along a and along b.
    """

    place: Vector
    normal: Vector
    area: Vector
    a: Vector
    b: Vector
    form: NDArray[np.int64]
    curve: Vector

    def subset(self, which: NDArray[Any]) -> Facets:
        """Some of the facets.

        Parameters
        ----------
        which : array of bool or int
            A mask, or numbers of facets.
        """
        return Facets(*(np.asarray(column)[which] for column in self))


def size_for_accuracy(extent: float, accuracy: float | None, share: float = 1.0) -> Size:
    """Size of facets for an allowed error of the motion.

    Parameters
    ----------
    extent : float
        Diagonal of the shape (m).
    accuracy : float or None
        Allowed error of the motion, relative to the path; None: FACET_ERROR.
    share : float
        Factor of the size.
    """
    allowed = min(COARSEST, max(FINEST, FACET_ERROR if accuracy is None else accuracy))
    factor = share * float(np.sqrt(allowed / FACET_ERROR))
    return Size(FLAT * factor * extent, ROUND * factor)


def joined(parts: Sequence[Facets]) -> Facets:
    """All facets of several surfaces.

    Parameters
    ----------
    parts : sequence of Facets
        The surfaces.
    """
    return Facets(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def triangle_facets(corners: Vector) -> Facets:
    """Facets that are triangles.

    Parameters
    ----------
    corners : (n, 3, 3) array
        Corners (m), counter-clockwise seen from outside.
    """
    cross, place = areas(corners), corners.mean(axis=1)
    area, n = np.linalg.norm(cross, axis=1), len(corners)
    arms = corners - place[:, None]
    return Facets(place, cross / area[:, None], area, arms[:, 0], arms[:, 1], np.full(n, TRIANGLE), np.zeros((n, 2)))


def rectangle_facets(middle: Vector, a: Vector, b: Vector, size: Size) -> Facets:
    """Facets of a rectangle.

    Parameters
    ----------
    middle : (3,) array
        Centre (m).
    a, b : (3,) array
        Half edges (m); the normal is along a x b.
    size : Size
        Size of the facets.

    Raises
    ------
    SceneError
        There would be more than `triangles.MOST_FACETS`.
    """
    lengths = [2.0 * float(np.linalg.norm(edge)) for edge in (a, b)]
    counts = [piece_count(length, size.edge) for length in lengths]
    triangles.check_number(counts[0] * counts[1], size.edge, lengths[0] * lengths[1])
    u, v = ((2.0 * np.arange(count) + 1.0) / count - 1.0 for count in counts)
    place = middle + (u[:, None, None] * a + v[None, :, None] * b).reshape(-1, 3)
    normal = vector_products(a, b)
    return _equal_parallelograms(place, normal / np.linalg.norm(normal), a / counts[0], b / counts[1])


def _equal_parallelograms(place: Vector, normal: Vector, a: Vector, b: Vector) -> Facets:
    """Flat parallelograms with the same half edges a, b at several places."""
    n = len(place)
    area = np.full(n, 4.0 * float(np.linalg.norm(vector_products(a, b))))
    normals, first, second = (np.tile(vector, (n, 1)) for vector in (normal, a, b))
    return Facets(place, normals, area, first, second, np.full(n, PARALLELOGRAM), np.zeros((n, 2)))


def rim(z: float, *, circle: float = 0.0, ball: float = 0.0) -> Vector:
    """Rim of a round body: a circle around z, and spheres around its points. No point is deeper than the deepest rim.

    Parameters
    ----------
    z : float
        Height of the centre of the circle (m) in the frame of the shape.
    circle, ball : float
        Radii of the circle and of the sphere (m).

    Returns
    -------
    (8,) array
        Centre (m), axis, and both radii (m).
    """
    return np.array([0.0, 0.0, z, 0.0, 0.0, 1.0, circle, ball])


def facet_rows(facets: Facets, rims: Vector, thin: bool) -> Vector:
    """Rows of numbers that kernels read as records FACET, with neighbours next to each other.

    Parameters
    ----------
    facets : Facets
        The facets.
    rims : (k, 8) array
        Rims, see `rim`.
    thin : bool
        Whether either face can lead.

    Returns
    -------
    (n + k, columns) array
    """
    n, triangle = len(facets.area), facets.form == TRIANGLE
    third = np.where(triangle[:, None], -facets.a - facets.b, facets.a + facets.b)
    fourth = np.where(triangle[:, None], 0.0, facets.a - facets.b)
    records = np.zeros(n + len(rims), FACET)
    faces, edges = records[:n], records[n:]
    faces["centroid"], faces["normal"], faces["area"] = facets.place, facets.normal, facets.area
    faces["reach"] = np.max([np.linalg.norm(arm, axis=1) for arm in (facets.a, facets.b, third, fourth)], axis=0)
    faces["a"], faces["b"], faces["form"], faces["curvatures"] = facets.a, facets.b, facets.form, facets.curve
    edges["centroid"], edges["normal"], edges["a"][:, :2], edges["form"] = rims[:, :3], rims[:, 3:6], rims[:, 6:], RIM
    edges["reach"] = rims[:, 6:].sum(axis=1)
    records["side"] = 0.0 if thin else 1.0
    rows = records.view(float).reshape(-1, COLUMNS)
    return np.ascontiguousarray(rows[triangles.neighbours(records["centroid"])])


def as_facets(rows: Vector) -> NDArray[np.void]:
    """View of rows as records with named fields.

    Parameters
    ----------
    rows : (n, columns) array
        Rows as in `facet_rows`.

    Returns
    -------
    (n,) array
        Records of `kernels.facet_records.FACET`, which share the memory of the rows.
    """
    return np.asarray(rows.view(FACET)[:, 0])


def transformed_rows(rows: Vector, place: Vector, turn: Vector) -> Vector:
    """Rows in another frame.

    Parameters
    ----------
    rows : (n, columns) array
        Rows as in `facet_rows`.
    place : (3,) array
        Position (m) of their frame in the other.
    turn : (3, 3) array
        Rotation of their frame in the other.

    Returns
    -------
    (n, columns) array
    """
    moved = rows.copy()
    facets, old = as_facets(moved), as_facets(rows)
    rims = old["form"] == RIM
    for name in ("centroid", "normal", "a", "b"):
        facets[name] = old[name] @ turn.T
    facets["centroid"] += place
    facets["a"][rims] = old["a"][rims]  # radii
    return moved


def half_sides(rows: Vector) -> Vector:
    """Half sides of boxes around the centroids of facets, along the axes of the frame.

    Parameters
    ----------
    rows : (n, columns) array
        Rows as in `facet_rows`.

    Returns
    -------
    (n, 3) array
        Half sides (m).
    """
    facets = as_facets(rows)
    a, b, form = facets["a"], facets["b"], facets["form"][:, None]
    corners = np.max(np.abs([a, b, a + b]), axis=0)
    half = np.where(form == TRIANGLE, corners, np.abs(a) + np.abs(b))
    return np.asarray(np.where(form == RIM, facets["reach"][:, None], half))


def transformed(facets: Facets, place: Vector, turn: Vector) -> Facets:
    """Facets in another frame; arguments as in `transformed_rows`.

    Parameters
    ----------
    facets : Facets
        The facets.
    place : (3,) array
        Position (m) of their frame in the other.
    turn : (3, 3) array
        Rotation of their frame in the other.
    """
    position, normal, a, b = (v @ turn.T for v in (facets.place, facets.normal, facets.a, facets.b))
    return facets._replace(place=position + place, normal=normal, a=a, b=b)


def piece_count(length: float, edge: float) -> int:
    """Number of equal pieces of a length. It is bounded, as there can be far too many.

    Parameters
    ----------
    length : float
        Length (m).
    edge : float
        Greatest length of a piece (m).

    Returns
    -------
    int
        At least 1.
    """
    return max(1, int(np.ceil(min(length / edge - 1e-9, triangles.MOST_FACETS + 1.0))))


def patch_facets(place: Vector, normal: Vector, weight: Vector, along: Vector) -> Facets:
    """Patches from quadrature points on them.

    Parameters
    ----------
    place : (n, k, 3) array
        Points (m) of each patch.
    normal : (n, k, 3) array
        Unit normals at the points.
    weight : (n, k) array
        Weights of the points (m2).
    along : (n, 3) array
        Direction of the first half edge.
    """
    area = weight.sum(axis=1)
    centre = (weight[:, :, None] * place).sum(axis=1) / area[:, None]
    mean = (weight[:, :, None] * normal).sum(axis=1)
    length = np.linalg.norm(mean, axis=1)
    mean /= length[:, None]
    first = along - np.sum(along * mean, axis=1)[:, None] * mean
    first /= np.linalg.norm(first, axis=1)[:, None]
    arms, half_edges, curvatures = place - centre[:, None], [], []
    for direction in (first, np.asarray(vector_products(mean, first))):
        arm_along, normal_along = (np.einsum("nkj,nj->nk", v, direction) for v in (arms, normal))
        square = np.sum(weight * arm_along**2, axis=1) / area
        half_edges.append(np.sqrt(3.0 * square)[:, None] * direction)
        curvatures.append(np.sum(weight * arm_along * normal_along, axis=1) / length / square)
    curve = np.stack(curvatures, axis=1)
    extent = np.sqrt(area)[:, None]
    curve[np.abs(curve) * extent < 1e-9] = 0.0  # round-off of flat patches
    a, b = half_edges
    return Facets(centre, mean, area, a, b, np.full(len(area), PATCH), curve)
