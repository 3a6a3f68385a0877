"""Law of a joint, a function of its coordinate: spring, damper, stops and dry friction; limits of its actuator."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

# For each field of `JointLaw`: the section of the joint's config, and how the key begins; the key ends with the unit.
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
    """Torques (N m) or forces (N) in a joint by its coordinate (rad or m) and its rate.

    Spring (stiffness, rest) and damper (damping). Stops beyond `lower` and `upper`, with the torque or force
    stop_stiffness x depth x (1 + dissipation x rate of depth). Dry friction by a bristle that yields at the deflection
    `slip`, with a damping time (s).
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
        """Whether the joint has stops."""
        return self.stop_stiffness > 0.0

    @property
    def is_linear(self) -> bool:
        """Whether the law has neither stops nor friction, at most a spring and a damper."""
        return not self.has_stops and self.friction == 0.0

    @property
    def is_idle(self) -> bool:
        """Whether the law gives no torque or force at all."""
        return self.is_linear and self.stiffness == 0.0 and self.damping == 0.0


IDLE = JointLaw()


def joint_law(joint: Any) -> JointLaw:
    """Law of a joint of a config, in the plane or in space, in SI units of its coordinate."""
    numbers = {
        name: number
        for name, (section, prefix) in _KEYS.items()
        for number in _in_si(getattr(joint, section, None), prefix)
    }
    return JointLaw(**numbers, damping=next(_in_si(joint, "damping_"), 0.0))


def actuator_limits(joint: Any) -> dict[str, float]:
    """Fields `effort_limit` and `rate_limit` of a joint of a scene, from a joint of a config; infinite if not given."""
    prefixes = (("effort_limit", ("effort_limit_",)), ("rate_limit", ("rate_limit_", "speed_limit_")))
    return {field: next(filter(None, _in_si(joint, prefix)), math.inf) for field, prefix in prefixes}


def _in_si(section: Any, prefix: str | tuple[str, ...]) -> Iterator[float]:
    """Values in SI units of the keys of a section that begin with a prefix, None as given; none without a section."""
    for key in () if section is None else type(section).model_fields:
        if key.startswith(prefix):
            yield math.radians(getattr(section, key)) if key.endswith("_deg") else getattr(section, key)
