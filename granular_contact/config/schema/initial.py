"""Schema of the start of a run: angles, positions and rates of joints, or the impact of a pendulum.

With it the checks of a scenario against its mechanism: initial states and drives by joint, shared signals by name.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Annotated, Any

from pydantic import Field

from granular_contact.config.schema.drives import TARGETS, AnyDrive, Motion, target
from granular_contact.config.schema.joints import MOVABLE, joint_of, joints_of
from granular_contact.config.schema.model import GROUND, Model
from granular_contact.config.schema.signals import AnySignal, Buehler, Shared, Sine
from granular_contact.values.strict import Faults, LocalFault, Strict, no_such


class JointStart(Strict):
    """State of one joint, in its own coordinate; what is left out is that of rest in the reference configuration."""

    angle_deg: float | None = None
    """Of a hinge, clockwise; of a free body, below the horizontal."""
    rate_rad_s: float | None = None
    position_m: float | None = None
    """Of a slider, along its axis."""
    speed_m_s: float | None = None
    x_m: float | None = None
    """Of a free body: position of its joint, from the joint's point on the ground."""
    y_m: float | None = None
    vx_m_s: float | None = None
    """Of a free body: velocity of its joint's point."""
    vy_m_s: float | None = None

    @property
    def height(self) -> float | None:
        """Of a free body (m), if it is given."""
        return self.y_m


RATES = ("rate_rad_s", "speed_m_s", "vx_m_s", "vy_m_s")


class Initial(Strict):
    """Initial state: the undeformed mechanism, with given states of its joints."""

    impact_angle_deg: Annotated[float, Field(ge=-90, le=90)] | None = None
    """Angle below the horizontal of what is hinged or welded to the ground; null: that of the reference
    configuration."""
    impact_speed_rad_s: float = 0.0
    """Rate of the ground hinge; a positive one moves the link into the medium."""
    impact_tip_speed_m_s: float | None = None
    """The same, given as the speed of the tip, the farthest end of the mechanism."""
    joints: dict[str, JointStart] | None = None
    """By the name of the joint; others start at rest in the reference configuration, or follow a loop or a drive."""
    settle: bool = False
    """Start from static equilibrium under gravity, with the drives as they are at t = 0."""

    def _faults(self) -> Faults:
        if self.impact_tip_speed_m_s is not None and self.impact_speed_rad_s != 0.0:
            yield ("impact_tip_speed_m_s",), "got both this and impact_speed_rad_s; allowed is one of them"
        if self.settle:
            yield from speed_faults(self, (), ("impact_speed_rad_s", "impact_tip_speed_m_s"))
            for name, start in (self.joints or {}).items():
                yield from speed_faults(start, ("joints", name), RATES)


def speed_faults(start: Strict, path: tuple[str, ...], keys: Iterable[str]) -> Faults:
    """Faults of speeds with which a run would start that begins from static equilibrium."""
    for key in keys:
        if (value := getattr(start, key)) not in (None, 0.0, (0.0, 0.0, 0.0)):
            got = f"{value:g}" if isinstance(value, float) else f"{list(value)}"
            yield (*path, key), f"got {got}, but settle is true: allowed is 0"


def initial_faults(initial: Initial, model: Model) -> Iterator[LocalFault]:
    """Faults of an initial state, with paths below the scenario."""
    joints = model.all_joints
    on_ground = {joint.type for joint in joints.values() if joint.parent == GROUND}
    if initial.impact_angle_deg is not None and not on_ground & {"hinge", "weld"}:
        words = f"got {initial.impact_angle_deg:g}, but no hinge and no weld is on the ground: use initial.joints"
        yield ("initial", "impact_angle_deg"), words
    for name, start in (initial.joints or {}).items():
        yield from joint_state_faults(name, start, model, joints_of(MOVABLE))
        pinned = name in joints and joints[name].type != "weld" and joints[name].parent == GROUND
        if pinned and start.angle_deg is not None and initial.impact_angle_deg is not None:
            words = "got this and initial.impact_angle_deg; allowed is one of them"
            yield ("initial", "joints", name, "angle_deg"), words


def joint_state_faults(name: str, start: Any, model: Any, allowed: str) -> Iterator[LocalFault]:
    """Faults of the initial state of one joint, in the plane or in space; allowed: words for joints that have one."""
    joints, path = model.all_joints, ("initial", "joints", name)
    if name not in joints:
        what = "closes a loop, which follows from the others" if name in model.closures else None
        yield path, f"{name} {what}" if what else no_such("joint", name, joints)
        return
    kind, keys = joint_of(joints[name].type), joints[name].start_keys
    if not keys:
        yield path, f"{name} is a {kind}, which has no state; allowed are {allowed}"
        return
    given = {key for key in start.model_fields_set if getattr(start, key) is not None}
    for key in sorted(given - set(keys)):
        yield (*path, key), f"{name} is a {kind}; allowed are {', '.join(keys)}"


def drive_faults(drives: Mapping[str, AnyDrive], signals: Mapping[str, AnySignal], model: Any) -> Iterator[LocalFault]:
    """Faults of the drives and the signals that they share, with paths below the scenario; in the plane or in space."""
    joints = model.all_joints | model.closures
    for name, signal in signals.items():
        if isinstance(signal, Shared):
            yield ("signals", name), f"got the name {signal.name!r}; allowed is a signal with a type"
    for name, drive in drives.items():
        path, key = ("drives", name), target(drive)
        signal = getattr(drive, key)
        if isinstance(signal, Shared):
            yield from _shared_faults((*path, key), signal, signals)
        if name not in joints:
            yield path, no_such("joint", name, joints)
            continue
        kind, what = joints[name].type, joint_of(joints[name].type)
        if isinstance(drive, Motion) and name in model.closures:
            yield (
                path,
                f"{name} closes a loop; a motion drives a joint of the tree: make one of them the closure instead",
            )
        elif kind not in TARGETS.values():
            yield path, f"{name} is a {what}, which can't be driven; allowed are hinges and sliders"
        elif kind != TARGETS[key]:
            allowed = ", ".join(k for k, of in TARGETS.items() if of == kind)
            yield (*path, key), f"{name} is a {what}; a drive of a {what} has one of the keys {allowed}"


def unused_signals(drives: Mapping[str, AnyDrive], signals: Mapping[str, AnySignal]) -> list[str]:
    """Names of the shared signals that no drive follows."""
    followed = (getattr(drive, target(drive)) for drive in drives.values())
    used = {signal.name for signal in followed if isinstance(signal, Shared)}
    return [name for name in signals if name not in used]


def _shared_faults(path: tuple[str, ...], shared: Shared, signals: Mapping[str, AnySignal]) -> Iterator[LocalFault]:
    signal = signals.get(shared.name)
    if signal is None:
        yield path, no_such("signal", shared.name, signals)
    elif isinstance(signal, Buehler) and path[-1] != "angle_deg":
        yield path, f"{shared.name} is a buehler clock, which gives angles; allowed are the other signals"
    elif shared.phase_deg != 0.0 and not isinstance(signal, Buehler | Sine):
        words = f"got {shared.phase_deg:g}, but {shared.name} is a {signal.type}: allowed is 0"
        yield (*path, "phase_deg"), words
