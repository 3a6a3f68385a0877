"""Beams of an engine in space -> straight pieces of their skin, each on a body: see `engines.exudyn.beams`."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.laws.law import Law
from granular_contact.sand.contact_lines import Body
from granular_contact.sand.kernels.kinematics import hermite
from granular_contact.sand.space.beam_shape import Beam
from granular_contact.sand.space.load import SpatialLoad, kinds
from granular_contact.sand.space.shapes import Bar

Vector = NDArray[np.float64]


class CablePiece(NamedTuple):
    """Piece of a cubic element: Hermite polynomials and their derivatives (1/m) at its middle, direction there.

    shape (8,), axis (3,) in the reference configuration, where the frame of the piece is that of the world.
    """

    shape: tuple[float, ...]
    axis: tuple[float, ...]


class Piece(NamedTuple):
    """Straight piece of a beam from one point (3,) m in the frame of a body to another.

    across (3,): along the first side of its section, where that is no circle.
    """

    body: Body
    start: Vector
    end: Vector
    across: Vector


def cubic(
    name: str, nodes: NDArray[np.int64], reference: Vector, lengths: Sequence[float], strips: int
) -> Iterator[Piece]:
    """Pieces of cubic elements, so many of each; their place is off by curvature times the square of their length.

    nodes (k + 1, 6): places of position and slope of each node among the coordinates of the bed; reference (k + 1, 6):
    their values; lengths (k,) m.
    """
    at = (np.arange(strips) + 0.5) / strips
    for e, length in enumerate(lengths):
        half = 0.5 * length / strips
        for shape in np.hstack([hermite(at, length), _slopes(at, length)]):
            axis = shape[4:] @ reference[e : e + 2].reshape(4, 3)
            axis /= np.linalg.norm(axis)
            body = Body(name, np.ravel(nodes[e : e + 2]), CablePiece(tuple(shape.tolist()), tuple(axis.tolist())))
            yield Piece(body, -half * axis, half * axis, np.zeros(3))


def _slopes(xi: Vector, length: float) -> Vector:
    """Derivatives (n, 4) of `hermite` by the length along an element (m)."""
    six = 6.0 * (xi - xi**2) / length
    return np.stack([-six, 1.0 - 4.0 * xi + 3.0 * xi**2, six, 3.0 * xi**2 - 2.0 * xi], axis=-1)


def on_nodes(bodies: Sequence[Body], places: Vector, frames: Vector) -> Iterator[Piece]:
    """Pieces on nodes that are rigid bodies: half of each element beside a node.

    places (k, 3) m and frames (k, 3, 3) of the nodes in the reference configuration, along which y is a side.
    """
    last = len(bodies) - 1
    for k, (body, at, frame) in enumerate(zip(bodies, places, frames, strict=True)):
        for i, j in ((k - 1, k), (k, k + 1)):
            if i >= 0 and j <= last:
                start, end = ((0.5 * (places[one] - at)) @ frame for one in (i, j))
                yield Piece(body, start, end, np.eye(3)[1])


def add(
    load: SpatialLoad, pieces: Iterable[Piece], sides: tuple[float, float] | float, strips: int, free_end: bool
) -> None:
    """Let the media act on a beam: a bar if it is round and one takes bars, else its surface.

    sides: of a rectangular section (m), or its diameter; strips: of a piece; free_end: whether the last face is free.
    """
    row = list(pieces)
    bar = isinstance(sides, float) and any("bar" in kinds(medium) for medium in load.media)
    if bar:
        _tell_left_out(load.media, row[0].body.name)
    section = (sides, sides) if isinstance(sides, float) else sides
    for k, piece in enumerate(row):
        last = free_end and k == len(row) - 1
        if isinstance(sides, float) and bar:
            load.add_shape(piece.body, Bar([piece.start, piece.end], sides, strips, last))
            continue
        along = piece.end - piece.start
        length = float(np.linalg.norm(along))
        skin = Beam(length, section, isinstance(sides, float), (k == 0, last))
        size = max(length / strips, min(section))
        middle = 0.5 * (piece.start + piece.end)
        load.add_shape(piece.body, skin, middle, _frame(along / length, piece.across), facet_size=size)


def _tell_left_out(media: Sequence[Law], name: str) -> None:
    """Warn of media of surfaces beside one of bars, by the name of the beam."""
    if left := [medium.name for medium in media if "bar" not in kinds(medium)]:
        of_bars = " and ".join(medium.name for medium in media if "bar" in kinds(medium))
        words = f"{name} is met as a bar, by {of_bars}: {' and '.join(left)} does not act on it"
        warnings.warn(words, stacklevel=6)  # of the script


def _frame(x: Vector, across: Vector) -> Vector:
    """Axes (3, 3) of a piece along x, its y axis next to `across`, or anywhere if that is zero."""
    if not across.any():
        across = np.eye(3)[int(np.argmin(np.abs(x)))]
    y = across - (across @ x) * x
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
