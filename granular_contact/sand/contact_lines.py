"""Shapes of a body -> contact lines: stations along what the medium meets, and whether a shape has a size."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import SceneError, scene_error
from granular_contact.geometry.polygon import crossing, doubled_area, extent
from granular_contact.laws.kinds import Kind
from granular_contact.sand.kernels import kinematics, spatial
from granular_contact.sand.kernels.law import LINE

if TYPE_CHECKING:
    from granular_contact.sand.space.cables import CablePiece

Vector = NDArray[np.float64]

# Most elements in one line: a long beam is cheaper in pieces, of which only those near the surface are evaluated.
ELEMENTS_PER_LINE = 12


@dataclass(frozen=True)
class Body:
    """A rigid body, and where its coordinates stand among those of the bed.

    coordinates: the places of x, y (m) and the angle (rad, counter-clockwise), or of x, y, z (m) and four Euler
    parameters. name: under which the medium's wrench on it is kept. piece: of a cable in space, if it is one.
    """

    name: str
    coordinates: Sequence[int] | NDArray[np.int64]
    piece: CablePiece | None = None

    @property
    def which(self) -> tuple[Any, ...]:
        """The same for all shapes on one body: several may have one name."""
        return self.name, tuple(self.coordinates), self.piece


@dataclass(frozen=True)
class ContactLine:
    """Stations along a line on one body, between which the medium acts on straight or round strips.

    stations (n,): records of `kernels.kinematics`, whose type says how coordinates move them; kind: what the media meet
    there; record (1,): of `kernels.law`.
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
    """Lines along a thin round bar (`diameter`) or plate (`width`, normal to the plane), m; one of the two is given.

    points (k, 2) m in the body's frame, k >= 2; turns (k - 1,) rad, counter-clockwise: of sides that are chords of
    arcs; strips: about how many there are in all; split: into how many each of them is divided; free_end: whether the
    face at the last point is free.

    Raises
    ------
    SceneError
        The line has no length, no width or no strips, or is not in the plane.
    """
    kind, size = _section(diameter, width)
    made = _along(body, _points(points, 2), turns, strips, split, kind, {"width": size})
    made[-1].record["cap"] = free_end
    return made


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
    """Lines around a solid with a polygon as its section, `width` (m) normal to the plane; errors as of `polyline`.

    points (k, 2) m: corners in either sense, the first of which need not be repeated; turns: of all sides; wheel: axle
    (2,) m and radius (m) of what is a wheel.
    """
    size, corners = positive("width", width), _points(points, 3)
    if not np.array_equal(corners[0], corners[-1]):
        corners = np.vstack([corners, corners[:1]])
    sides = [(float(x), float(y)) for x, y in corners[:-1]]
    area = doubled_area(sides)
    if abs(area) < 2e-13 * extent(sides) ** 2:
        raise _fault("the outline encloses no area")
    if pair := crossing(sides):
        raise _fault(f"the sides after points {pair[0] + 1} and {pair[1] + 1} cross; sides may only meet")
    # The interior of a counter-clockwise polygon lies to the left, so its outward normal to the right.
    side = -1.0 if area > 0.0 else 1.0
    made = _along(body, corners, turns, strips, split, "outline", {"width": size, "side": side})
    if wheel is not None:
        for line in made:
            _hub(line, planar(wheel[0])[0], positive("wheel", wheel[1]))
    return made


def ball(body: Body, center: ArrayLike, diameter: float, mass: float) -> list[ContactLine]:
    """Line of a sphere: center (2,) m in the body's frame, diameter (m), its own mass (kg); errors as of `polyline`."""
    size = positive("diameter", diameter)
    stations = kinematics.ball_stations(planar(center)[0])
    if not (np.isfinite(mass) and mass > 0.0):
        raise _fault(f"mass: got {mass}, allowed is a number above 0 (kg)")
    return [_on(body, stations, "ball", {"width": size, "drop": 0.5 * size, "mass": mass})]


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
    """Lines on a beam of cubic elements, from its tip on, where it meets the medium first; sizes as of `polyline`.

    nodes (k + 1, 4): places of r_x, r_y, r'_x, r'_y of each node among the coordinates of the bed; lengths (k,) m.
    """
    kind, size = _section(diameter, width)
    each, made = count("strips_per_element", strips_per_element), []
    for stop in range(len(lengths), 0, -elements_per_line):
        start = max(0, stop - elements_per_line)
        stations = kinematics.cable_stations(np.array(lengths[start:stop]), each)
        place = float(np.sum(lengths[:start]))
        record = _record(kind, {"width": size, "cap": free_end and stop == len(lengths), "place": place})
        made.append(ContactLine(Body(name, np.ravel(nodes[start : stop + 1])), stations, kind, record))
    return made


