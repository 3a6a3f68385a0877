"""Initial states of joints: from the reference configuration, the values of the run, or a prescribed motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.types import Drive

# Allowed difference between the start of a run and of a prescribed motion (rad, m, rad/s, m/s): rounding in a config.
AGREEMENT = 1e-6


@dataclass(frozen=True)
class InitialStates:
    """Initial states of the joints of the tree.

    with_coordinate, with_rate: names of the joints whose coordinate or rate is given by the run or by a drive.
    """

    states: dict[str, Any]  # `JointState` of the layout, in the plane or in space
    with_coordinate: frozenset[str]
    with_rate: frozenset[str]


class RunState(NamedTuple):
    """Initial state of a joint by the run, and whether the run gives its coordinate and its rate."""

    state: Any  # as in `InitialStates.states`
    gives_coordinate: bool
    gives_rate: bool


def states_with_drives(
    scenario: schema.Scenario, drives: tuple[Drive, ...], run_state: Callable[[str, Any], RunState], faults: list[Fault]
) -> InitialStates:
    """Initial states of the joints by the run (run_state) and by the first values of drives; in the plane or in space.

    A prescribed motion sets coordinate and rate of its joint; a fault is appended where the run gives others. A control
    of the coordinate sets the coordinate, if the run does not.
    """
    drive_of = {drive.joint: drive for drive in drives}
    states, with_coordinate, with_rate = {}, set(), set()
    for name, joint in scenario.model.all_joints.items():
        if joint.type == "weld":
            continue
        given = run_state(name, joint)
        state, has_coordinate, has_rate = given
        drive = drive_of.get(name)
        if drive is not None and drive.kind == "motion":
            state = replace(state.at(drive.signal.value(0.0)), rates=np.array([drive.signal.rate(0.0)]))
            faults += _contradictions(name, joint, given, state)
            has_coordinate = has_rate = True
            if scenario.initial.settle and state.rates[0] != 0.0:
                words = (
                    f"the motion starts at {state.rates[0]:.6g} rad/s or m/s, but initial.settle is true: allowed is 0"
                )
                faults.append(scene_fault(f"drives.{name}", words))
        elif drive is not None and drive.kind == "control" and not drive.of_rate and not has_coordinate:
            state, has_coordinate = state.at(drive.signal.value(0.0)), True
        states[name] = state
        with_coordinate |= {name} if has_coordinate else set()
        with_rate |= {name} if has_rate else set()
    return InitialStates(states, frozenset(with_coordinate), frozenset(with_rate))


def home(joint: Any) -> float:
    """Coordinate (rad, m) of a hinge or slider in the reference configuration, in the plane or in space."""
    return math.radians(joint.home_deg) if joint.type == "hinge" else float(joint.home_m)


def _contradictions(name: str, joint: Any, given: RunState, prescribed: Any) -> Iterator[Fault]:
    """Faults of a coordinate or rate that the run gives, and that differs from the state prescribed by a motion."""
    hinge = joint.type == "hinge"
    unit = math.degrees(1.0) if hinge else 1.0
    keys = ("angle_deg", "rate_rad_s") if hinge else ("position_m", "speed_m_s")
    compared = (
        (given.gives_coordinate, keys[0], unit, given.state.coordinate, prescribed.coordinate),
        (given.gives_rate, keys[1], 1.0, float(given.state.rates[0]), float(prescribed.rates[0])),
    )
    for is_given, key, factor, got, expected in compared:
        if is_given and abs(got - expected) > AGREEMENT:
            words = f"got {factor * got:g}, but the drive of {name} starts at {factor * expected:g}, "
            words += f"{factor * abs(got - expected):.3g} away: allowed is that, or no value"
            yield scene_fault(f"initial.joints.{name}.{key}", words)
