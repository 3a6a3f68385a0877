"""Names of measured columns -> columns of the time series: a quantity, and its unit at the end of the name."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

TIME = "time_s"
# Unit of a column of ours -> units that a measured one may have, and how many of ours one of them is.
UNITS = {
    "s": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "deg": {"deg": 1.0, "rad": math.degrees(1.0)},
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "N": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "Nm": {"Nm": 1.0, "Nmm": 1e-3, "mNm": 1e-3},
}
OBSERVED = ("deg", "m")
BY_NAME = ("N", "Nm")  # what is compared where the fit says which column it is: every run's own table has forces
# What the other columns of a run hold, by the end of their names.
KINDS = {"_rad_s": "a rate", "_m_s": "a speed", "_Nm": "a moment", "_N": "a force", "_J": "an energy", "_W": "a power"}
# A header as tables have them, with its unit in brackets; signs that units are written with and names here are not.
_IN_BRACKETS = re.compile(r"\s*([^()\[\]]*[^()\[\]\s])\s*[(\[]\s*([^()\[\]]*[^()\[\]\s])\s*[)\]]\s*")
_SIGNS = str.maketrans({"/": "_", " ": None, ".": None, "*": None, "\u00b7": None, "\u00b0": "deg", "\u00b5": "u"})


def plain(header: str) -> str:
    """A header with its unit in brackets, as `Depth (mm)` or `Speed [m/s]`, as a name: `depth_mm`, `speed_m_s`."""
    parts = _IN_BRACKETS.fullmatch(header)
    if parts is None:
        return header
    return f"{'_'.join(parts[1].lower().split())}_{parts[2].translate(_SIGNS)}"


def observables(columns: Iterable[str]) -> list[str]:
    """The columns of a run that can be measured: its angles and lengths."""
    return [name for name in columns if name.rpartition("_")[2] in OBSERVED]


def forces(columns: Iterable[str]) -> list[str]:
    """The columns of a run that are forces or moments, as of drives and bodies in the medium."""
    return [name for name in columns if name.rpartition("_")[2] in BY_NAME]


def kind(column: str) -> str:
    """What a column of a run holds that is neither an angle nor a length, as `a force`."""
    return next((words for end, words in KINDS.items() if column.endswith(end)), "neither an angle nor a length")


def recognise(name: str, known: Iterable[str]) -> tuple[str, float] | None:
    """Which of the `known` columns the measured `name` is, and the factor to its unit; None if it is none of them."""
    stem, _, unit = plain(name).rpartition("_")
    for column in known:
        own, _, base = column.rpartition("_")
        if own == stem and unit in UNITS.get(base, ()):
            return column, UNITS[base][unit]
    return None


def spellings(known: Iterable[str]) -> list[str]:
    """Every name by which the `known` columns may be measured."""
    parts = [column.rpartition("_") for column in known]
    return [f"{stem}_{unit}" for stem, _, base in parts for unit in UNITS[base]]


def in_words(known: Iterable[str]) -> str:
    """The known columns with the units that each may have, as `tip_x_m (cm, mm, um)`."""
    parts = [(column, column.rpartition("_")[2]) for column in known]
    return ", ".join(f"{c} ({', '.join(u for u in UNITS[b] if u != b)})" if b in UNITS else c for c, b in parts)
