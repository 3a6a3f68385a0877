"""Schema of a single-wheel test: slip or torque of a wheel, and its load, in place of the drives of three joints."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from granular_contact.config.schema.mechanism import Rigid
from granular_contact.config.schema.model import GROUND, Model
from granular_contact.config.schema.shapes import WheelShape
from granular_contact.values.strict import Faults, Positive, Strict

NEEDS = "a wheel hangs on the ground by a level slider, an upright slider and a hinge, as in models/wheel.yaml"


class WheelRun(Strict):
    """Single-wheel test: the wheel of a mechanism is driven at a given slip, or by a given torque.

    Slip of a wheel with radius r, clockwise rate omega and speed v of the axle: 1 - v / (r omega) if the rim is faster
    than the axle, else r omega / v - 1. It is -1 for a locked wheel, 0 for a rolling wheel, and below 1.

    With a given slip the wheel starts in steady motion: at the sinkage that bears the load, in a medium through which
    it has already rolled. With a given torque it starts in static equilibrium. The upright slider starts at another
    position if `initial.joints` gives one. It starts at home on a surface that is not level, or if it has a spring,
    stops or friction.
    """

    slip: Annotated[float, Field(ge=-1, lt=1)] | None = None
    """Slip of the wheel. Give this with speed_m_s, or give torque_Nm."""
    speed_m_s: Positive | None = None
    """Speed of the axle, to the right, constant from the start; with slip."""
    torque_Nm: float | None = None
    """Torque on the wheel, clockwise. The speed of the wheel follows from it."""
    pull_N: float = 0.0
    """Force to the left on the carriage, against which the wheel pulls; with torque_Nm."""
    load_N: Positive | None = None
    """Vertical load of the wheel, including its own weight. null: the weight of everything that the upright slider
    carries."""

    def _faults(self) -> Faults:
        if (self.slip is None) == (self.torque_Nm is None):
            got = "both" if self.slip is not None else "neither"
            yield (), f"got {got} of slip and torque_Nm; exactly one is allowed"
        elif self.slip is not None and self.speed_m_s is None:
            yield ("speed_m_s",), "is missing; a given slip needs the speed of the axle"
        elif self.slip is None and self.speed_m_s is not None:
            yield ("speed_m_s",), f"got {self.speed_m_s:g}, but the torque is given: allowed is null"
        if self.slip is not None and self.pull_N != 0.0:
            yield ("pull_N",), f"got {self.pull_N:g}, but the slip is given: allowed is 0"

    def rate(self, radius: float) -> float:
        """Rate (rad/s, clockwise) of a wheel with this radius (m) at the given slip and speed."""
        assert self.slip is not None
        assert self.speed_m_s is not None
        rim = self.speed_m_s / (1.0 - self.slip) if self.slip >= 0.0 else self.speed_m_s * (1.0 + self.slip)
        return rim / radius


@dataclass(frozen=True)
class Rig:
    """Joints of a single-wheel rig, and the shape of its wheel.

    axle, upright, level: names of the hinge and of the two sliders. upward: 1 if the coordinate of the upright slider
    grows upward, else -1. ahead: 1 if the coordinate of the level slider grows to the right, else -1.
    """

    shape: WheelShape
    axle: str
    upright: str
    level: str
    upward: float
    ahead: float


def rig_of(model: Model) -> Rig | None:
    """The single-wheel rig of a mechanism; None if the mechanism is none.

    A rig is a body with a wheel shape on a hinge, which an upright and a level slider connect to the ground.
    """
    joints = {joint.child: (name, joint) for name, joint in model.all_joints.items()}
    for body, spec in model.all_bodies.items():
        shape = next((s for s in spec.shapes if isinstance(s, WheelShape)), None) if isinstance(spec, Rigid) else None
        if shape is None or body not in joints:
            continue
        (axle, hinge), carriers = joints[body], []
        parent = hinge.parent
        while parent != GROUND and parent in joints:
            carriers.append(joints[parent])
            parent = joints[parent][1].parent
        if hinge.type != "hinge" or len(carriers) != 2 or any(joint.type != "slider" for _, joint in carriers):
            continue
        if any(joint.home_deg != 0.0 for _, joint in carriers if joint.type == "slider"):
            continue
        axes = {joint.axis[0] == 0.0: (name, joint.axis) for name, joint in carriers if joint.type == "slider"}
        if set(axes) == {True, False} and axes[False][1][1] == 0.0:
            (upright, (_, up)), (level, (along, _)) = axes[True], axes[False]
            return Rig(shape, axle, upright, level, 1.0 if up > 0.0 else -1.0, 1.0 if along > 0.0 else -1.0)
    return None


def wheel_faults(wheel: WheelRun | None, model: Model, driven: Collection[str]) -> Faults:
    """Faults of a single-wheel test: the mechanism is no rig, or another drive acts on a joint of the rig."""
    if wheel is None:
        return
    rig = rig_of(model)
    if rig is None:
        yield (
            ("wheel",),
            f"stands beside the model {model.name}, which has no shape of the type wheel on such a rig; {NEEDS}",
        )
        return
    for name in (rig.axle, rig.upright, rig.level):
        if name in driven:
            yield ("drives", name), "stands beside wheel, which drives this joint; allowed is one of the two"
