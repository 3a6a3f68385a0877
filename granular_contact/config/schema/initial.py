"""Schema of the initial state of a run: angles, positions and rates of joints, or the impact of a pendulum.

Also checks of a scenario against its mechanism: whether the joints that have an initial state or a drive exist and
allow it, and whether shared signals exist.
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
    """Initial state of one joint, in its own coordinate. null: at rest in the reference configuration (home)."""

    angle_deg: float | None = None
    """Hinge: angle of the joint, clockwise. Free body: angle of its x axis below the horizontal."""
    rate_rad_s: float | None = None
    """Hinge or free body: angular rate, clockwise."""
    position_m: float | None = None
    """Slider: position along its axis."""
    speed_m_s: float | None = None
    """Slider: speed along its axis."""
    x_m: float | None = None
    """Free body: horizontal position of its joint point, measured from the point of the joint on the ground."""
    y_m: float | None = None
    """Free body: vertical position of its joint point, upward from the point of the joint on the ground."""
    vx_m_s: float | None = None
    """Free body: horizontal velocity of its joint point."""
    vy_m_s: float | None = None
    """Free body: vertical velocity of its joint point, upward."""

    @property
    def height(self) -> float | None:
        """Height of a free body (m); None if it is not given."""
        return self.y_m


RATES = ("rate_rad_s", "speed_m_s", "vx_m_s", "vy_m_s")


class Initial(Strict):
    """Initial state: the undeformed mechanism, with given positions and velocities of its joints."""

    impact_angle_deg: Annotated[float, Field(ge=-90, le=90)] | None = None
    """Initial angle of the hinges on the ground, below the horizontal. A body that is welded to the ground is turned by
    this angle, in addition to its home_deg. null: the reference configuration (home)."""
    impact_speed_rad_s: float = 0.0
    """Initial angular rate of the hinges on the ground, clockwise: positive moves a link down into the medium."""
    impact_tip_speed_m_s: float | None = None
    """Initial speed of the tip, the end of the mechanism that is farthest from the hinge on the ground, positive for a
    clockwise rate; in place of impact_speed_rad_s. null: impact_speed_rad_s holds."""
    joints: dict[str, JointStart] | None = None
    """Initial states by the name of the joint. A joint that is not named starts at rest in the reference configuration
    (home), or follows from a loop or a drive."""
    settle: bool = False
    """true: first find the static equilibrium under gravity, and start the run from there at rest. Signals of drives
    keep their value at t = 0 meanwhile."""

    def _faults(self) -> Faults:
        if self.impact_tip_speed_m_s is not None and self.impact_speed_rad_s != 0.0:
            yield ("impact_tip_speed_m_s",), "got both this and impact_speed_rad_s; allowed is one of them"
        if self.settle:
            yield from speed_faults(self, (), ("impact_speed_rad_s", "impact_tip_speed_m_s"))
            for name, start in (self.joints or {}).items():
                yield from speed_faults(start, ("joints", name), RATES)


def speed_faults(start: Strict, path: tuple[str, ...], keys: Iterable[str]) -> Faults:
    """Faults of initial speeds of a run that starts from static equilibrium: none but 0 is allowed."""
    for key in keys:
        if (value := getattr(start, key)) not in (None, 0.0, (0.0, 0.0, 0.0)):
            got = f"{value:g}" if isinstance(value, float) else f"{list(value)}"
            yield (*path, key), f"got {got}, but settle is true: allowed is 0"


def initial_faults(initial: Initial, model: Model) -> Iterator[LocalFault]:
    """Faults of an initial state, with paths below the scenario."""
    joints = model.all_joints
    on_ground = {joint.type for joint in joints.values() if joint.parent == GROUND}
    if initial.impact_angle_deg is not None and not on_ground & {"hinge", "weld"}:
        message = f"got {initial.impact_angle_deg:g}, but no hinge and no weld is on the ground: use initial.joints"
        yield ("initial", "impact_angle_deg"), message
    for name, start in (initial.joints or {}).items():
        yield from joint_state_faults(name, start, model, joints_of(MOVABLE))
        pinned = name in joints and joints[name].type != "weld" and joints[name].parent == GROUND
        if pinned and start.angle_deg is not None and initial.impact_angle_deg is not None:
            message = "got this and initial.impact_angle_deg; allowed is one of them"
            yield ("initial", "joints", name, "angle_deg"), message


def joint_state_faults(name: str, start: Any, model: Any, allowed: str) -> Iterator[LocalFault]:
    """Faults of the initial state of one joint, in the plane or in space.

    allowed: the types of joints that may have an initial state, in words for the message.
    """
    joints, path = model.all_joints, ("initial", "joints", name)
    if name in model.closures and name not in joints:
        yield path, f"{name} closes a loop, so its state follows from the other joints; allowed are joints of the tree"
        return
    if name not in joints:
        yield path, no_such("joint", name, joints)
        return
    kind, keys = joint_of(joints[name].type), joints[name].start_keys
    if not keys:
        yield path, f"{name} is a {kind}, which has no state; allowed are {allowed}"
        return
    given = {key for key in start.model_fields_set if getattr(start, key) is not None}
    for key in sorted(given - set(keys)):
        yield (*path, key), f"{name} is a {kind}; allowed are {', '.join(keys)}"


def drive_faults(drives: Mapping[str, AnyDrive], signals: Mapping[str, AnySignal], model: Any) -> Iterator[LocalFault]:
    """Faults of the drives and of shared signals, with paths below the scenario; in the plane or in space."""
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
        kind, noun = joints[name].type, joint_of(joints[name].type)
        if isinstance(drive, Motion) and name in model.closures:
            yield (
                path,
                f"{name} closes a loop; a motion drives a joint of the tree: make one of them the closure instead",
            )
        elif kind not in TARGETS.values():
            yield path, f"{name} is a {noun}, which can't be driven; allowed are hinges and sliders"
        elif kind != TARGETS[key]:
            allowed = ", ".join(key for key, joint_type in TARGETS.items() if joint_type == kind)
            yield (*path, key), f"{name} is a {noun}; a drive of a {noun} has one of the keys {allowed}"


def unused_signals(drives: Mapping[str, AnyDrive], signals: Mapping[str, AnySignal]) -> list[str]:
    """Names of the shared signals that no drive uses."""
    driving = (getattr(drive, target(drive)) for drive in drives.values())
    used = {signal.name for signal in driving if isinstance(signal, Shared)}
    return [name for name in signals if name not in used]


def _shared_faults(path: tuple[str, ...], shared: Shared, signals: Mapping[str, AnySignal]) -> Iterator[LocalFault]:
    """Faults of a drive, at `path`, that refers to a shared signal."""
    signal = signals.get(shared.name)
    if signal is None:
        yield path, no_such("signal", shared.name, signals)
    elif isinstance(signal, Buehler) and path[-1] != "angle_deg":
        yield path, f"{shared.name} is a buehler clock, which gives angles; allowed are the other signals"
    elif shared.phase_deg != 0.0 and not isinstance(signal, Buehler | Sine):
        message = f"got {shared.phase_deg:g}, but {shared.name} is a {signal.type}: allowed is 0"
        yield (*path, "phase_deg"), message
