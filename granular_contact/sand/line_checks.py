"""Checks of the sizes and points of contact lines."""

from __future__ import annotations

from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.errors import SceneError, scene_error
from granular_contact.laws.kinds import Kind

Vector = NDArray[np.float64]


def fault(message: str) -> SceneError:
    """Error of a bed.

    Parameters
    ----------
    message : str
        The sentence.
    """
    return scene_error("bed", message)


def section(diameter: float | None, width: float | None) -> tuple[Kind, float]:
    """Kind of shape and width (m) of a thin line, from exactly one of the two sizes.

    Parameters
    ----------
    diameter, width : float or None
        Diameter of a bar, or width of a plate (m).

    Returns
    -------
    tuple
        Kind, and width (m).

    Raises
    ------
    SceneError
        None or both are given, or the size is not above 0.
    """
    if (diameter is None) == (width is None):
        raise fault("give diameter or width" if width is None else "got both diameter and width; one is allowed")
    return ("flat", positive("width", width)) if diameter is None else ("round", positive("diameter", diameter))


def positive(name: str, size: float | None) -> float:
    """Return a size, checked to be a finite number above 0.

    Parameters
    ----------
    name : str
        Name of the argument, for the message.
    size : float or None
        The size (m).

    Raises
    ------
    SceneError
        It is not.
    """
    if size is None or not (np.isfinite(size) and size > 0.0):
        raise fault(f"{name}: got {size}, allowed is a number above 0 (m)")
    return float(size)


def count(name: str, number: Any) -> int:
    """Return a number, checked to be whole and at least 1.

    Parameters
    ----------
    name : str
        Name of the argument, for the message.
    number : int
        The number.

    Raises
    ------
    SceneError
        It is not.
    """
    if not isinstance(number, Integral) or number < 1:
        raise fault(f"{name}: got {number}, allowed is a whole number from 1")
    return int(number)


def planar(points: ArrayLike) -> Vector:
    """Return points, checked to be finite and in the plane z = 0.

    Parameters
    ----------
    points : (k, 2) or (k, 3) array
        Points (m).

    Returns
    -------
    (k, 2) array
        Points (m).

    Raises
    ------
    SceneError
        They have another shape, are not finite, or have a z.
    """
    given = np.atleast_2d(np.asarray(points, float))
    if given.ndim != 2 or given.shape[1] not in (2, 3):
        raise fault(f"got points of the shape {given.shape}, allowed is (k, 2)")
    if given[:, 2:].any():
        raise fault(f"got z = {given[given[:, 2] != 0.0][0, 2]:g} m, allowed are points in the plane z = 0")
    if not np.isfinite(given).all():
        raise fault("a point is not finite")
    return given[:, :2]


def turning_angles(turns: ArrayLike | None, sides: int) -> Vector:
    """Turning angle of each side, checked to be less than half a turn.

    Parameters
    ----------
    turns : (sides,) array or None
        Angles (rad); None: the sides are straight.
    sides : int
        Number of sides.

    Returns
    -------
    (sides,) array
        Angles (rad).

    Raises
    ------
    SceneError
        An angle is too large, or there is not one for each side.
    """
    given = np.zeros(sides) if turns is None else np.asarray(turns, float)
    if given.shape != (sides,):
        raise fault(f"turns: got the shape {given.shape}, allowed is one angle for each side, ({sides},)")
    if not (np.abs(given) < np.pi).all():
        raise fault(f"turns: got {given.tolist()}, allowed are angles below half a turn (rad)")
    return given


def corner_points(points: ArrayLike, least: int) -> Vector:
    """Corners of a line, checked: at least so many, and no two neighbours the same.

    Parameters
    ----------
    points : (k, 2) array
        Points (m).
    least : int
        Least number of points.

    Returns
    -------
    (k, 2) array
        Points (m).

    Raises
    ------
    SceneError
        There are too few, or two neighbours are the same; or as in `planar`.
    """
    line = planar(points)
    if len(line) < least:
        raise fault(f"got {len(line)} points, allowed are at least {least}")
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    if not steps.all():
        i = int(np.argmin(steps))
        raise fault(f"points {i} and {i + 1} are the same, {line[i].tolist()}")
    return line
