"""Joints of a laid-out model between the merged rigid bodies, and the forces that act in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from granular_contact.config import schema
from granular_contact.scene.layout import ZERO, Frame, JointState, Layout, direction, point
from granular_contact.scene.types import Joint, JointLaw, RigidBody, Vector, rotation


def joints_of(layout: Layout, rigid: tuple[RigidBody, ...], states: Mapping[str, JointState]) -> Iterator[Joint]:
    """Joints and closures between what moves on its own.

    states: of the joints of the tree.
    """
    homes: dict[str, tuple[str | None, Frame]] = {name: (name, frame) for name, frame in layout.frames.items()}
    merged = {body.name: body for body in rigid}
    for group in layout.groups:
        body = merged.get("+".join(group))
        home = (None, Frame(ZERO, 0.0)) if body is None else (body.name, Frame(body.motion.position, body.motion.angle))
        homes |= dict.fromkeys(group, home)
    loops = layout.model.closures
    for name, joint in (layout.model.all_joints | loops).items():
        parent, parent_frame = homes[joint.parent]
        child, child_frame = homes[joint.child]
        if child == parent:
            continue
        assert child is not None  # closures with child and parent swapped are refused before
        pin = layout.frames[joint.child].world(point(joint.child_point_m))
        # The points of a slider stay where they are on their bodies; elsewhere both are the pin.
        at = pin if not isinstance(joint, schema.SliderClosure) else _origin(layout, joint)
        start, rate = coordinate(layout, name, joint, states)
        axis, offset = None, 0.0
        if isinstance(joint, schema.SliderClosure):
            axis = rotation(layout.frames[joint.parent].angle - parent_frame.angle) @ direction(joint)
        elif isinstance(joint, schema.HingeClosure):
            offset = start - (parent_frame.angle - child_frame.angle)
            offset = 0.0 if abs(offset) < 1e-12 else offset
        yield Joint(
            name=name,
            kind=joint.type,
            parent=parent,
            parent_point=parent_frame.local(at),
            child=child,
            child_point=child_frame.local(pin),
            axis=axis,
            offset=offset,
            start=start,
            rate=rate,
            closes=name in loops,
            law=law(joint),
        )


def _origin(layout: Layout, joint: schema.SliderClosure) -> Vector:
    return layout.frames[joint.parent].world(point(joint.parent_point_m))


def coordinate(
    layout: Layout, name: str, joint: schema.Joint | schema.Closure, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Coordinate of a hinge or slider at the start, and its rate; of a closure from the bodies that it joins."""
    if name in states:
        return float(states[name].value[0]), float(states[name].rate[0])
    parent, child = (layout.frames[body] for body in (joint.parent, joint.child))
    motions = layout.pose.twists[joint.parent], layout.pose.twists[joint.child]
    if isinstance(joint, schema.SliderClosure):
        axis = rotation(parent.angle) @ direction(joint)
        pin = child.world(point(joint.child_point_m))
        along = float(axis @ (pin - parent.world(point(joint.parent_point_m))))
        return along, float(axis @ (motions[1].at(pin) - motions[0].at(pin)))
    if isinstance(joint, schema.HingeClosure):
        # Which turn it is in can't be known: the one nearest to zero.
        turned = parent.angle - child.angle
        return turned - 2.0 * math.pi * round(turned / (2.0 * math.pi)), motions[0].rate - motions[1].rate
    return 0.0, 0.0


def law(joint: Any) -> JointLaw:
    """What acts in a joint of the plane or of space, in SI units of its coordinate."""
    match joint.type:
        case "hinge":
            return _hinge_law(joint)
        case "slider":
            return _slider_law(joint)
        case "ball":
            return _ball_law(joint)
    return JointLaw()


def _hinge_law(joint: Any) -> JointLaw:
    made = JointLaw(damping=joint.damping_Nm_s_per_rad)
    if (spring := joint.spring) is not None:
        made = replace(made, stiffness=spring.stiffness_Nm_per_rad, rest=math.radians(spring.rest_deg))
    if (stops := joint.stops) is not None:
        made = replace(
            made,
            lower=math.radians(stops.lower_deg),
            upper=math.radians(stops.upper_deg),
            stop_stiffness=stops.stiffness_Nm_per_rad,
            dissipation=stops.dissipation_s_per_rad,
        )
    if (friction := joint.friction) is not None:
        slip, damping_time = math.radians(friction.slip_deg), friction.damping_time_s
        made = replace(made, friction=friction.torque_Nm, slip=slip, damping_time=damping_time)
    return made


def _slider_law(joint: Any) -> JointLaw:
    made = JointLaw(damping=joint.damping_N_s_per_m)
    if (spring := joint.spring) is not None:
        made = replace(made, stiffness=spring.stiffness_N_per_m, rest=spring.rest_m)
    if (stops := joint.stops) is not None:
        made = replace(
            made,
            lower=stops.lower_m,
            upper=stops.upper_m,
            stop_stiffness=stops.stiffness_N_per_m,
            dissipation=stops.dissipation_s_per_m,
        )
    if (friction := joint.friction) is not None:
        slip, damping_time = friction.slip_m, friction.damping_time_s
        made = replace(made, friction=friction.force_N, slip=slip, damping_time=damping_time)
    return made


def _ball_law(joint: Any) -> JointLaw:
    """Of a joint of space, by the angle of its rotation from home."""
    made = JointLaw(damping=joint.damping_Nm_s_per_rad)
    if (spring := joint.spring) is not None:
        made = replace(made, stiffness=spring.stiffness_Nm_per_rad)
    if (stops := joint.stops) is not None:
        made = replace(
            made,
            upper=math.radians(stops.upper_deg),
            stop_stiffness=stops.stiffness_Nm_per_rad,
            dissipation=stops.dissipation_s_per_rad,
        )
    return made
