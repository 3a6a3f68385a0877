"""Rows of beam elements of an Exudyn system -> contact lines in the plane, or elements in space.

On cubic cables the polynomials of the element give the motion: of the stations of an `ANCFCable2D`, and of the straight
pieces of an `ANCFCable`. The nodes of a geometrically exact beam are rigid bodies; each node carries half of each
element beside it. The error in the position of such a half is of second order in the length of the element, as is that
of the element itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.bodies import NODES_IN_SPACE, named_object, refused
from granular_contact.errors import scene_error
from granular_contact.geometry import rotations
from granular_contact.sand.contact_lines import Body, ContactLine, beam, polyline
from granular_contact.sand.line_checks import count, positive
from granular_contact.sand.load import GranularLoad

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.overlay import Overlay

Vector = NDArray[np.float64]
# Number of coordinates of a node of each kind of element, in the plane and in space; None: it depends on the node.
IN_PLANE: dict[str, int | None] = {"ANCFCable2D": 4, "BeamGeometricallyExact2D": 3}
IN_SPACE: dict[str, int | None] = {"ANCFCable": 6, "BeamGeometricallyExact3D": None}


@dataclass(frozen=True)
class Row:
    """Elements of one kind, each of which starts at the end node of the previous one.

    kind: object type of the elements. name: that of the first element. nodes (k + 1,). lengths (k,): of the elements
    (m).
    """

    kind: str
    name: str
    nodes: tuple[int, ...]
    lengths: tuple[float, ...]


def row(mbs: Any, elements: Sequence[Any], allowed: dict[str, int | None]) -> Row:
    """Row of elements; allowed: kinds of elements that are allowed (its keys).

    Raises
    ------
    SceneError
        There is no element, an element is of a kind that is not allowed or differs from the first, an element has more
        than two nodes, or two neighbours share no node.
    """
    nodes: list[int] = []
    lengths, kinds = [], list(allowed)
    if not isinstance(elements, Iterable):
        raise scene_error("bed", f"got {elements!r}; allowed is a list of elements")
    for element in elements:
        item = named_object(mbs, element)
        name = item["name"]
        if item["objectType"] not in kinds:
            raise refused(item, f"allowed is {' or '.join(kinds)}")
        kinds = [item["objectType"]]
        ends = [int(node) for node in item["nodeNumbers"]]
        if len(ends) != 2:
            raise scene_error("bed", f"{name} has {len(ends)} nodes, allowed are 2")
        if nodes and nodes[-1] != ends[0]:
            raise scene_error("bed", f"{name} does not start at the node where its neighbour ends")
        nodes += ends[1:] if nodes else ends
        lengths.append(float(item["length"]))
    if not nodes:
        raise scene_error("bed", "got no elements; allowed is at least one")
    return Row(kinds[0], mbs.GetObject(elements[0])["name"], tuple(nodes), tuple(lengths))


def in_plane(
    row: Row, name: str, load: GranularLoad, overlay: Overlay, strips: int, free_end: bool, **size: Any
) -> list[ContactLine]:
    """Contact lines on a row in the plane, whose nodes are added to the overlay.

    name: of the beam in the history. strips: per element. size: its diameter or its width (m), see
    `contact_lines.polyline`.
    """
    if size.pop("section", None) is not None:
        raise scene_error("bed", "got section; allowed in the plane are diameter and width")
    places = overlay.coordinates(row.nodes, IN_PLANE[row.kind] or 0)
    if row.kind == "ANCFCable2D":
        single_line: dict[str, Any] = {"elements_per_line": len(row.lengths)} if load.resultant else {}
        return beam(name, places, row.lengths, strips_per_element=strips, free_end=free_end, **size, **single_line)
    if load.resultant:
        raise scene_error("bed", f"a resultant of a {row.kind} is not known; allowed is form 'distributed'")
    reference = np.array([overlay.mbs.GetNode(node)["referenceCoordinates"] for node in row.nodes])
    lines, arc_lengths, last = [], np.cumsum([0.0, *row.lengths]), len(row.nodes) - 1
    for k, (x, y, phi) in enumerate(reference):
        points = [0.5 * (reference[j, :2] + [x, y]) for j in (k - 1, k, k + 1) if 0 <= j <= last]
        c, s = np.cos(phi), np.sin(phi)
        local_points = (np.array(points) - [x, y]) @ [[c, -s], [s, c]]
        node_strips = max(1, count("strips_per_element", strips) // (1 if len(local_points) == 3 else 2))
        end = free_end and k == last
        for line in polyline(Body(name, places[k]), local_points, strips=node_strips, free_end=end, **size):
            line.record["place"] += arc_lengths[k] - np.linalg.norm(local_points[0])
            lines.append(line)
    return lines


def in_space(
    row: Row, name: str, load: GranularLoad, overlay: Overlay, strips: int, free_end: bool, **size: Any
) -> None:
    """Let a load in space act on a row, whose nodes are added to the overlay.

    name: of the beam in the history. strips: per element. size: its diameter, or the sides (m) of its section along y
    and z of its nodes.

    Raises
    ------
    SceneError
        No medium acts on such a beam, not exactly one size is given, or a node is of an unknown kind.
    """
    from granular_contact.sand.space import cables

    sides, element_strips = _sides(**size), count("strips_per_element", strips)
    nodes = [overlay.mbs.GetNode(node) for node in row.nodes]
    reference = [np.array(node["referenceCoordinates"], float) for node in nodes]
    if row.kind == "ANCFCable":
        if not isinstance(sides, float):
            raise scene_error("bed", "an ANCFCable has no frame of its section; allowed is a diameter")
        places = overlay.coordinates(row.nodes, 6)
        pieces = cables.cubic(name, places, np.array(reference), row.lengths, element_strips)
        cables.add(load, pieces, sides, 1, free_end)  # type: ignore[arg-type]
        return
    for node in nodes:
        if node["nodeType"] not in NODES_IN_SPACE:
            known = " and ".join(NODES_IN_SPACE)
            raise scene_error("bed", f"a node of {row.name} is a {node['nodeType']}, allowed are {known}")
    sizes = [NODES_IN_SPACE[node["nodeType"]] for node in nodes]
    bodies = [Body(name, overlay.coordinates([n], k)[0]) for n, k in zip(row.nodes, sizes, strict=True)]
    frames = np.array([_frame(coordinates[3:]) for coordinates in reference])
    pieces = cables.on_nodes(bodies, np.array([coordinates[:3] for coordinates in reference]), frames)
    cables.add(load, pieces, sides, max(1, element_strips // 2), free_end)  # type: ignore[arg-type]


def _sides(diameter: float | None, width: float | None, section: Any) -> tuple[float, float] | float:
    """Diameter (m), or the two sides of a section (m); exactly one of the two must be given."""
    if width is not None:
        raise scene_error("bed", "got width; allowed in space are diameter, or section=(y, z)")
    if (diameter is None) == (section is None):
        raise scene_error("bed", "give diameter or section, and one of the two")
    if section is None:
        return positive("diameter", diameter)
    if np.shape(section) != (2,):
        raise scene_error("bed", f"section: got {section}, allowed are two sides (m)")
    return positive("section", section[0]), positive("section", section[1])


def _frame(parameters: Vector) -> Vector:
    """Axes (3, 3) of a node, from four Euler parameters or three Tait-Bryan angles (rad) with R = R_x R_y R_z."""
    if len(parameters) == 4:
        return rotations.of_quaternion(parameters)
    axes: Vector = np.eye(3)
    for axis, angle in zip(np.eye(3), parameters, strict=True):
        axes = axes @ rotations.about(axis, angle)
    return axes
