"""Runs on the bodies of an Exudyn system: which bodies can carry them, and whether a shape has a size."""

from __future__ import annotations

from collections.abc import Sequence
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import scene_error
from granular_contact.kernels import kinematics, spatial
from granular_contact.media.kinds import Kind
from granular_contact.multibody.runs import Run
from granular_contact.polygon import crossing, doubled_area, extent

Vector = NDArray[np.float64]

# Most elements in one run: a long beam is cheaper in pieces, of which only those near the surface are evaluated.
ELEMENTS_PER_RUN = 12
OUT_OF_PLANE = 1e-6  # sine of an angle, or m/s and 1/s: round-off of what a script computes


def section(where: str, diameter: float | None, width: float | None) -> tuple[Kind, dict[str, Any]]:
    """Kind of a thin line and its run's width, from exactly one of the two sizes (m)."""
    if (diameter is None) == (width is None):
        raise scene_error(
            where, "give diameter or width" if width is None else "got both diameter and width; one is allowed"
        )
    kind: Kind = "flat" if diameter is None else "round"
    name, size = ("width", width) if diameter is None else ("diameter", diameter)
    return kind, {"width": positive(where, name, size)}


def positive(where: str, name: str, size: float | None) -> float:
    """The size, which must be a finite number above 0."""
    if size is None or not (np.isfinite(size) and size > 0.0):
        raise scene_error(where, f"{name}: got {size}, allowed is a number above 0 (m)")
    return float(size)


def count(where: str, name: str, number: Any) -> int:
    """The number, which must be whole and at least 1."""
    if not isinstance(number, Integral) or number < 1:
        raise scene_error(where, f"{name}: got {number}, allowed is a whole number from 1")
    return int(number)


def planar(where: str, points: ArrayLike) -> Vector:
    """Points (k, 2) m in the plane of motion; a third coordinate must be 0."""
    given = np.atleast_2d(np.asarray(points, float))
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise scene_error(where, f"got points of the shape {given.shape}, allowed is (k, 2)")
    if given[:, 2:].any():
        raise scene_error(
            where, f"got z = {given[given[:, 2] != 0.0][0, 2]:g} m, allowed are points in the plane z = 0"
        )
    if not np.isfinite(given).all():
        raise scene_error(where, "a point is not finite")
    return given[:, :2]


def line_runs(
    where: str,
    mbs: Any,
    body: Any,
    points: ArrayLike,
    turns: ArrayLike | None,
    kind: Kind,
    strips: int,
    flags: dict[str, Any],
) -> list[Run]:
    """Runs along the polyline points (k, 2) m, fixed to a rigid body; of its sides some may be arcs, see `turns`."""
    line = _points(where, points, 2)
    bends = _turns(where, turns, len(line) - 1)
    divided = kinematics.curved_stations(line, bends, count(where, "strips", strips))
    runs = [_rigid_run(where, mbs, body, stations, kind, flags | {"turn": turn}) for stations, turn in divided]
    for run in runs[:-1]:
        run.run["cap"] = False
    return runs


def outline_runs(
    where: str, mbs: Any, body: Any, points: ArrayLike, turns: ArrayLike | None, strips: int, flags: dict[str, Any]
) -> list[Run]:
    """Runs around the closed polygon points (k, 2) m, fixed to a rigid body; the first corner need not be repeated."""
    corners = _points(where, points, 3)
    if not np.array_equal(corners[0], corners[-1]):
        corners = np.vstack([corners, corners[:1]])
    outline = [(float(x), float(y)) for x, y in corners[:-1]]
    area = doubled_area(outline)
    if abs(area) < 2e-13 * extent(outline) ** 2:
        raise scene_error(where, "the outline encloses no area")
    if pair := crossing(outline):
        raise scene_error(where, f"the sides after points {pair[0] + 1} and {pair[1] + 1} cross; sides may only meet")
    # The interior of a counter-clockwise polygon lies to the left, so its outward normal to the right.
    sided = {**flags, "side": -1.0 if area > 0.0 else 1.0}
    return line_runs(where, mbs, body, corners, turns, "outline", strips, sided)


