"""Triangles: cutting to a size, rows of facets and the clusters that they are kept in."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from granular_contact.errors import SceneError, scene_error
from granular_contact.geometry.mesh import areas
from granular_contact.sand.kernels.facets import COLUMNS, SIDE
from granular_contact.sand.kernels.space_law import CLUSTER

Vector = NDArray[np.float64]
CLUSTER_SIZE = 64  # facets
# Of one bed, with what they cost [measured on boxes of 20 000 to 350 000 facets, with rft3d on one core].
MOST_FACETS = 1_000_000
COST = "0.7 GB of memory and 0.07 s in each evaluation of the forces"
PER_AREA = 60.0  # facets of a size on an area of its square, at most: of the fans of round ends; 10 of rectangles
FACET_SIZE = "facet_size"  # key of the fault of a size that makes more


def cut(corners: Vector, size: float) -> Vector:
    """Triangles (m, 3, 3) of edges of at most `size` (m), by halving the longest edge again and again.

    Raises
    ------
    SceneError
        There would be more than MOST_FACETS.
    """
    done: list[Vector] = []
    left, count = corners, 0
    while len(left):
        if count + len(left) > MOST_FACETS and size < np.inf:
            raise too_many(size, corners)
        edges = np.sum((np.roll(left, -1, axis=1) - left) ** 2, axis=2)
        longest = edges.argmax(axis=1)
        long = edges[np.arange(len(left)), longest] > size * size
        done.append(left[~long])
        count += len(done[-1])
        left, longest = left[long], longest[long]
        a, b, c = (left[np.arange(len(left)), (longest + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        left = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done) if done else corners


def too_many(size: float, corners: Vector) -> SceneError:
    """The error of facets of a size (m) on triangles (n, 3, 3) m, of which there would be more than MOST_FACETS."""
    area = float(np.linalg.norm(areas(corners), axis=1).sum())
    what, cure = (
        f"got {size:.3g} m, of which {area:.3g} m2",
        f"{math.sqrt(PER_AREA * area / MOST_FACETS):.2g} m will do",
    )
    if len(corners) > MOST_FACETS:
        what, cure = f"this surface of {len(corners):,} triangles", "take a coarser mesh"
    return scene_error(FACET_SIZE, f"{what} takes more than {MOST_FACETS:,} facets, {COST}; {cure}")


def facet_rows(corners: Vector, thin: bool) -> Vector:
    """Rows of `kernels.facets` for triangles (n, 3, 3) m in the frame of a body, neighbours beside each other."""
    cross = areas(corners)
    area = np.linalg.norm(cross, axis=1)
    centre = corners.mean(axis=1)
    arms = corners - centre[:, None]
    rows = np.zeros((len(corners), COLUMNS))
    rows[:, 0:3], rows[:, 4:7], rows[:, 7] = centre, cross / area[:, None], area
    rows[:, 3] = np.linalg.norm(arms, axis=2).max(axis=1)
    rows[:, 8:11], rows[:, 11:14] = arms[:, 0], arms[:, 1]
    rows[:, SIDE] = 0.0 if thin else 1.0
    return np.ascontiguousarray(rows[_neighbours(centre)])


def _neighbours(points: Vector) -> NDArray[np.int64]:
    """Order of points (n, 3) along a curve through cells of space (Morton's), in which neighbours stay together."""
    low = points.min(axis=0)
    cells = ((points - low) / max(1e-30, float((points - low).max())) * 1023).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable")


def clusters_of(places: Vector, reach: Vector | float, each: int = CLUSTER_SIZE) -> NDArray[np.void]:
    """Records of clusters of at most `each` rows at places (n, 3) m, each of which reaches so far around (m)."""
    starts = np.arange(0, len(places), each)
    made = np.zeros(len(starts), CLUSTER)
    made["first"], made["last"] = starts, np.append(starts[1:], len(places))
    reaches = np.broadcast_to(reach, len(places))
    for cluster in made:
        part = slice(cluster["first"], cluster["last"])
        around(cluster, places[part], reaches[part])
    return made


def around(record: np.void, places: Vector, reach: Vector) -> None:
    """Write a sphere around places (n, 3) m, which reach so far (n,) m, into a record with x, y, z and radius."""
    centre = 0.5 * (places.min(axis=0) + places.max(axis=0))
    record["x"], record["y"], record["z"] = centre
    record["radius"] = float((np.linalg.norm(places - centre, axis=1) + reach).max())
