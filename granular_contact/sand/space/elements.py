"""Elements of shapes on bodies: rows and clusters that the kernels read, in the frame of the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.laws.kinds import Kind
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.space import facets, triangles
from granular_contact.sand.space.round_shapes import Sphere
from granular_contact.sand.space.shapes import Bar, Shape

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Elements:
    """Elements of one kind that represent a shape on a body.

    Parameters
    ----------
    body : Body
        The body.
    element_kind : {"surface", "bar", "ball"}
        Kind of the elements.
    kind : str
        Kind of shape in the plane, one of `laws.kinds.Kind`.
    rows : (n, columns) array
        Rows of `kernels.facet_records`, `kernels.bars` or `kernels.space_balls`.
    clusters : (clusters,) array
        Records of `kernels.space_law.CLUSTER`.
    size : float
        Least extent of a surface, or diameter of a bar or ball (m).
    duplicate : bool
        Whether the shape also has earlier elements of another kind. The floor acts on any kind, so it skips duplicates.
    """

    body: Body
    element_kind: str
    kind: Kind
    rows: Vector
    clusters: NDArray[np.void]
    size: float
    duplicate: bool = False


class CutSurface(NamedTuple):
    """Surface cut into facets, in the frame of its shape.

    Parameters
    ----------
    rows : (n, columns) array
        Rows as in `facets.facet_rows`.
    corners : (n, 3) array
        Corners of the uncut surface (m).
    thin : bool
        Whether it is a sheet, of which either face can lead.
    """

    rows: Vector
    corners: Vector
    thin: bool


def cut_surface(shape: Shape, size: float | None, accuracy: float | None = None, share: float = 1.0) -> CutSurface:
    """Cut a shape into facets.

    Parameters
    ----------
    shape : Shape
        The shape.
    size : float or None
        Greatest edge (m); None: as small as `accuracy` needs.
    accuracy : float, optional
        Allowed error of the motion, relative to the path.
    share : float
        Factor of the edge.
    """
    rows = facets.facet_rows(shape.facets(size, accuracy, share), shape.rims(), shape.thin)
    return CutSurface(rows, shape.corners(np.inf).reshape(-1, 3), shape.thin)


def surface(body: Body, cut: CutSurface, place: Vector, turn: Vector) -> Elements:
    """Facets of a shape on a body.

    Parameters
    ----------
    body : Body
        The body.
    cut : CutSurface
        Facets in the frame of the shape.
    place : (3,) array
        Position of the shape (m) in the frame of the body.
    turn : (3, 3) array
        Rotation of the shape.
    """
    rows = facets.transformed_rows(cut.rows, place, turn)
    clusters = triangles.clusters_of(rows[:, :3], rows[:, 3], facets.half_sides(rows))
    least = float(np.ptp(cut.corners @ turn.T, axis=0).min())
    return Elements(body, "surface", "flat" if cut.thin else "outline", rows, clusters, least)


def bar(body: Body, shape: Bar, place: Vector, turn: Vector) -> Elements:
    """Strips along a bar; arguments as in `surface`."""
    rows = np.ascontiguousarray(shape.stations() @ turn.T + place)
    clusters = triangles.clusters_of(rows, 0.0, 0.0, len(rows))
    clusters["width"], clusters["cap"][-1] = shape.diameter, shape.free_end
    return Elements(body, "bar", "round", rows, clusters, shape.diameter)


def ball(body: Body, shape: Sphere, place: Vector, mass: float | None) -> Elements:
    """A sphere as a whole.

    Parameters
    ----------
    body : Body
        The body.
    shape : Sphere
        The sphere.
    place : (3,) array
        Its centre (m) in the frame of the body.
    mass : float or None
        Mass of the body (kg), for a sphere without a mass of its own.

    Raises
    ------
    SceneError
        The mass is not above 0.
    """
    sphere_mass = mass if shape.mass is None else shape.mass
    if sphere_mass is None or not (np.isfinite(sphere_mass) and sphere_mass > 0.0):
        raise scene_error("Sphere", f"mass: got {sphere_mass}, allowed is a number above 0 (kg)")
    clusters = triangles.clusters_of(place[None], 0.5 * shape.diameter, 0.5 * shape.diameter)
    clusters["width"], clusters["mass"] = shape.diameter, sphere_mass
    return Elements(body, "ball", "ball", place[None].copy(), clusters, shape.diameter)


def rotation_matrix(rotation: ArrayLike | None) -> Vector:
    """Rotation matrix of an argument, checked.

    Parameters
    ----------
    rotation : (3, 3) array or None
        The argument; None: no rotation.

    Returns
    -------
    (3, 3) array

    Raises
    ------
    SceneError
        It is not a rotation matrix.
    """
    if rotation is None:
        return np.eye(3)
    turn = np.asarray(rotation, float)
    if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-9) or np.linalg.det(turn) < 0.0:
        raise scene_error("bed", f"rotation: got {turn.tolist()}, allowed is a (3, 3) rotation matrix")
    return turn


def position_vector(position: ArrayLike) -> Vector:
    """Position of an argument, checked.

    Parameters
    ----------
    position : (3,) array
        The argument (m).

    Returns
    -------
    (3,) array

    Raises
    ------
    SceneError
        It is not three finite numbers.
    """
    place = np.asarray(position, float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise scene_error("bed", f"position: got {np.asarray(position).tolist()}, allowed are three finite numbers (m)")
    return place
