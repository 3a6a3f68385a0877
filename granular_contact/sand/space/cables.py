"""Straight pieces of the skin of beams of an engine in space, each on a body; see `engines.exudyn.beams`."""

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
from granular_contact.sand.space.load import SpatialLoad, element_kinds
from granular_contact.sand.space.shapes import Bar

Vector = NDArray[np.float64]


class CablePiece(NamedTuple):
    """Piece of a cubic element, as the kernels compute its motion.

    Parameters
    ----------
    shape : tuple of float
        (8,): the four Hermite polynomials at its middle, then their derivatives by the length (1/m).
    axis : tuple of float
        Direction (3,) of the element there in the reference configuration, in which the frame of the piece is that of
        the world.
    """

    shape: tuple[float, ...]
    axis: tuple[float, ...]


class Piece(NamedTuple):
    """Straight piece of a beam in the frame of a body.

    Parameters
    ----------
    body : Body
        The body.
    start, end : (3,) array
        Ends (m).
    across : (3,) array
        Direction of the first side of a rectangular section; zero if the direction does not matter.
    """

    body: Body
    start: Vector
    end: Vector
    across: Vector


def cubic(
    name: str, nodes: NDArray[np.int64], reference: Vector, lengths: Sequence[float], strips: int
) -> Iterator[Piece]:
    """Pieces of a beam of cubic elements. Their places have an error of the curvature times the square of their length.

    Parameters
    ----------
    name : str
        Name of the beam.
    nodes : (k + 1, 6) array
        Places of position and slope of each node among the coordinates of the bed.
    reference : (k + 1, 6) array
        Reference values of these coordinates.
    lengths : (k,) sequence
        Lengths of the elements (m).
    strips : int
        Number of pieces of an element.

    Yields
    ------
    Piece
    """
    middles = (np.arange(strips) + 0.5) / strips
    for e, length in enumerate(lengths):
        half = 0.5 * length / strips
        for shape in np.hstack([hermite(middles, length), _slopes(middles, length)]):
            axis = shape[4:] @ reference[e : e + 2].reshape(4, 3)
            axis /= np.linalg.norm(axis)
            body = Body(name, np.ravel(nodes[e : e + 2]), CablePiece(tuple(shape.tolist()), tuple(axis.tolist())))
            yield Piece(body, -half * axis, half * axis, np.zeros(3))


def _slopes(xi: Vector, length: float) -> Vector:
    """Derivatives (n, 4) of `hermite` by the length along an element (m)."""
    six = 6.0 * (xi - xi**2) / length
    return np.stack([-six, 1.0 - 4.0 * xi + 3.0 * xi**2, six, 3.0 * xi**2 - 2.0 * xi], axis=-1)


def on_nodes(bodies: Sequence[Body], places: Vector, frames: Vector) -> Iterator[Piece]:
    """Pieces of a beam whose nodes are rigid bodies: half of each element next to a node.

    Parameters
    ----------
    bodies : sequence of Body
        The nodes.
    places : (k, 3) array
        Positions of the nodes (m) in the reference configuration.
    frames : (k, 3, 3) array
        Rotations of the nodes in the reference configuration; y is along a side of the section.

    Yields
    ------
    Piece
    """
    last = len(bodies) - 1
    for k, (body, place, frame) in enumerate(zip(bodies, places, frames, strict=True)):
        for i, j in ((k - 1, k), (k, k + 1)):
            if i >= 0 and j <= last:
                start, end = ((0.5 * (places[node] - place)) @ frame for node in (i, j))
                yield Piece(body, start, end, np.eye(3)[1])


def add(
    load: SpatialLoad, pieces: Iterable[Piece], sides: tuple[float, float] | float, strips: int, free_end: bool
) -> None:
    """Add a beam to a load: as a bar if the section is round and a medium takes bars, else as a surface.

    Parameters
    ----------
    load : SpatialLoad
        The load. It is changed.
    pieces : iterable of Piece
        Pieces of the beam in order.
    sides : tuple of float, or float
        Sides of a rectangular section, or the diameter of a round one (m).
    strips : int
        Number of strips of a piece.
    free_end : bool
        Whether the last end face is free.

    Warns
    -----
    UserWarning
        The beam is a bar, on which some media do not act.
    """
    row = list(pieces)
    bar = isinstance(sides, float) and any("bar" in element_kinds(medium) for medium in load.media)
    if bar:
        _warn_ignored(load.media, row[0].body.name)
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


def _warn_ignored(media: Sequence[Law], name: str) -> None:
    """Warn of media that do not act on a beam which is taken as a bar, by the name of the beam."""
    if ignored := [medium.name for medium in media if "bar" not in element_kinds(medium)]:
        of_bars = " and ".join(medium.name for medium in media if "bar" in element_kinds(medium))
        text = f"{name} is met as a bar, by {of_bars}: {' and '.join(ignored)} does not act on it"
        warnings.warn(text, stacklevel=6)  # points at the line of the script


def _frame(x: Vector, across: Vector) -> Vector:
    """Axes (3, 3) of a piece along the unit vector x.

    Its y axis is the one next to `across`, or any if that is zero.
    """
    if not across.any():
        across = np.eye(3)[int(np.argmin(np.abs(x)))]
    y = across - (across @ x) * x
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
