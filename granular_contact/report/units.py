"""Units and numbers as text: units of axes, times, and values of keys, whose suffix is their unit.

SI units get the prefix with which a number is between 1 and 1000.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from granular_contact.results import Results

Array = NDArray[np.float64]

_PREFIXES = {-24: "y", -21: "z", -18: "a", -15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
# Units by the suffix of a key: units that take SI prefixes, and fixed ones.
_SCALED = {"s": "s", "m": "m", "N": "N", "J": "J", "Nm": "N\N{MIDDLE DOT}m", "W": "W"}
_FIXED = {
    **{"m_s": "m/s", "rad_s": "rad/s", "deg": "deg", "Hz": "Hz"},
    **{"kg": "kg", "kg_m3": "kg/m³", "m_s2": "m/s²", "kg_m2": "kg m²"},
}
_LABELS = {
    "imbalance_relative": "energy imbalance",
    "max_depth_m": "largest depth",
    "max_deflection_m": "largest deflection",
    "max_deflection_time_s": "time of largest deflection",
    "forward_speed_second_half_m_s": "forward speed in the second half",
    "drive_work_put_in_J": "work put in by drives",
    "hub_stopping_time_s": "first stop of the hub",
    "rms_torque_Nm": "rms torque",
    "rms_force_N": "rms force",
    "solve_s": "solve time",
    "stopping_time_relative": "error of stopping time",
    "travel_relative": "error of travel",
    "deflection_relative": "error of deflection",
    "angle_rms_deg": "rms difference of angle",
    "deflection_rms_m": "rms difference of deflection",
}


@dataclass(frozen=True)
class Unit:
    """Unit of an axis: a value in SI units times `factor` is the value in the unit `name`."""

    factor: float
    name: str


def unit_for(values: ArrayLike, base: str) -> Unit:
    """Multiple of the SI unit `base` in which the largest magnitude of `values` (any shape, SI) is from 1 to 1000."""
    largest = greatest(values)
    exponent = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 else 0
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return Unit(10.0**-exponent, _PREFIXES[exponent] + base)


def sized(value: float, base: str, form: str = ".4g") -> str:
    """Format a value with a suitable multiple of the SI unit `base`: 0.0254 of `s` is `25.4 ms`."""
    unit = unit_for(value, base)
    return f"{value * unit.factor:{form}} {unit.name}"


def greatest(values: ArrayLike) -> float:
    """Largest finite magnitude; 0 if there is none."""
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def round_below(value: float) -> float:
    """Round a value down to 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(digit for digit in (1, 2, 5) if digit * power <= value * (1 + 1e-9)) * power)


def minus(text: str) -> str:
    """Replace hyphens by typeset minus signs."""
    return text.replace("-", "\N{MINUS SIGN}")


def time_unit(results: Results) -> Unit:
    """Unit of the time axis, chosen by the last instant."""
    return unit_for(results["time_s"], "s") if len(results.table) else Unit(1.0, "s")


def instant(results: Results, seconds: float) -> str:
    """Format an instant or a duration in the unit of the time axis, such as `32.7 ms`."""
    unit = time_unit(results)
    return minus(f"{seconds * unit.factor:.4g} {unit.name}")


# ---- keys and their values ----


_STATISTICS = {"mean": "mean of a stride", "standard_deviation": "scatter of strides"}


def _statistic(key: str) -> tuple[str, str]:
    """Split the (dotted) key of a statistic into the key of the quantity and the statistic's name ("" for none)."""
    above, _, last = key.rpartition(".")
    return (above, _STATISTICS[last]) if above and last in _STATISTICS else (key, "")


def split(key: str) -> tuple[str, str]:
    """Split a key into its name and the suffix of its unit ("" for none): `tip_speed_m_s` -> `tip_speed`, `m_s`."""
    key = _statistic(key)[0]
    parts = key.split("_")
    for size in (2, 1):
        suffix = "_".join(parts[-size:])
        if len(parts) > size and (suffix in _FIXED or suffix in _SCALED):
            return "_".join(parts[:-size]), suffix
    return key, ""


def label(key: str) -> str:
    """Label of a (dotted) key: `initial.impact_angle_deg` -> `impact angle`; symbols stay unchanged, as `eta_h`."""
    quantity_key, statistic = _statistic(key)
    last = quantity_key.rpartition(".")[2]
    name = split(last)[0]
    is_symbol = any(len(word) == 1 for word in name.split("_"))
    text = _LABELS.get(last) or (name if is_symbol else name.replace("_", " "))
    return f"{text}, {statistic}" if statistic else text


def is_number(value: Any) -> bool:
    """Return whether a value is a number, but not True or False."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def quantity(key: str, value: Any) -> str:
    """Format the value of a key with its unit: 0.0254 of `stopping_time_s` is `25.4 ms`."""
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
        return minus(sized(value, _SCALED[suffix]))
    exact = not math.isfinite(value) or (value == int(value) and abs(value) < 1e6)
    return (plain(value) if exact else minus(f"{value:.4g}")) + (f" {_FIXED[suffix]}" if suffix else "")


def plain(value: Any) -> str:
    """Format a number with five digits, whole numbers completely."""
    if not is_number(value):
        return str(value)
    if isinstance(value, int) or (math.isfinite(value) and value == int(value) and abs(value) < 1e6):
        return minus(f"{int(value)}")
    return minus(f"{value:.5g}")


def scaled(key: str, values: Array) -> tuple[str, Array]:
    """Label of the axis of a key, with a unit that suits the values (any shape), and the values in this unit."""
    text, numbers = column(key, values.ravel().tolist())
    return text, np.array(numbers, dtype=float).reshape(values.shape)


def column(key: str, values: Sequence[Any]) -> tuple[str, list[Any]]:
    """Heading of the column of a key, with a unit that suits all values, and the values in this unit.

    Values that are not numbers stay unchanged.
    """
    numbers = np.array([value for value in values if is_number(value)], dtype=float)
    factor, name = 1.0, _FIXED.get(split(key)[1], "")
    if key.endswith("_relative"):
        return f"{label(key)} (%)", [minus(f"{100 * value:+.3f}") if is_number(value) else value for value in values]
    if split(key)[1] in _SCALED:
        unit = unit_for(numbers, _SCALED[split(key)[1]])
        factor, name = unit.factor, unit.name
    if factor != 1.0:
        values = [factor * value if is_number(value) else value for value in values]
    return f"{label(key)} ({name})" if name else label(key), list(values)
