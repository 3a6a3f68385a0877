"""Rows of beam elements of an Exudyn system -> what a bed acts on.

Cubic cables move what lies on them by their polynomials: `ANCFCable2D` its stations, `ANCFCable` straight pieces. The
nodes of a geometrically exact beam are rigid bodies, each of which carries half of the elements beside it; the place of
that is of second order in the length of elements, as the element itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.bodies import NODES_IN_SPACE, refused
from granular_contact.errors import scene_error
from granular_contact.geometry import rotations
from granular_contact.sand.contact_lines import Body, ContactLine, beam, polyline
from granular_contact.sand.line_checks import count, positive
from granular_contact.sand.load import GranularLoad

if TYPE_CHECKING:
    from granular_contact.engines.exudyn.overlay import Overlay

Vector = NDArray[np.float64]
# Coordinates of a node of each kind, of those in the plane and in space; None: as the kind of node.
IN_PLANE: dict[str, int | None] = {"ANCFCable2D": 4, "BeamGeometricallyExact2D": 3}
IN_SPACE: dict[str, int | None] = {"ANCFCable": 6, "BeamGeometricallyExact3D": None}


@dataclass(frozen=True)
class Row:
    """Elements of one kind that follow one another; nodes (k + 1,), lengths (k,) m."""

    kind: str
    name: str
    nodes: tuple[int, ...]
    lengths: tuple[float, ...]


def row(mbs: Any, elements: Sequence[Any], allowed: dict[str, int | None]) -> Row:
    """The elements as a row.

    Raises
    ------
    SceneError
        There is no element, one is not of the kinds that are allowed or of another than the first, has more than two
        nodes, or two neighbours share no node.
    """
    nodes: list[int] = []
    lengths, kinds = [], list(allowed)
    for element in elements:
        item = mbs.GetObject(element)
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
    made: Row, name: str, load: GranularLoad, overlay: Overlay, strips: int, free_end: bool, **size: Any
) -> list[ContactLine]:
    """Lines on a row in the plane; size: its diameter or width (m), see `contact_lines.polyline`."""
    if size.pop("section", None) is not None:
        raise scene_error("bed", "got section; allowed in the plane are diameter and width")
    places = overlay.coordinates(made.nodes, IN_PLANE[made.kind] or 0)
    if made.kind == "ANCFCable2D":
        whole: dict[str, Any] = {"elements_per_line": len(made.lengths)} if load.resultant else {}
        return beam(name, places, made.lengths, strips_per_element=strips, free_end=free_end, **size, **whole)
    if load.resultant:
        raise scene_error("bed", f"a resultant of a {made.kind} is not known; allowed is form 'distributed'")
    reference = np.array([overlay.mbs.GetNode(node)["referenceCoordinates"] for node in made.nodes])
    lines, along, last = [], np.cumsum([0.0, *made.lengths]), len(made.nodes) - 1
    for k, (x, y, phi) in enumerate(reference):
        points = [0.5 * (reference[j, :2] + [x, y]) for j in (k - 1, k, k + 1) if 0 <= j <= last]
        c, s = np.cos(phi), np.sin(phi)
        own = (np.array(points) - [x, y]) @ [[c, -s], [s, c]]
        each = max(1, count("strips_per_element", strips) // (1 if len(own) == 3 else 2))
        end = free_end and k == last
        for line in polyline(Body(name, places[k]), own, strips=each, free_end=end, **size):
            line.record["place"] += along[k] - np.linalg.norm(own[0])
            lines.append(line)
    return lines


def in_space(
    made: Row, name: str, load: GranularLoad, overlay: Overlay, strips: int, free_end: bool, **size: Any
) -> None:
    """Let a load in space act on a row; size: its diameter, or the sides y and z (m) of its section.

    Raises
    ------
    SceneError
        Nothing acts on it, it has not one size, or a node is of a kind that is not known.
    """
    from granular_contact.sand.space import cables

    sides, each = _sides(**size), count("strips_per_element", strips)
    given = [overlay.mbs.GetNode(node) for node in made.nodes]
    reference = [np.array(node["referenceCoordinates"], float) for node in given]
    if made.kind == "ANCFCable":
        if not isinstance(sides, float):
            raise scene_error("bed", "an ANCFCable has no frame of its section; allowed is a diameter")
        places = overlay.coordinates(made.nodes, 6)
        pieces = cables.cubic(name, places, np.array(reference), made.lengths, each)
        cables.add(load, pieces, sides, 1, free_end)  # type: ignore[arg-type]
        return
    for node in given:
        if node["nodeType"] not in NODES_IN_SPACE:
            known = " and ".join(NODES_IN_SPACE)
            raise scene_error("bed", f"a node of {made.name} is a {node['nodeType']}, allowed are {known}")
    sizes = [NODES_IN_SPACE[node["nodeType"]] for node in given]
    bodies = [Body(name, overlay.coordinates([n], k)[0]) for n, k in zip(made.nodes, sizes, strict=True)]
    frames = np.array([_frame(one[3:]) for one in reference])
    pieces = cables.on_nodes(bodies, np.array([one[:3] for one in reference]), frames)
    cables.add(load, pieces, sides, max(1, each // 2), free_end)  # type: ignore[arg-type]


def _sides(diameter: float | None, width: float | None, section: Any) -> tuple[float, float] | float:
    """Diameter or the two sides of a section (m), of which one is given."""
    if width is not None:
        raise scene_error("bed", "got width; allowed in space are diameter, or section=(y, z)")
    if (diameter is None) == (section is None):
        raise scene_error("bed", "give diameter or section, and one of the two")
    if section is None:
        return positive("diameter", diameter)
    if np.shape(section) != (2,):
        raise scene_error("bed", f"section: got {section}, allowed are two sides (m)")
    return positive("section", section[0]), positive("section", section[1])


def _frame(turn: Vector) -> Vector:
    """Axes (3, 3) of a node, by four Euler parameters or three Tait-Bryan angles with R = R_x R_y R_z."""
    if len(turn) == 4:
        return rotations.of_quaternion(turn)
    found: Vector = np.eye(3)
    for axis, angle in zip(np.eye(3), turn, strict=True):
        found = found @ rotations.about(axis, angle)
    return found
