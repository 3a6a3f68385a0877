"""Check and convert the arguments of a bed: media and layers, surface, floor, regularisation of the static law."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.geometry.surface import surface as corners
from granular_contact.laws.floor import Floor
from granular_contact.laws.gravity import gravity_notes
from granular_contact.laws.law import Law
from granular_contact.laws.layer import Layer
from granular_contact.laws.repose import slope_faults, slope_notes
from granular_contact.laws.static_friction import Elastoplastic, Smooth

Vector = NDArray[np.float64]


def layers_from(medium: Law | Layer | Sequence[Law | Layer], form: str) -> tuple[Layer, ...]:
    """Layers of one medium, or of several media.

    Parameters
    ----------
    medium : Law, Layer or sequence of these
        The media.
    form : {"distributed", "resultant"}
        Form of the load. The resultant form needs media that fill the bed.

    Raises
    ------
    ValueError
        An argument is not allowed.
    """
    if form not in ("distributed", "resultant"):
        raise ValueError(f"form: got {form!r}, allowed are 'distributed' and 'resultant'")
    given = tuple(medium) if isinstance(medium, Sequence) and not isinstance(medium, str) else (medium,)
    _expect("medium", given, (Law, Layer), "a medium, such as preset('play_sand'), a Layer, or several of these")
    if not given:
        raise ValueError("medium: got none, allowed is at least one")
    layers = tuple(item if isinstance(item, Layer) else Layer(item) for item in given)
    if form == "resultant" and not all(layer.whole for layer in layers):
        raise ValueError("form: got 'resultant', but there are layers: allowed is 'distributed'")
    return layers


def carrying_floor(floor: Floor | None) -> Floor | None:
    """The floor if it carries bodies; else None.

    Parameters
    ----------
    floor : Floor or None
        The floor of the bed.

    Raises
    ------
    ValueError
        It is not a Floor.
    """
    _expect("floor", [] if floor is None else [floor], (Floor,), "a Floor")
    return floor if floor is not None and floor.stiffness is not None else None


def check_floor(floor: Floor | None, surface: float) -> None:
    """Refuse a floor that is not below the surface.

    Parameters
    ----------
    floor : Floor or None
        The floor.
    surface : float
        Height of the highest point of the surface (m).

    Raises
    ------
    ValueError
        It is not below that point.
    """
    if floor is not None and not floor.height < surface:
        got = f"got a height of {floor.height:g} m, with the surface at {surface:g} m"
        raise ValueError(f"floor: {got}; allowed is below it")


def medium_records(
    layers: Sequence[Layer], static: Elastoplastic | Smooth | None, gravity: float
) -> list[NDArray[np.void]]:
    """Records of the media of layers, as the kernels read them.

    Parameters
    ----------
    layers : sequence of Layer
        The layers.
    static : Elastoplastic, Smooth or None
        Regularisation of the sign in the static resistance; None: elastoplastic.
    gravity : float
        Gravity (m/s2).

    Returns
    -------
    list of (1,) array

    Raises
    ------
    ValueError
        An argument is not allowed, or a coefficient is missing.
    """
    if np.ndim(gravity) != 0 or not np.isfinite(numbers(gravity)):
        raise ValueError(f"gravity: got {gravity!r}, allowed is a finite number, its magnitude (m/s2)")
    static = Elastoplastic() if static is None else static
    _expect("static", [static], (Elastoplastic, Smooth), "Elastoplastic() or Smooth()")
    return [layer.medium.record(static, gravity) for layer in layers]


def surface_profile(surface: ArrayLike, slope: float) -> Vector:
    """Corners of the surface, as the kernels read them.

    Parameters
    ----------
    surface : float or (k, 2) array
        Height at x = 0 (m), or corners (m) with rising x.
    slope : float
        Rise per length, beside a height.

    Returns
    -------
    (k, 2) array
        Corners (m).

    Raises
    ------
    ValueError
        An argument is not allowed.
    """
    given = numbers(surface)
    profile = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
    if profile.ndim != 2 or profile.shape[1] != 2 or len(profile) == 0:
        raise ValueError(f"surface: got an array of shape {given.shape}, allowed are a number and (k, 2) corners")
    if not np.isfinite(profile).all():
        raise ValueError(f"surface: got {np.asarray(surface).tolist()!r}, allowed are finite numbers")
    if (np.diff(profile[:, 0]) <= 0.0).any():
        raise ValueError("surface: x of the corners must rise from one to the next")
    if np.ndim(slope) != 0 or not np.isfinite(numbers(slope)):
        raise ValueError(f"slope: got {slope!r}, allowed is a finite number, the rise per length")
    if slope != 0.0 and len(profile) > 1:
        raise ValueError(f"slope: got {slope} and corners of the surface; allowed is one of the two")
    return np.ascontiguousarray(corners(profile, slope))


def numbers(given: Any) -> Vector:
    """Array of numbers in place of an argument; NaN if it holds anything else, as text or None.

    Parameters
    ----------
    given : array_like
        The argument.

    Returns
    -------
    array
    """
    array = np.asarray(given)
    return array.astype(float) if array.dtype.kind in "iuf" else np.full(array.shape, np.nan)


def direction(name: str, given: ArrayLike) -> Vector:
    """Unit vector of a direction.

    Parameters
    ----------
    name : str
        Name of the argument, for the message.
    given : (3,) array
        Vector of any length above 0.

    Returns
    -------
    (3,) array

    Raises
    ------
    ValueError
        It is not a direction.
    """
    vector = numbers(given)
    if vector.shape != (3,) or not np.isfinite(vector).all() or np.linalg.norm(vector) < 1e-12:
        got = given if isinstance(given, str) else np.asarray(given).tolist()
        raise ValueError(f"{name}: got {got!r}, allowed is a direction of three finite numbers")
    return np.asarray(vector / np.linalg.norm(vector))


def check_slope(media: Sequence[Law], rise: float) -> None:
    """Refuse a slope that is steeper than the angle of repose of the media.

    Parameters
    ----------
    media : sequence of Law
        The media.
    rise : float
        Rise per length.

    Raises
    ------
    ValueError
        It is too steep.
    """
    for fault in slope_faults(media, math.degrees(math.atan(rise))):
        raise ValueError(f"slope: {fault}")


def with_warnings(load: Any) -> Any:
    """Warn of what is assumed of the media of a load, as called from the constructor of a bed, and return the load.

    Parameters
    ----------
    load : GranularLoad
        The load.

    Warns
    -----
    UserWarning
        Coefficients of unknown scaling meet another gravity, or the surface is steeper than the angle of repose. The
        warning points at the caller of the constructor.
    """
    for medium in load.media:
        for note in gravity_notes(medium, load.gravity):
            warnings.warn(note, stacklevel=3)
    for note in slope_notes(load.media, load.pieces()):
        warnings.warn(note, stacklevel=3)
    return load


def _expect(name: str, given: Sequence[Any], kinds: tuple[type, ...], allowed: str) -> None:
    """Raise ValueError for a value that is of none of these types."""
    for value in given:
        if not isinstance(value, kinds):
            raise ValueError(f"{name}: got {value!r}, allowed is {allowed}")
