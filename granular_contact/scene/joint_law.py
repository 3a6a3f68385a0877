"""What acts in a joint by its own coordinate: spring, damper, ends of its range and dry friction."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

# Of each number the part of the joint's config in which it stands, and how its key begins; the rest of it is the unit.
_KEYS: dict[str, tuple[str, str | tuple[str, ...]]] = {
    "stiffness": ("spring", "stiffness_"),
    "rest": ("spring", "rest_"),
    "lower": ("stops", "lower_"),
    "upper": ("stops", "upper_"),
    "stop_stiffness": ("stops", "stiffness_"),
    "dissipation": ("stops", "dissipation_"),
    "friction": ("friction", ("torque_", "force_")),
    "slip": ("friction", "slip_"),
    "damping_time": ("friction", "damping_time_"),
}


@dataclass(frozen=True)
class JointLaw:
    """What acts in a joint by its own coordinate (rad or m) and rate; torques in N m or forces in N.

    Spring (stiffness, rest) and damper; stops beyond `lower` and `upper`, of stop_stiffness x depth x (1 + dissipation
    x rate of depth); dry friction as a bristle that yields at `slip`, with a damping time (s).
    """

    stiffness: float = 0.0
    rest: float = 0.0
    damping: float = 0.0
    lower: float = -math.inf
    upper: float = math.inf
    stop_stiffness: float = 0.0
    dissipation: float = 0.0
    friction: float = 0.0
    slip: float = 1.0
    damping_time: float = 0.0

    @property
    def has_stops(self) -> bool:
        """Whether the joint has ends of its range."""
        return self.stop_stiffness > 0.0

    @property
    def is_linear(self) -> bool:
        """Whether a spring and a damper are all there is."""
        return not self.has_stops and self.friction == 0.0

    @property
    def is_idle(self) -> bool:
        """Whether nothing acts."""
        return self.is_linear and self.stiffness == 0.0 and self.damping == 0.0


IDLE = JointLaw()


def joint_law(joint: Any) -> JointLaw:
    """The law of a joint of the plane or of space, in SI units of its coordinate."""
    numbers = {
        name: number for name, keys in _KEYS.items() for number in _in_si(getattr(joint, keys[0], None), keys[1])
    }
    return JointLaw(**numbers, damping=next(_in_si(joint, "damping_"), 0.0))


def _in_si(part: Any, begin: str | tuple[str, ...]) -> Iterator[float]:
    """The value of the key that begins so, if there is one."""
    for key in () if part is None else type(part).model_fields:
        if key.startswith(begin):
            yield math.radians(getattr(part, key)) if key.endswith("_deg") else getattr(part, key)