def ball_run(where: str, mbs: Any, body: Any, center: ArrayLike, diameter: float, mass: float | None) -> Run:
    """Run of a ball that is fixed to a rigid body; its own mass (kg) is that of the body where None."""
    size = positive(where, "diameter", diameter)
    run = _rigid_run(
        where,
        mbs,
        body,
        kinematics.ball_stations(planar(where, center)[0]),
        "ball",
        {"width": size, "drop": 0.5 * size},
    )
    own = mbs.GetObject(body)["mass"] if mass is None else mass
    if not (np.isfinite(own) and own > 0.0):
        raise scene_error(where, f"mass: got {own}, allowed is a number above 0 (kg)")
    run.run["mass"] = own
    return run


def _turns(where: str, turns: ArrayLike | None, sides: int) -> Vector:
    """Turning angle (rad) of each side, less than half a turn."""
    given = np.zeros(sides) if turns is None else np.asarray(turns, float)
    if given.shape != (sides,):
        raise scene_error(where, f"turns: got the shape {given.shape}, allowed is one angle for each side, ({sides},)")
    if not (np.abs(given) < np.pi).all():
        raise scene_error(where, f"turns: got {given.tolist()}, allowed are angles below half a turn (rad)")
    return given


def _points(where: str, points: ArrayLike, least: int) -> Vector:
    line = planar(where, points)
    if len(line) < least:
        raise scene_error(where, f"got {len(line)} points, allowed are at least {least}")
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    if not steps.all():
        i = int(np.argmin(steps))
        raise scene_error(where, f"points {i} and {i + 1} are the same, {line[i].tolist()}")
    return line


def _rigid_run(where: str, mbs: Any, body: Any, geometry: NDArray[np.void], kind: Kind, flags: dict[str, Any]) -> Run:
    item = mbs.GetObject(body)
    if item["objectType"] == "RigidBody2D":
        size = 3
    elif item["objectType"] == "RigidBody":
        node = mbs.GetNode(item["nodeNumber"])["nodeType"]
        if node != "RigidBodyEP":
            raise scene_error(where, f"the node of {item['name']} is a {node}, allowed is RigidBodyEP")
        _stays_in_plane(where, item["name"], mbs.GetNode(item["nodeNumber"]))
        geometry, size = spatial.spatial_stations(geometry), spatial.SIZE
    else:
        allowed = "allowed are RigidBody2D and RigidBody"
        raise scene_error(where, f"object {item['name']} is a {item['objectType']}, {allowed}")
    run = Run([item["nodeNumber"]], size, geometry, kind, flags)
    run.body = item["name"]
    return run


def _stays_in_plane(where: str, name: str, node: Any) -> None:
    """Refuse a spatial body whose frame leans out of the plane at the start, or begins to."""
    e = np.add(node["referenceCoordinates"], node["initialCoordinates"])[3:]
    leaning = 2.0 * float(np.hypot(e[1], e[2]) * np.hypot(e[0], e[3]))  # sine of the angle between its z axis and ours
    upright = np.hypot(e[1], e[2]) < np.hypot(e[0], e[3])  # or upside down
    rates = np.abs(np.asarray(node["initialVelocities"])[[2, 4, 5] if upright else [2, 3, 6]])
    if leaning > OUT_OF_PLANE or rates.max() > OUT_OF_PLANE:
        raise scene_error(where, f"{name} does not move in the x-y plane: its z axis leans or it has a speed out of it")


def cable_run(where: str, mbs: Any, elements: Sequence[Any], kind: Kind, strips: int, flags: dict[str, Any]) -> Run:
    """Run on consecutive ANCFCable2D elements, `strips` strips in each."""
    nodes: list[int] = []
    lengths = []
    each = count(where, "strips_per_element", strips)
    for element in elements:
        item = mbs.GetObject(element)
        if item["objectType"] != "ANCFCable2D":
            raise scene_error(where, f"object {item['name']} is a {item['objectType']}, allowed is ANCFCable2D")
        first, second = (int(node) for node in item["nodeNumbers"])
        if nodes and nodes[-1] != first:
            raise scene_error(where, f"{item['name']} does not start at the node where its neighbour ends")
        nodes += [second] if nodes else [first, second]
        lengths.append(item["length"])
    run = Run(nodes, 4 * len(nodes), kinematics.cable_stations(np.array(lengths), each), kind, flags)
    run.body = mbs.GetObject(elements[0])["name"]
    return run
