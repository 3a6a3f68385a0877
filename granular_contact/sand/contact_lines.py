"""Contact lines of shapes in the plane: stations along the boundary on which the medium acts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.geometry.polygon import crossing, doubled_area, extent
from granular_contact.laws.kinds import Kind
from granular_contact.sand.kernels import kinematics, spatial
from granular_contact.sand.kernels.law import LINE
from granular_contact.sand.line_checks import corner_points, count, fault, planar, positive, section, turning_angles

if TYPE_CHECKING:
    from granular_contact.sand.space.cables import CablePiece

Vector = NDArray[np.float64]

# Greatest number of elements of a line. Several lines of a long beam are cheaper: those far above the sand are skipped.
ELEMENTS_PER_LINE = 12


@dataclass(frozen=True)
class Body:
    """A rigid body, or a piece of a beam, and the places of its coordinates among those of the bed.

    Parameters
    ----------
    name : str
        Name under which the wrench of the medium on the body is recorded.
    coordinates : sequence of int
        Places of x, y (m) and the angle (rad, counter-clockwise); in space of x, y, z (m) and four Euler parameters, or
        three angles (rad). Of a beam the places of the coordinates of its nodes.
    piece : CablePiece, optional
        Piece of a cubic cable element in space.
    """

    name: str
    coordinates: Sequence[int] | NDArray[np.int64]
    piece: CablePiece | None = None

    @property
    def identity(self) -> tuple[Any, ...]:
        """Identity of the body, equal for all shapes on it. Several bodies may have one name."""
        return self.name, tuple(self.coordinates), self.piece


@dataclass(frozen=True)
class ContactLine:
    """Stations along a line on one body. Between them the medium acts on straight or round strips.

    Parameters
    ----------
    body : Body
        The body.
    stations : (n,) array
        Records of `kernels.kinematics`; their kind says how the coordinates of the body move them.
    kind : str
        Kind of shape, by which media act on it: one of `laws.kinds.Kind`.
    record : (1,) array
        Record of `kernels.law.LINE`.
    """

    body: Body
    stations: NDArray[np.void]
    kind: Kind
    record: NDArray[np.void]


def polyline(
    body: Body,
    points: ArrayLike,
    *,
    diameter: float | None = None,
    width: float | None = None,
    turns: ArrayLike | None = None,
    strips: int = 16,
    split: int = 1,
    free_end: bool = True,
) -> list[ContactLine]:
    """Contact lines along a thin round bar or a thin plate. Either `diameter` or `width` is given.

    Parameters
    ----------
    body : Body
        The body.
    points : (k, 2) array
        Corners of the line (m) in the frame of the body, k >= 2.
    diameter : float, optional
        Diameter of the bar (m).
    width : float, optional
        Width of the plate normal to the plane (m).
    turns : (k - 1,) array, optional
        Angle (rad, counter-clockwise) by which each side turns: a side that turns is the chord of an arc.
    strips : int
        Approximate number of strips on the whole line.
    split : int
        Number of parts into which each strip is divided.
    free_end : bool
        Whether the face at the last point is free.

    Returns
    -------
    list of ContactLine
        One line for each run of sides whose strips turn by the same angle.

    Raises
    ------
    SceneError
        The line has no length, no width or no strips, or is not in the plane.
    """
    kind, size = section(diameter, width)
    lines = _lines_along(body, corner_points(points, 2), turns, strips, split, kind, {"width": size})
    lines[-1].record["cap"] = free_end
    return lines


def outline(
    body: Body,
    points: ArrayLike,
    width: float,
    *,
    turns: ArrayLike | None = None,
    strips: int = 32,
    split: int = 1,
    wheel: tuple[ArrayLike, float] | None = None,
) -> list[ContactLine]:
    """Contact lines around a solid whose section is a polygon.

    Parameters
    ----------
    body : Body
        The body.
    points : (k, 2) array
        Corners (m) in the frame of the body, in either sense. The first corner need not be repeated.
    width : float
        Width normal to the plane (m).
    turns : array, optional
        Angle (rad, counter-clockwise) by which each side turns, for all sides.
    strips, split : int
        As in `polyline`.
    wheel : tuple, optional
        Axle (2,) m and radius (m) of a wheel.

    Raises
    ------
    SceneError
        The outline encloses no area, or its sides cross; or as in `polyline`.
    """
    size, corners = positive("width", width), corner_points(points, 3)
    if not np.array_equal(corners[0], corners[-1]):
        corners = np.vstack([corners, corners[:1]])
    sides = [(float(x), float(y)) for x, y in corners[:-1]]
    area = doubled_area(sides)
    if abs(area) < 2e-13 * extent(sides) ** 2:
        raise fault("the outline encloses no area")
    if pair := crossing(sides):
        raise fault(f"the sides after points {pair[0] + 1} and {pair[1] + 1} cross; sides may only meet")
    # The interior of a counter-clockwise polygon lies to the left, so its outward normal to the right.
    side = -1.0 if area > 0.0 else 1.0
    lines = _lines_along(body, corners, turns, strips, split, "outline", {"width": size, "side": side})
    if wheel is not None:
        for line in lines:
            _write_axle(line, planar(wheel[0])[0], positive("wheel", wheel[1]))
    return lines


def ball(body: Body, center: ArrayLike, diameter: float, mass: float) -> list[ContactLine]:
    """Contact line of a sphere.

    Parameters
    ----------
    body : Body
        The body.
    center : (2,) array
        Centre (m) in the frame of the body.
    diameter : float
        Diameter (m).
    mass : float
        Mass of the sphere itself (kg).

    Returns
    -------
    list of ContactLine
        A single line.

    Raises
    ------
    SceneError
        A size or the mass is not above 0, or the centre is not in the plane.
    """
    size = positive("diameter", diameter)
    stations = kinematics.ball_stations(planar(center)[0])
    if not (np.isfinite(mass) and mass > 0.0):
        raise fault(f"mass: got {mass}, allowed is a number above 0 (kg)")
    return [_line_on_body(body, stations, "ball", {"width": size, "drop": 0.5 * size, "mass": mass})]


def beam(
    name: str,
    nodes: NDArray[np.int64],
    lengths: Sequence[float],
    *,
    diameter: float | None = None,
    width: float | None = None,
    strips_per_element: int = 4,
    free_end: bool = True,
    elements_per_line: int = ELEMENTS_PER_LINE,
) -> list[ContactLine]:
    """Contact lines on a beam of cubic elements, from its tip, which meets the medium first, to its root.

    Parameters
    ----------
    name : str
        Name of the beam.
    nodes : (k + 1, 4) array
        Places of r_x, r_y, r'_x, r'_y of each node among the coordinates of the bed.
    lengths : (k,) sequence
        Lengths of the elements (m).
    diameter, width : float, optional
        Section, as in `polyline`.
    strips_per_element : int
        Number of strips on an element.
    free_end : bool
        Whether the face at the last node is free.
    elements_per_line : int
        Greatest number of elements of a line.

    Raises
    ------
    SceneError
        The section or the number of strips is not allowed.
    """
    kind, size = section(diameter, width)
    strips_each, lines = count("strips_per_element", strips_per_element), []
    for stop in range(len(lengths), 0, -elements_per_line):
        start = max(0, stop - elements_per_line)
        stations = kinematics.cable_stations(np.array(lengths[start:stop]), strips_each)
        place = float(np.sum(lengths[:start]))
        record = _line_record(kind, {"width": size, "cap": free_end and stop == len(lengths), "place": place})
        lines.append(ContactLine(Body(name, np.ravel(nodes[start : stop + 1])), stations, kind, record))
    return lines


def coarser(line: ContactLine) -> ContactLine:
    """Contact line with its strips joined in pairs, within each of its sides.

    Parameters
    ----------
    line : ContactLine
        The line.
    """
    record, half = line.record.copy(), 0.5 * float(line.record["turn"][0])
    record["turn"] *= 2.0  # too much for the last strip of a side with an odd number of strips
    along, left = record["hub_along"].copy(), record["hub_left"].copy()
    record["hub_along"] = np.cos(half) * along + np.sin(half) * left  # relative to the joined first strip
    record["hub_left"] = np.cos(half) * left - np.sin(half) * along
    return replace(line, stations=line.stations[line.stations["kept"]], record=record)


# ---- parts of contact lines ----


def _write_axle(line: ContactLine, axle: Vector, radius: float) -> None:
    """Write the axle (m, in the frame of the body) into a line, relative to its first strip."""
    (x0, x1), (y0, y1) = line.stations["x"][:2], line.stations["y"][:2]
    along = np.array([x1 - x0, y1 - y0]) / np.hypot(x1 - x0, y1 - y0)
    arm = axle - (x0, y0)
    line.record["radius"] = radius
    line.record["hub_along"], line.record["hub_left"] = arm @ along, along[0] * arm[1] - along[1] * arm[0]


def _lines_along(
    body: Body, line: Vector, turns: ArrayLike | None, strips: int, split: int, kind: Kind, fields: dict[str, Any]
) -> list[ContactLine]:
    """Contact lines along a polyline (k, 2) m, of which sides may be arcs; fields: common fields of their records."""
    divided = kinematics.curved_stations(line, turning_angles(turns, len(line) - 1), count("strips", strips), split)
    lines, place = [], 0.0
    for stations, turn in divided:
        lines.append(_line_on_body(body, stations, kind, fields | {"turn": turn, "place": place}))
        place += float(np.hypot(np.diff(stations["x"]), np.diff(stations["y"])).sum())
    return lines


def _line_on_body(body: Body, stations: NDArray[np.void], kind: Kind, fields: dict[str, Any]) -> ContactLine:
    """Contact line on a body in the plane, or on a body in space that moves in the plane."""
    size = len(body.coordinates)
    if size == spatial.SIZE:
        stations = kinematics.in_space(stations)
    elif size != 3:
        raise fault(f"{body.name} has {size} coordinates; allowed are 3, or {spatial.SIZE} in space")
    return ContactLine(body, stations, kind, _line_record(kind, fields))


def _line_record(kind: Kind, fields: dict[str, Any]) -> NDArray[np.void]:
    """Record (1,) of a line with these fields."""
    record = np.zeros(1, LINE)
    for name, value in fields.items():
        record[name] = value
    if kind in ("round", "ball"):  # the width of a plate or an outline is normal to the plane
        record["beside"] = 0.5 * record["width"]
    return record
