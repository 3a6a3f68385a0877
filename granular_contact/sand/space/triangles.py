"""Triangles: cutting to a size; neighbours, and the clusters that they are kept in."""

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
# Of one bed, with what they cost [measured on boxes of 20 000 to 350 000 facets, with rft3d on one core].
MOST_FACETS = 1_000_000
COST = "0.7 GB of memory and 0.07 s in each evaluation of the forces"
PER_AREA = 60.0  # triangles of a size on an area of its square, at most: of the fans of round ends; 10 of rectangles
PATCHES = 2.5  # the same of parallelograms and of patches of round surfaces
FACET_SIZE = "facet_size"  # key of the fault of a size that makes more


def cut(corners: Vector, size: float) -> Vector:
    """Triangles (m, 3, 3) of edges of at most `size` (m), by halving the longest edge again and again.

    Of edges as long as each other a half comes before what was there, and that before what cut: so the mirror image of
    a triangle is cut as its mirror image, unless it has two longest edges itself.

    Raises
    ------
    SceneError
        There would be more than MOST_FACETS.
    """
    done: list[Vector] = []
    left, count, rank = corners, 0, np.zeros((len(corners), 3))
    while len(left):
        if count + len(left) > MOST_FACETS and size < np.inf:
            raise too_many(size, corners)
        edges = np.sum((np.roll(left, -1, axis=1) - left) ** 2, axis=2)
        longest = (edges * (1.0 + 1e-9 * rank)).argmax(axis=1)
        long = edges[np.arange(len(left)), longest] > size * size
        done.append(left[~long])
        count += len(done[-1])
        left, longest = left[long], longest[long]
        a, b, c = (left[np.arange(len(left)), (longest + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        left = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        rank = np.repeat([[2.0, 0.0, 1.0], [2.0, 1.0, 0.0]], len(a), axis=0)
    return np.concatenate(done) if done else corners


def too_many(size: float, corners: Vector) -> SceneError:
    """The error of facets of a size (m) on triangles (n, 3, 3) m, of which there would be more than MOST_FACETS."""
    if len(corners) > MOST_FACETS:
        return _refused(f"this surface of {len(corners):,} triangles", "take a coarser mesh")
    return _refused_size(size, float(np.linalg.norm(areas(corners), axis=1).sum()), PER_AREA)


def check_number(number: float, size: float, area: float) -> None:
    """Raise the error of facets of a size (m) on an area (m2) if there are more of them than MOST_FACETS."""
    if number > MOST_FACETS:
        raise _refused_size(size, area, PATCHES)


def _refused_size(size: float, area: float, per_area: float) -> SceneError:
    allowed = math.sqrt(per_area * area / MOST_FACETS)
    return _refused(f"got {size:.3g} m, of which {area:.3g} m2", f"{allowed:.2g} m will do")


def _refused(what: str, cure: str) -> SceneError:
    return scene_error(FACET_SIZE, f"{what} takes more than {MOST_FACETS:,} facets, {COST}; {cure}")


def neighbours(points: Vector, each: int = CLUSTER_SIZE) -> NDArray[np.int64]:
    """Order of points (n, 3) in which every `each` from the first on are close together.

    By halves along the longest side of the box around them, again and again.
    """
    done, waiting = [], [np.arange(len(points))]
    while waiting:
        part = waiting.pop()
        if len(part) <= each:
            done.append(part)
            continue
        axis = int(np.ptp(points[part], axis=0).argmax())
        part = part[np.argsort(points[part, axis], kind="stable")]
        half = each * ((len(part) + each) // (2 * each))
        waiting += [part[half:], part[:half]]
    return np.concatenate(done)


def clusters_of(places: Vector, reach: Vector | float, sides: Vector | float, each: int = CLUSTER_SIZE) -> Clusters:
    """Records of clusters of at most `each` rows at places (n, 3) m.

    Each row reaches so far around (m), and as far as half the sides (n, 3) m of a box around it.
    """
    starts = np.arange(0, len(places), each)
    made = np.zeros(len(starts), CLUSTER)
    made["first"], made["last"] = starts, np.append(starts[1:], len(places))
    of = np.arange(len(places)) // each
    centre = 0.5 * (np.minimum.reduceat(places, starts) + np.maximum.reduceat(places, starts))
    off = places - centre[of]
    made["x"], made["y"], made["z"] = centre.T
    made["radius"] = np.maximum.reduceat(np.linalg.norm(off, axis=1) + reach, starts)
    made["along_x"], made["along_y"], made["along_z"] = np.maximum.reduceat(np.abs(off) + sides, starts).T
    return made


def around(record: np.void, places: Vector, reach: Vector) -> Vector:
    """Write a sphere around places (n, 3) m, which reach so far (n,) m, into a record with x, y, z and radius.

    Returns its centre (3,) m.
    """
    centre: Vector = 0.5 * (places.min(axis=0) + places.max(axis=0))
    record["x"], record["y"], record["z"] = centre
    record["radius"] = float((np.linalg.norm(places - centre, axis=1) + reach).max())
    return centre
