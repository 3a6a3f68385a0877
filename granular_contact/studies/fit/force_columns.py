"""Names of the columns of a force test: what was prescribed, what was measured, and units at the end of the name."""

from __future__ import annotations

import math
from collections.abc import Iterable

from granular_contact.studies.fit.columns import plain

# Unit of a column of ours -> units that a measured one may have, and how many of ours one of them is.
UNITS = {
    "m": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6},
    "m_s": {"m_s": 1.0, "cm_s": 1e-2, "mm_s": 1e-3},
    "rad_s": {"rad_s": 1.0, "deg_s": math.radians(1.0), "rpm": 2.0 * math.pi / 60.0},
    "N": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "Nm": {"Nm": 1.0, "Nmm": 1e-3, "mNm": 1e-3, "kNm": 1e3},
    "Pa": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
}
DEPTH, SPEED, RATE, PATH = "depth_m", "speed_m_s", "rate_rad_s", "path_length_m"
GIVEN = {"depth": "m", "speed": "m_s", "rate": "rad_s", "path_length": "m"}
FORCE, VERTICAL, HORIZONTAL, TORQUE, PRESSURE = (
    "force_N",
    "vertical_force_N",
    "horizontal_force_N",
    "torque_Nm",
    "pressure_Pa",
)
MEASURED = {"force": "N", "vertical_force": "N", "horizontal_force": "N", "torque": "Nm", "pressure": "Pa"}
WORDS = {
    FORCE: "against the motion",
    VERTICAL: "upward, on the body",
    HORIZONTAL: "to the right, on the body",
    TORQUE: "against the turning, or clockwise on a body that does not turn",
    PRESSURE: "the force against the motion over area_m2",
}

_SPELLINGS = {
    f"{stem}_{unit}": (f"{stem}_{base}", factor)
    for stem, base in (GIVEN | MEASURED).items()
    for unit, factor in UNITS[base].items()
}
# Names of earlier versions, which are still read, and those that replace them.
SUCCESSORS = {f"way_{unit}": f"path_length_{unit}" for unit in UNITS["m"]}
_MEASURED = {f"{stem}_{base}" for stem, base in MEASURED.items()}


def recognise(name: str) -> tuple[str, float] | None:
    """Column and factor to its unit that a measured name means; None if it is none of a force test."""
    name = plain(name)
    return _SPELLINGS.get(SUCCESSORS.get(name, name))


def is_measured(column: str) -> bool:
    """Whether a column is one that is measured, and not prescribed."""
    return column in _MEASURED


def tells_forces(names: Iterable[str]) -> bool:
    """Whether any of the names is a measured force, torque or pressure of a force test."""
    return any(hit is not None and is_measured(hit[0]) for hit in map(recognise, names))


def spellings() -> list[str]:
    """Every name that a column may have."""
    return list(_SPELLINGS)


def in_words(stems: Iterable[str]) -> str:
    """Columns with the units that each may have, as `depth_m (cm, mm, um)`."""
    bases = GIVEN | MEASURED
    return ", ".join(f"{s}_{bases[s]} ({', '.join(u for u in UNITS[bases[s]] if u != bases[s])})" for s in stems)
