"""Checks of a scenario against its mechanism: initial states and drives by joint, shared signals by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from granular_contact.config.schema.drives import TARGETS, AnyDrive, Motion, target
from granular_contact.config.schema.initial import KEYS, Initial
from granular_contact.config.schema.joints import SINGULAR
from granular_contact.config.schema.model import Model
from granular_contact.config.schema.signals import AnySignal, Buehler, Shared, Sine
from granular_contact.config.schema.structure import GROUND
from granular_contact.values.strict import LocalFault, no_such


def initial_faults(initial: Initial, model: Model) -> Iterator[LocalFault]:
    """Faults of an initial state, with paths below the scenario."""
    joints = model.all_joints
    on_ground = {joint.type for joint in joints.values() if joint.parent == GROUND}
    if initial.impact_angle_deg is not None and not on_ground & {"hinge", "weld"}:
        words = f"got {initial.impact_angle_deg:g}, but no hinge and no weld is on the ground: use initial.joints"
        yield ("initial", "impact_angle_deg"), words
    for name, start in (initial.joints or {}).items():
        yield from joint_state_faults(name, start, model, KEYS, "hinges, sliders and free joints")
        pinned = name in joints and joints[name].type != "weld" and joints[name].parent == GROUND
        if pinned and start.angle_deg is not None and initial.impact_angle_deg is not None:
            words = "got this and initial.impact_angle_deg; allowed is one of them"
            yield ("initial", "joints", name, "angle_deg"), words


def joint_state_faults(
    name: str, start: Any, model: Any, keys: Mapping[str, Iterable[str]], allowed: str
) -> Iterator[LocalFault]:
    """Faults of the initial state of one joint, in the plane or in space.

    keys: those of a state, by type of joint; allowed: words for the joints that have one.
    """
    joints, path = model.all_joints, ("initial", "joints", name)
    if name not in joints:
        what = "closes a loop, which follows from the others" if name in model.closures else None
        yield path, f"{name} {what}" if what else no_such("joint", name, joints)
        return
    kind = joints[name].type
    if kind == "weld":
        yield path, f"{name} is a weld, which has no state; allowed are {allowed}"
        return
    given = {key for key in start.model_fields_set if getattr(start, key) is not None}
    for key in sorted(given - set(keys[kind])):
        yield (*path, key), f"{name} is {SINGULAR[kind]}; allowed are {', '.join(keys[kind])}"


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
        kind = joints[name].type
        if isinstance(drive, Motion) and name in model.closures:
            yield (
                path,
                f"{name} closes a loop; a motion drives a joint of the tree: make one of them the closure instead",
            )
        elif kind not in TARGETS.values():
            yield path, f"{name} is {SINGULAR[kind]}, which can't be driven; allowed are hinges and sliders"
        elif kind != TARGETS[key]:
            allowed = ", ".join(k for k, of in TARGETS.items() if of == kind)
            yield (*path, key), f"{name} is {SINGULAR[kind]}; a drive of {SINGULAR[kind]} has one of the keys {allowed}"


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
