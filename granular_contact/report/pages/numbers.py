"""Keys of summaries and tables -> words; their values -> numbers with units, as people read them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from granular_contact.results.units import minus, unit_for

# What the last words of a key say of its unit; those with prefixes (mm, ms) are taken at their best size.
_SCALED = {"s": "s", "m": "m", "N": "N", "J": "J", "Nm": "N\N{MIDDLE DOT}m", "W": "W"}
_FIXED = {"m_s": "m/s", "rad_s": "rad/s", "deg": "deg", "kg": "kg", "kg_m3": "kg/m³", "m_s2": "m/s²", "kg_m2": "kg m²"}
_WORDS = {
    "imbalance_relative": "energy unaccounted for",
    "max_depth_m": "largest depth",
    "max_deflection_m": "largest deflection",
    "solve_s": "solve time",
    "stopping_time_relative": "off by",
    "travel_relative": "travel off by",
    "deflection_relative": "off by",
    "angle_rms_deg": "rms difference of angle",
    "deflection_rms_m": "rms difference of deflection",
}


def split(key: str) -> tuple[str, str]:
    """A key without its unit, and the unit's suffix ("" for none): `tip_speed_m_s` -> `tip_speed`, `m_s`."""
    parts = key.split("_")
    for size in (2, 1):
        suffix = "_".join(parts[-size:])
        if len(parts) > size and (suffix in _FIXED or suffix in _SCALED):
            return "_".join(parts[:-size]), suffix
    return key, ""


def label(key: str) -> str:
    """What a (dotted) key is called: `initial.impact_angle_deg` -> `impact angle`; a symbol stays one, as `eta_h`."""
    last = key.rpartition(".")[2]
    words = split(last)[0]
    is_symbol = any(len(word) == 1 for word in words.split("_"))
    return _WORDS.get(last) or (words if is_symbol else words.replace("_", " "))


def is_number(value: Any) -> bool:
    """Whether a value is a number, and neither true nor false."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def quantity(key: str, value: Any) -> str:
    """A value of a key with the unit that the key names: 0.0254 of `stopping_time_s` is `25.4 ms`."""
    if value is None:
        return "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not is_number(value):
        return str(value)
    if key.endswith("_relative"):
        return minus(f"{100 * value:.2g} %")
    suffix = split(key)[1]
    if suffix in _SCALED:
        unit = unit_for(np.array([value], float), _SCALED[suffix])
        return minus(f"{value * unit.factor:.4g}") + f" {unit.name}"
    return plain(value) + (f" {_FIXED[suffix]}" if suffix else "")


def plain(value: Any) -> str:
    """A number to five digits, whole ones as they are."""
    if not is_number(value):
        return str(value)
    if isinstance(value, int) or (math.isfinite(value) and value == int(value) and abs(value) < 1e6):
        return minus(f"{int(value)}")
    return minus(f"{value:.5g}")


def column(key: str, values: Sequence[Any]) -> tuple[str, list[Any]]:
    """Heading of the column of a key, with a unit that suits all its values, and these in that unit.

    What is no number stays as it is.
    """
    known = np.array([value for value in values if is_number(value)], dtype=float)
    factor, name = 1.0, _FIXED.get(split(key)[1], "")
    if key.endswith("_relative"):
        return f"{label(key)} (%)", [minus(f"{100 * v:+.3f}") if is_number(v) else v for v in values]
    if split(key)[1] in _SCALED:
        unit = unit_for(known, _SCALED[split(key)[1]])
        factor, name = unit.factor, unit.name
    if factor != 1.0:
        values = [factor * value if is_number(value) else value for value in values]
    return f"{label(key)} ({name})" if name else label(key), list(values)
