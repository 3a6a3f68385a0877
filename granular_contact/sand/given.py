"""What a bed is made of, as it is given: media and layers, the surface, the regularisation of the static law."""

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


def layers_of(medium: Law | Layer | Sequence[Law | Layer], form: str) -> tuple[Layer, ...]:
    """Layers of one medium, or of several; the resultant form is for whole beds."""
    if form not in ("distributed", "resultant"):
        raise ValueError(f"form: got {form!r}, allowed are 'distributed' and 'resultant'")
    given = tuple(medium) if isinstance(medium, Sequence) and not isinstance(medium, str) else (medium,)
    _expect("medium", given, (Law, Layer), "a medium, such as preset('play_sand'), a Layer, or several of these")
    if not given:
        raise ValueError("medium: got none, allowed is at least one")
    layers = tuple(one if isinstance(one, Layer) else Layer(one) for one in given)
    if form == "resultant" and not all(layer.whole for layer in layers):
        raise ValueError("form: got 'resultant', but there are layers: allowed is 'distributed'")
    return layers


def floor_of(floor: Floor | None) -> Floor | None:
    """The floor, if it carries."""
    _expect("floor", [] if floor is None else [floor], (Floor,), "a Floor")
    return floor if floor is not None and floor.stiffness is not None else None


def check_floor(floor: Floor | None, surface: float) -> None:
    """Refuse a floor that is nowhere below a surface, of which this is the highest place (m)."""
    if floor is not None and not floor.height < surface:
        got = f"got a height of {floor.height:g} m, with the surface at {surface:g} m"
        raise ValueError(f"floor: {got}; allowed is below it")


def records_of(
    layers: Sequence[Layer], static: Elastoplastic | Smooth | None, gravity: float
) -> list[NDArray[np.void]]:
    """Record (1,) of each layer's medium, as the kernels read it."""
    if np.ndim(gravity) != 0 or not np.isfinite(gravity):
        raise ValueError(f"gravity: got {gravity}, allowed is a finite number, its magnitude (m/s2)")
    static = Elastoplastic() if static is None else static
    _expect("static", [static], (Elastoplastic, Smooth), "Elastoplastic() or Smooth()")
    return [layer.medium.record(static, gravity) for layer in layers]


def profile_of(surface: ArrayLike, slope: float) -> Vector:
    """Corners (k, 2) m, as the kernels read them, of a surface given as a height and a slope, or as corners."""
    given = np.asarray(surface, float)
    profile = np.array([[0.0, float(given)]]) if given.ndim == 0 else given
    if profile.ndim != 2 or profile.shape[1] != 2 or len(profile) == 0:
        raise ValueError(f"surface: got an array of shape {given.shape}, allowed are a number and (k, 2) corners")
    if not np.isfinite(profile).all():
        raise ValueError(f"surface: got {given.tolist()}, allowed are finite numbers")
    if (np.diff(profile[:, 0]) <= 0.0).any():
        raise ValueError("surface: x of the corners must rise from one to the next")
    if np.ndim(slope) != 0 or not np.isfinite(slope):
        raise ValueError(f"slope: got {slope}, allowed is a finite number, the rise per length")
    if slope != 0.0 and len(profile) > 1:
        raise ValueError(f"slope: got {slope} and corners of the surface; allowed is one of the two")
    return np.ascontiguousarray(corners(profile, slope))


def direction(name: str, given: ArrayLike) -> Vector:
    """A direction (3,) of length 1; ValueError, with the name of the argument, for what is none."""
    try:
        found = np.asarray(given, float)
    except (TypeError, ValueError):  # as of "z"
        found = np.zeros(0)
    if found.shape != (3,) or not np.isfinite(found).all() or np.linalg.norm(found) < 1e-12:
        got = given if isinstance(given, str) else np.asarray(given).tolist()
        raise ValueError(f"{name}: got {got!r}, allowed is a direction of three finite numbers")
    return np.asarray(found / np.linalg.norm(found))


def check_slope(media: Sequence[Law], rise: float) -> None:
    """Refuse a slope, its rise per length, on which a medium does not lie."""
    for words in slope_faults(media, math.degrees(math.atan(rise))):
        raise ValueError(f"slope: {words}")


def told(load: Any) -> Any:
    """A load, when whoever called the constructor of a door was warned of what is assumed of its media."""
    for medium in load.media:
        for words in gravity_notes(medium, load.gravity):
            warnings.warn(words, stacklevel=3)
    for words in slope_notes(load.media, load.pieces()):
        warnings.warn(words, stacklevel=3)
    return load


def _expect(name: str, given: Sequence[Any], kinds: tuple[type, ...], allowed: str) -> None:
    for one in given:
        if not isinstance(one, kinds):
            raise ValueError(f"{name}: got {one!r}, allowed is {allowed}")
