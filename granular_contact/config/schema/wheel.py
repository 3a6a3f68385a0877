"""Schema of a run of one wheel: its slip or torque, and its load, in place of the drives of three joints."""

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
    """How the wheel of a mechanism is driven: at a given slip, or by a given torque.

    At a given slip it starts in its steady motion: sunk as deep as bears the load, in a medium that it rolled through.
    With a torque it starts in static balance. It starts elsewhere where `initial.joints` gives its upright slider a
    position; on a surface that is not level, and beside springs, stops or friction of that slider, where that is at
    home.

    A wheel of the radius r whose axle has the speed v and that turns clockwise at omega has the slip 1 - v / (r omega)
    where its rim is the faster one, else r omega / v - 1: -1 of a locked wheel, 0 of one that rolls, below 1.
    """

    slip: Annotated[float, Field(ge=-1, lt=1)] | None = None
    """Give this and speed_m_s, or torque_Nm."""
    speed_m_s: Positive | None = None
    """Of the axle, to the right, held from the start."""
    torque_Nm: float | None = None
    """Clockwise; the wheel then goes as fast as it can."""
    pull_N: float = 0.0
    """With a torque: force to the left that the carriage pulls against."""
    load_N: Positive | None = None
    """Vertical load of the wheel, its own weight in it; null: the weight of what the upright slider carries."""

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
        """Rate (rad/s, clockwise) of a wheel of this radius (m) at the given slip."""
        assert self.slip is not None
        assert self.speed_m_s is not None
        rim = self.speed_m_s / (1.0 - self.slip) if self.slip >= 0.0 else self.speed_m_s * (1.0 + self.slip)
        return rim / radius


@dataclass(frozen=True)
class Rig:
    """Names of the joints of a wheel's rig, and the shape of the wheel; upward, ahead: 1 or -1, as the sliders grow."""

    shape: WheelShape
    axle: str
    upright: str
    level: str
    upward: float
    ahead: float


def rig_of(model: Model) -> Rig | None:
    """The rig of a mechanism that is one; None of any other."""
    joints = {joint.child: (name, joint) for name, joint in model.all_joints.items()}
    for body, spec in model.all_bodies.items():
        shape = next((s for s in spec.shapes if isinstance(s, WheelShape)), None) if isinstance(spec, Rigid) else None
        if shape is None or body not in joints:
            continue
        (axle, hinge), carriers = joints[body], []
        at = hinge.parent
        while at != GROUND and at in joints:
            carriers.append(joints[at])
            at = joints[at][1].parent
        if hinge.type != "hinge" or len(carriers) != 2 or any(one.type != "slider" for _, one in carriers):
            continue
        if any(one.home_deg != 0.0 for _, one in carriers if one.type == "slider"):
            continue
        found = {one.axis[0] == 0.0: (name, one.axis) for name, one in carriers if one.type == "slider"}
        if set(found) == {True, False} and found[False][1][1] == 0.0:
            (upright, (_, up)), (level, (along, _)) = found[True], found[False]
            return Rig(shape, axle, upright, level, 1.0 if up > 0.0 else -1.0, 1.0 if along > 0.0 else -1.0)
    return None


def wheel_faults(wheel: WheelRun | None, model: Model, driven: Collection[str]) -> Faults:
    """Faults of a wheel's run: a mechanism that has no such wheel, joints that are driven besides."""
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
