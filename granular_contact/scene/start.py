"""Initial states of joints: the reference configuration, the values of the run, or those of a prescribed motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from granular_contact.config import schema
from granular_contact.errors import Fault, scene_fault
from granular_contact.scene.types import Drive

# What a start may differ by from a prescribed motion (rad, m, rad/s, m/s): the digits of a config.
AGREEMENT = 1e-6


@dataclass(frozen=True)
class Start:
    """States of the tree's joints; names of those whose coordinate (placed) or rate (moved) a run or drive gives."""

    states: dict[str, Any]  # `JointState`, in space that of its layout
    placed: frozenset[str]
    moved: frozenset[str]


class Said(NamedTuple):
    """State of a joint as the run gives it, and whether its coordinate and its rate were given."""

    state: Any  # of `Start.states`
    has_place: bool
    has_rate: bool


def begun(
    scenario: schema.Scenario, drives: tuple[Drive, ...], said: Callable[[str, Any], Said], faults: list[Fault]
) -> Start:
    """Initial states of joints as a run gives them (said), or as drives begin; in the plane or in space."""
    driven = {drive.joint: drive for drive in drives}
    states, placed, moved = {}, set(), set()
    for name, joint in scenario.model.all_joints.items():
        if joint.type == "weld":
            continue
        own = said(name, joint)
        state, has_place, has_rate = own
        drive = driven.get(name)
        if drive is not None and drive.kind == "motion":
            state = replace(state.at(drive.signal.value(0.0)), rates=np.array([drive.signal.rate(0.0)]))
            faults += _gaps(name, joint, own, state)
            has_place = has_rate = True
            if scenario.initial.settle and state.rates[0] != 0.0:
                words = (
                    f"the motion starts at {state.rates[0]:.6g} rad/s or m/s, but initial.settle is true: allowed is 0"
                )
                faults.append(scene_fault(f"drives.{name}", words))
        elif drive is not None and drive.kind == "control" and not drive.of_rate and not has_place:
            state, has_place = state.at(drive.signal.value(0.0)), True
        states[name] = state
        placed |= {name} if has_place else set()
        moved |= {name} if has_rate else set()
    return Start(states, frozenset(placed), frozenset(moved))


def home(joint: Any) -> float:
    """Coordinate (rad, m) of a hinge or slider, in the plane or in space, in the reference configuration."""
    return math.radians(joint.home_deg) if joint.type == "hinge" else float(joint.home_m)


def _gaps(name: str, joint: Any, own: Said, follows: Any) -> Iterator[Fault]:
    """Differences between what the run says and what a prescribed motion starts with."""
    hinge = joint.type == "hinge"
    unit = math.degrees(1.0) if hinge else 1.0
    keys = ("angle_deg", "rate_rad_s") if hinge else ("position_m", "speed_m_s")
    asked = (
        (own.has_place, keys[0], unit, own.state.coordinate, follows.coordinate),
        (own.has_rate, keys[1], 1.0, float(own.state.rates[0]), float(follows.rates[0])),
    )
    for given, key, factor, got, expected in asked:
        if given and abs(got - expected) > AGREEMENT:
            words = f"got {factor * got:g}, but the drive of {name} starts at {factor * expected:g}, "
            words += f"{factor * abs(got - expected):.3g} away: allowed is that, or no value"
            yield scene_fault(f"initial.joints.{name}.{key}", words)
