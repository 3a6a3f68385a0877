"""Triangles: cutting to a size; order by neighbourhood, and the clusters that kernels treat together."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import SceneError, scene_error
from granular_contact.geometry.mesh import areas
from granular_contact.sand.kernels.space_law import CLUSTER

Vector = NDArray[np.float64]
Clusters = NDArray[np.void]
CLUSTER_SIZE = 64  # facets
# Greatest number of facets of a bed, and its cost [measured on boxes of 20 000 to 350 000 facets, rft3d, one core].
MOST_FACETS = 1_000_000
COST = "0.7 GB of memory and 0.07 s in each evaluation of the forces"
# Greatest number of facets of a size on an area of the square of the size: of triangles in the fans of round ends (in
# rectangles 10), and of parallelograms and patches of round surfaces.
PER_AREA, PATCHES = 60.0, 2.5
FACET_SIZE = "facet_size"  # key of the fault that there are too many


def cut(corners: Vector, size: float) -> Vector:
    """Cut triangles until no edge is longer than a size, by repeated bisection of the longest edge.

    Of edges of equal length, a half of a bisected edge comes first, then an edge that was there before, then the edge
    of the cut. So a triangle and its mirror image are cut as mirror images, unless the triangle has two longest edges.

    Parameters
    ----------
    corners : (n, 3, 3) array
        Corners (m).
    size : float
        Greatest edge (m).

    Returns
    -------
    (m, 3, 3) array
        Corners (m), in the sense of the triangles.

    Raises
    ------
    SceneError
        There would be more than MOST_FACETS.
    """
    finished: list[Vector] = []
    remaining, finished_count, rank = corners, 0, np.zeros((len(corners), 3))
    while len(remaining):
        if finished_count + len(remaining) > MOST_FACETS and size < np.inf:
            raise too_many(size, corners)
        edges = np.sum((remaining[:, [1, 2, 0]] - remaining) ** 2, axis=2)
        longest = (edges * (1.0 + 1e-9 * rank)).argmax(axis=1)
        too_long = edges[np.arange(len(remaining)), longest] > size * size
        finished.append(remaining[~too_long])
        finished_count += len(finished[-1])
        remaining, longest = remaining[too_long], longest[too_long]
        in_turn = (longest[:, None] + np.arange(3)) % 3
        a, b, c = remaining[np.arange(len(remaining))[:, None], in_turn].transpose(1, 0, 2)
        middle = 0.5 * (a + b)
        remaining = np.array([[a, middle, c], [middle, b, c]]).transpose(0, 2, 1, 3).reshape(-1, 3, 3)
        rank = np.repeat([[2.0, 0.0, 1.0], [2.0, 1.0, 0.0]], len(a), axis=0)
    return np.concatenate(finished) if finished else corners


def too_many(size: float, corners: Vector) -> SceneError:
    """Error of a size that would give more than MOST_FACETS facets.

    Parameters
    ----------
    size : float
        Greatest edge (m).
    corners : (n, 3, 3) array
        Triangles (m) that would be cut.
    """
    if len(corners) > MOST_FACETS:
        return _refused(f"this surface of {len(corners):,} triangles", "take a coarser mesh")
    return _refused_size(size, float(np.linalg.norm(areas(corners), axis=1).sum()), PER_AREA)


def check_number(number: float, size: float, area: float) -> None:
    """Refuse more than MOST_FACETS facets.

    Parameters
    ----------
    number : float
        Number of facets.
    size : float
        Their greatest edge (m).
    area : float
        Area of the surface (m2).

    Raises
    ------
    SceneError
        There are too many.
    """
    if number > MOST_FACETS:
        raise _refused_size(size, area, PATCHES)


def _refused_size(size: float, area: float, per_area: float) -> SceneError:
    allowed = math.sqrt(per_area * area / MOST_FACETS)
    return _refused(f"got {size:.3g} m, of which {area:.3g} m2", f"{allowed:.2g} m will do")


def _refused(what: str, cure: str) -> SceneError:
    return scene_error(FACET_SIZE, f"{what} takes more than {MOST_FACETS:,} facets, {COST}; {cure}")


def neighbours(points: Vector, each: int = CLUSTER_SIZE) -> NDArray[np.int64]:
    """Order of points in which each group of `each` consecutive points is close together.

    The points are halved repeatedly along the longest side of the box around them.

    Parameters
    ----------
    points : (n, 3) array
        Points.
    each : int
        Number of points in a group.

    Returns
    -------
    (n,) array of int
    """
    groups, waiting = [], [np.arange(len(points))]
    while waiting:
        part = waiting.pop()
        if len(part) <= each:
            groups.append(part)
            continue
        axis = int(np.ptp(points[part], axis=0).argmax())
        part = part[np.argsort(points[part, axis], kind="stable")]
        half = each * ((len(part) + each) // (2 * each))
        waiting += [part[half:], part[:half]]
    return np.concatenate(groups)


def clusters_of(places: Vector, reach: Vector | float, sides: Vector | float, each: int = CLUSTER_SIZE) -> Clusters:
    """Records of clusters of consecutive rows.

    Parameters
    ----------
    places : (n, 3) array
        Centres of the rows (m).
    reach : (n,) array or float
        Radius of a sphere around each row (m).
    sides : (n, 3) array or float
        Half sides of a box around each row (m).
    each : int
        Greatest number of rows of a cluster.

    Returns
    -------
    (clusters,) array
        Records of `kernels.space_law.CLUSTER`.
    """
    starts = np.arange(0, len(places), each)
    clusters = np.zeros(len(starts), CLUSTER)
    clusters["first"], clusters["last"] = starts, np.append(starts[1:], len(places))
    cluster = np.arange(len(places)) // each
    centre = 0.5 * (np.minimum.reduceat(places, starts) + np.maximum.reduceat(places, starts))
    arm = places - centre[cluster]
    clusters["x"], clusters["y"], clusters["z"] = centre.T
    clusters["radius"] = np.maximum.reduceat(np.linalg.norm(arm, axis=1) + reach, starts)
    clusters["along_x"], clusters["along_y"], clusters["along_z"] = np.maximum.reduceat(np.abs(arm) + sides, starts).T
    return clusters


def enclose(record: np.void, places: Vector, reach: Vector) -> Vector:
    """Write the enclosing sphere of spheres into a record with the fields x, y, z and radius.

    Parameters
    ----------
    record : record
        It is changed.
    places : (n, 3) array
        Centres (m).
    reach : (n,) array
        Radii (m).

    Returns
    -------
    (3,) array
        Centre of the enclosing sphere (m).
    """
    centre: Vector = 0.5 * (places.min(axis=0) + places.max(axis=0))
    record["x"], record["y"], record["z"] = centre
    record["radius"] = float((np.linalg.norm(places - centre, axis=1) + reach).max())
    return centre
