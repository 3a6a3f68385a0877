"""Shapes on bodies -> elements: rows and clusters that kernels read, in the frame of the body."""

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
    """Elements of one kind that a shape gives a body.

    meets: "surface", "bar" or "ball"; kind: what the media meet, by the word of the plane; rows (n, columns) of
    `kernels.facets`, `kernels.bars` or `kernels.space_balls`; clusters: records of `kernels.space_law`; size (m): of
    facets the least extent of the shape, else the diameter; again: whether the same shape has other elements before
    these, so that a floor, which meets any, passes them over.
    """

    body: Body
    meets: str
    kind: Kind
    rows: Vector
    clusters: NDArray[np.void]
    size: float
    again: bool = False


class Cut(NamedTuple):
    """A surface that is cut into facets, in the frame of its shape: rows as of `Elements`, corners (n, 3) m."""

    rows: Vector
    corners: Vector
    thin: bool


def cut(shape: Shape, size: float | None, accuracy: float | None = None, share: float = 1.0) -> Cut:
    """Facets of a shape, with edges of at most `size` (m).

    Unless that is given they are as small as the error of the motion that is allowed (of the way) needs; share: of that
    size, which is taken.
    """
    rows = facets.rows(shape.facets(size, accuracy, share), shape.rims(), shape.thin)
    return Cut(rows, shape.corners(np.inf).reshape(-1, 3), shape.thin)


def surface(body: Body, made: Cut, place: Vector, turn: Vector) -> Elements:
    """Facets of a shape at a place (3,) m, turned by (3, 3)."""
    rows = facets.placed(made.rows, place, turn)
    clusters = triangles.clusters_of(rows[:, :3], rows[:, 3], facets.sides(rows))
    least = float(np.ptp(made.corners @ turn.T, axis=0).min())
    return Elements(body, "surface", "flat" if made.thin else "outline", rows, clusters, least)


def bar(body: Body, shape: Bar, place: Vector, turn: Vector) -> Elements:
    """Strips along a bar."""
    rows = np.ascontiguousarray(shape.stations() @ turn.T + place)
    clusters = triangles.clusters_of(rows, 0.0, 0.0, len(rows))
    clusters["width"], clusters["cap"][-1] = shape.diameter, shape.free_end
    return Elements(body, "bar", "round", rows, clusters, shape.diameter)


def ball(body: Body, shape: Sphere, place: Vector, mass: float | None) -> Elements:
    """A sphere as a whole; mass: of the body, for a sphere without one of its own."""
    own = mass if shape.mass is None else shape.mass
    if own is None or not (np.isfinite(own) and own > 0.0):
        raise scene_error("Sphere", f"mass: got {own}, allowed is a number above 0 (kg)")
    clusters = triangles.clusters_of(place[None], 0.5 * shape.diameter, 0.5 * shape.diameter)
    clusters["width"], clusters["mass"] = shape.diameter, own
    return Elements(body, "ball", "ball", place[None].copy(), clusters, shape.diameter)


def turn_of(rotation: ArrayLike | None) -> Vector:
    """Rotation matrix (3, 3), checked to be one; none unless given."""
    if rotation is None:
        return np.eye(3)
    turn = np.asarray(rotation, float)
    if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-9) or np.linalg.det(turn) < 0.0:
        raise scene_error("bed", f"rotation: got {turn.tolist()}, allowed is a (3, 3) rotation matrix")
    return turn


def place_of(position: ArrayLike) -> Vector:
    """Position (3,) m of finite numbers."""
    place = np.asarray(position, float)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise scene_error("bed", f"position: got {np.asarray(position).tolist()}, allowed are three finite numbers (m)")
    return place
