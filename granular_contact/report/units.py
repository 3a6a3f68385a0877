"""Numbers for readers: units of axes, times, and the values of keys, whose suffix gives their unit.

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
# What the last words of a key say of its unit; those with prefixes (mm, ms) are taken at their best size.
_SCALED = {"s": "s", "m": "m", "N": "N", "J": "J", "Nm": "N\N{MIDDLE DOT}m", "W": "W"}
_FIXED = {
    **{"m_s": "m/s", "rad_s": "rad/s", "deg": "deg", "Hz": "Hz"},
    **{"kg": "kg", "kg_m3": "kg/m³", "m_s2": "m/s²", "kg_m2": "kg m²"},
}
_WORDS = {
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
    """A value in SI units times `factor` is a number of `name`s."""

    factor: float
    name: str


def unit_for(values: ArrayLike, base: str) -> Unit:
    """The multiple of SI unit `base` in which the largest magnitude of `values` (any shape, SI) lies in 1 to 1000."""
    largest = greatest(values)
    exponent = 3 * int(np.floor(np.log10(largest) / 3)) if largest > 0 else 0
    exponent = min(max(exponent, min(_PREFIXES)), max(_PREFIXES))
    return Unit(10.0**-exponent, _PREFIXES[exponent] + base)


def sized(value: float, base: str, form: str = ".4g") -> str:
    """A value with the multiple of SI unit `base` that suits it: 0.0254 of `s` is `25.4 ms`."""
    unit = unit_for(value, base)
    return f"{value * unit.factor:{form}} {unit.name}"


def greatest(values: ArrayLike) -> float:
    """Largest finite magnitude, 0 if there is none."""
    return float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))


def round_below(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above a value."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(max(m for m in (1, 2, 5) if m * power <= value * (1 + 1e-9)) * power)


def minus(words: str) -> str:
    """Text with a typeset minus sign."""
    return words.replace("-", "\N{MINUS SIGN}")


def time_unit(results: Results) -> Unit:
    """Of the time axis; chosen by the last instant."""
    return unit_for(results["time_s"], "s") if len(results.table) else Unit(1.0, "s")


def instant(results: Results, seconds: float) -> str:
    """An instant or a duration in the unit of the time axis, such as `32.7 ms`."""
    unit = time_unit(results)
    return minus(f"{seconds * unit.factor:.4g} {unit.name}")


# ---- keys and their values ----


_STATISTICS = {"mean": "mean of a stride", "standard_deviation": "scatter of strides"}


def _statistic(key: str) -> tuple[str, str]:
    """The key that a (dotted) key of a statistic is of, and the statistic in words; any other key itself."""
    above, _, last = key.rpartition(".")
    return (above, _STATISTICS[last]) if above and last in _STATISTICS else (key, "")


def split(key: str) -> tuple[str, str]:
    """A key without its unit, and the unit's suffix ("" for none): `tip_speed_m_s` -> `tip_speed`, `m_s`."""
    key = _statistic(key)[0]
    parts = key.split("_")
    for size in (2, 1):
        suffix = "_".join(parts[-size:])
        if len(parts) > size and (suffix in _FIXED or suffix in _SCALED):
            return "_".join(parts[:-size]), suffix
    return key, ""


def label(key: str) -> str:
    """What a (dotted) key is called: `initial.impact_angle_deg` -> `impact angle`; a symbol stays one, as `eta_h`."""
    of, statistic = _statistic(key)
    last = of.rpartition(".")[2]
    words = split(last)[0]
    is_symbol = any(len(word) == 1 for word in words.split("_"))
    label_words = _WORDS.get(last) or (words if is_symbol else words.replace("_", " "))
    return f"{label_words}, {statistic}" if statistic else label_words


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
        return minus(sized(value, _SCALED[suffix]))
    exact = not math.isfinite(value) or (value == int(value) and abs(value) < 1e6)
    return (plain(value) if exact else minus(f"{value:.4g}")) + (f" {_FIXED[suffix]}" if suffix else "")


def plain(value: Any) -> str:
    """A number to five digits, whole ones as they are."""
    if not is_number(value):
        return str(value)
    if isinstance(value, int) or (math.isfinite(value) and value == int(value) and abs(value) < 1e6):
        return minus(f"{int(value)}")
    return minus(f"{value:.5g}")


def scaled(key: str, values: Array) -> tuple[str, Array]:
    """Label of the axis of a key, with a unit that suits its values (any shape), and these in that unit."""
    words, numbers = column(key, values.ravel().tolist())
    return words, np.array(numbers, dtype=float).reshape(values.shape)


def column(key: str, values: Sequence[Any]) -> tuple[str, list[Any]]:
    """Heading of the column of a key, with a unit that suits all its values, and these in that unit.

    What is not a number stays as it is.
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
