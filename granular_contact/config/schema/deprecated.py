"""Keys of earlier versions whose angles turned counter-clockwise, and those that replace them: all turn clockwise now.

An old key still works, to the last digit; a notice says what to write instead (`config.deprecated`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pydantic import model_validator

from granular_contact.values.strict import Strict, refusal

# By the type of a joint or shape: old key -> new key.
SUCCESSORS = {
    "weld": {"angle_deg": "home_deg"},
    "slider": {"angle_deg": "home_deg", "axis_deg": "axis"},
    "arc": {"start_deg": "from_deg", "end_deg": "to_deg"},
    "foot": {"angle_deg": "tilt_deg"},
}
_QUARTERS = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}


def successor(old: str, value: float) -> float | list[float]:
    """Value of the new key for that of an old one: the negative angle, or the direction of an axis."""
    if old != "axis_deg":
        return -value if value else 0.0
    quarter = _QUARTERS.get(value % 360.0)
    return list(quarter or (math.cos(math.radians(value)), math.sin(math.radians(value))))


class Renewed(Strict):
    """What takes its old keys too."""

    @model_validator(mode="before")
    @classmethod
    def _renew(cls, value: Any) -> Any:
        """The same with new keys in place of old ones."""
        if not isinstance(value, Mapping):
            return value
        renewed = dict(value)
        for old, new in SUCCESSORS.get(str(value.get("type")), {}).items():
            if old not in renewed:
                continue
            angle = renewed.pop(old)
            if new in renewed:
                raise refusal([((old,), f"stands beside {new}, which replaces it; one of the two is allowed")])
            if isinstance(angle, bool) or not isinstance(angle, int | float) or not math.isfinite(angle):
                raise refusal([((old,), f"got {angle!r}; allowed is a finite number")])
            renewed[new] = successor(old, float(angle))
        return renewed
