"""Names of measured columns -> columns of ours: a quantity, and its unit at the end of the name.

Of a run these are columns of its time series, of a force test what was prescribed and what was measured.
"""

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
    "m_s": {"m_s": 1.0, "cm_s": 1e-2, "mm_s": 1e-3},
    "rad_s": {"rad_s": 1.0, "deg_s": math.radians(1.0), "rpm": 2.0 * math.pi / 60.0},
    "N": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "Nm": {"Nm": 1.0, "Nmm": 1e-3, "mNm": 1e-3, "kNm": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
}
OBSERVED = ("deg", "m")
BY_NAME = ("N", "Nm")  # what is compared where the fit says which column it is: every run's own table has forces
# What the other columns of a run hold, by the end of their names.
KINDS = {"_rad_s": "a rate", "_m_s": "a speed", "_Nm": "a moment", "_N": "a force", "_J": "an energy", "_W": "a power"}

# Columns of a force test.
GIVEN = DEPTH, SPEED, RATE, PATH = "depth_m", "speed_m_s", "rate_rad_s", "path_length_m"
FORCE, VERTICAL, HORIZONTAL = "force_N", "vertical_force_N", "horizontal_force_N"
TORQUE, PRESSURE = "torque_Nm", "pressure_Pa"
SIGNS = {
    FORCE: "against the motion",
    VERTICAL: "upward, on the body",
    HORIZONTAL: "to the right, on the body",
    TORQUE: "against the turning, or clockwise on a body that does not turn",
    PRESSURE: "the force against the motion over area_m2",
}
OF_FORCE_TESTS = (*GIVEN, *SIGNS)

# A header as tables have them, with its unit in brackets; signs that units are written with and names here are not.
_IN_BRACKETS = re.compile(r"\s*([^()\[\]]*[^()\[\]\s])\s*[(\[]\s*([^()\[\]]*[^()\[\]\s])\s*[)\]]\s*")
_MARKS = str.maketrans({"/": "_", " ": None, ".": None, "*": None, "\u00b7": None, "\u00b0": "deg", "\u00b5": "u"})


def plain(header: str) -> str:
    """A header with its unit in brackets, as `Depth (mm)` or `Speed [m/s]`, as a name: `depth_mm`, `speed_m_s`."""
    parts = _IN_BRACKETS.fullmatch(header)
    if parts is None:
        return header
    return f"{'_'.join(parts[1].lower().split())}_{parts[2].translate(_MARKS)}"


def observables(columns: Iterable[str]) -> list[str]:
    """The columns of a run that can be measured: its angles and lengths."""
    return [name for name in columns if name.rpartition("_")[2] in OBSERVED]


def forces(columns: Iterable[str]) -> list[str]:
    """The columns of a run that are forces or moments, as of drives and bodies in the medium."""
    return [name for name in columns if name.rpartition("_")[2] in BY_NAME]


def kind(column: str) -> str:
    """What a column of a run holds that is neither an angle nor a length, as `a force`."""
    return next((words for end, words in KINDS.items() if column.endswith(end)), "neither an angle nor a length")


def _unit(column: str) -> str:
    """The unit at the end of a column of ours: m_s of speed_m_s."""
    return max((unit for unit in UNITS if column.endswith(f"_{unit}")), key=len)


def spellings(known: Iterable[str]) -> dict[str, tuple[str, float]]:
    """Every name by which the `known` columns may be measured: which of them it is, and the factor to its unit."""
    return {
        f"{column.removesuffix(base)}{unit}": (column, factor)
        for column in known
        for base in [_unit(column)]
        for unit, factor in UNITS[base].items()
    }


def recognise(name: str, known: Iterable[str]) -> tuple[str, float] | None:
    """Which of the `known` columns the measured `name` is, and the factor to its unit; None if it is none of them."""
    return spellings(known).get(plain(name))


def in_words(known: Iterable[str]) -> str:
    """The known columns with the units that each may have, as `tip_x_m (cm, mm, um)`."""
    units = ((column, _unit(column)) for column in known)
    return ", ".join(f"{column} ({', '.join(one for one in UNITS[own] if one != own)})" for column, own in units)
