"""What of a scene is set from outside while it runs, by name: that of the joint, and the key of its drive."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from granular_contact.scene.types import Scene


@dataclass(frozen=True)
class Control:
    """Something that can be set: the drive of a joint.

    unit: of its name in SI units; start: what is set at the start, in SI units; bounds: of what can be set, in the unit
    of its name.
    """

    joint: str
    unit: float
    start: float
    bounds: tuple[float, float]

    def in_si(self, name: str, value: float) -> float:
        """A value in SI units; name: the control's, an angle's also with radians."""
        return value if name.endswith("_rad") else self.unit * value

    @property
    def bounds_in_si(self) -> tuple[float, float]:
        """Range of what can be set, in SI units."""
        return self.unit * self.bounds[0], self.unit * self.bounds[1]


class Beyond(NamedTuple):
    """How often a control was given beyond the range of its drive, and by how much (SI units) at the most."""

    times: int = 0
    most: float = 0.0

    def and_by(self, excess: float) -> Beyond:
        """The same and once more, by so much."""
        return Beyond(self.times + 1, max(self.most, excess))


def range_warnings(controls: Mapping[str, Control], beyond: Mapping[str, Beyond]) -> Iterator[str]:
    """What was set beyond ranges, of controls by name; beyond: by joint."""
    for name, control in controls.items():
        if (found := beyond.get(control.joint)) is not None:
            times = "once" if found.times == 1 else f"{found.times} times"
            words = f"{name} was given beyond its range, {control.bounds[0]:g} to {control.bounds[1]:g}, {times}"
            yield f"{words}, by {found.most / control.unit:.3g} at the most: it was set to the end of the range"


def controls_of(scene: Scene) -> dict[str, Control]:
    """All controls of a scene by their names, in the order of its drives."""
    found = {}
    for drive in scene.drives:
        if drive.sets:
            unit = math.radians(1.0) if drive.sets == "angle_deg" else 1.0
            least, most = drive.bounds
            bounds = least / unit, most / unit
            found[f"{drive.joint}_{drive.sets}"] = Control(drive.joint, unit, drive.signal.value(0.0), bounds)
    return found