def coarser(line: ContactLine) -> ContactLine:
    """The line with its strips joined in pairs, within each of its sides."""
    record, half = line.record.copy(), 0.5 * float(line.record["turn"][0])
    record["turn"] *= 2.0  # of the last strip of an odd number it is too much
    along, left = record["hub_along"].copy(), record["hub_left"].copy()
    record["hub_along"] = np.cos(half) * along + np.sin(half) * left  # as seen from a first strip that is joined
    record["hub_left"] = np.cos(half) * left - np.sin(half) * along
    return replace(line, stations=line.stations[line.stations["kept"]], record=record)


# ---- what they are made of ----


def _hub(line: ContactLine, axle: Vector, radius: float) -> None:
    """Let a line know where the axle is (m, in the body's frame), seen from its first strip."""
    (x0, x1), (y0, y1) = line.stations["x"][:2], line.stations["y"][:2]
    along = np.array([x1 - x0, y1 - y0]) / np.hypot(x1 - x0, y1 - y0)
    arm = axle - (x0, y0)
    line.record["radius"] = radius
    line.record["hub_along"], line.record["hub_left"] = arm @ along, along[0] * arm[1] - along[1] * arm[0]


def _along(
    body: Body, line: Vector, turns: ArrayLike | None, strips: int, split: int, kind: Kind, fields: dict[str, Any]
) -> list[ContactLine]:
    """Lines along the polyline (k, 2) m; of its sides some may be arcs."""
    divided = kinematics.curved_stations(line, _turns(turns, len(line) - 1), count("strips", strips), split)
    made, place = [], 0.0
    for stations, turn in divided:
        made.append(_on(body, stations, kind, fields | {"turn": turn, "place": place}))
        place += float(np.hypot(np.diff(stations["x"]), np.diff(stations["y"])).sum())
    return made


def _on(body: Body, stations: NDArray[np.void], kind: Kind, fields: dict[str, Any]) -> ContactLine:
    size = len(body.coordinates)
    if size == spatial.SIZE:
        stations = kinematics.in_space(stations)
    elif size != 3:
        raise _fault(f"{body.name} has {size} coordinates; allowed are 3, or {spatial.SIZE} in space")
    return ContactLine(body, stations, kind, _record(kind, fields))


def _record(kind: Kind, fields: dict[str, Any]) -> NDArray[np.void]:
    record = np.zeros(1, LINE)
    for name, value in fields.items():
        record[name] = value
    if kind in ("round", "ball"):  # the width of a plate or an outline is normal to the plane
        record["beside"] = 0.5 * record["width"]
    return record


# ---- whether a shape can be ----


def _fault(message: str) -> SceneError:
    return scene_error("bed", message)


def _section(diameter: float | None, width: float | None) -> tuple[Kind, float]:
    """Kind and width (m) of a thin line, from exactly one of the two sizes."""
    if (diameter is None) == (width is None):
        raise _fault("give diameter or width" if width is None else "got both diameter and width; one is allowed")
    return ("flat", positive("width", width)) if diameter is None else ("round", positive("diameter", diameter))


def positive(name: str, size: float | None) -> float:
    """The size, which must be a finite number above 0."""
    if size is None or not (np.isfinite(size) and size > 0.0):
        raise _fault(f"{name}: got {size}, allowed is a number above 0 (m)")
    return float(size)


def count(name: str, number: Any) -> int:
    """The number, which must be whole and at least 1."""
    if not isinstance(number, Integral) or number < 1:
        raise _fault(f"{name}: got {number}, allowed is a whole number from 1")
    return int(number)


def planar(points: ArrayLike) -> Vector:
    """Points (k, 2) m in the plane of motion; a third coordinate must be 0."""
    given = np.atleast_2d(np.asarray(points, float))
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise _fault(f"got points of the shape {given.shape}, allowed is (k, 2)")
    if given[:, 2:].any():
        raise _fault(f"got z = {given[given[:, 2] != 0.0][0, 2]:g} m, allowed are points in the plane z = 0")
    if not np.isfinite(given).all():
        raise _fault("a point is not finite")
    return given[:, :2]


def _turns(turns: ArrayLike | None, sides: int) -> Vector:
    """Turning angle (rad) of each side, less than half a turn."""
    given = np.zeros(sides) if turns is None else np.asarray(turns, float)
    if given.shape != (sides,):
        raise _fault(f"turns: got the shape {given.shape}, allowed is one angle for each side, ({sides},)")
    if not (np.abs(given) < np.pi).all():
        raise _fault(f"turns: got {given.tolist()}, allowed are angles below half a turn (rad)")
    return given


def _points(points: ArrayLike, least: int) -> Vector:
    line = planar(points)
    if len(line) < least:
        raise _fault(f"got {len(line)} points, allowed are at least {least}")
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    if not steps.all():
        i = int(np.argmin(steps))
        raise _fault(f"points {i} and {i + 1} are the same, {line[i].tolist()}")
    return line
