"""Joints of a laid-out model between the merged rigid bodies, and the forces that act in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
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
        assert child is not None  # closures the wrong way round are refused before
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
    if joint.type == "hinge":
        turn = math.radians(1.0)
        spring, stops, friction = joint.spring, joint.stops, joint.friction
        return JointLaw(
            stiffness=0.0 if spring is None else spring.stiffness_Nm_per_rad,
            rest=0.0 if spring is None else spring.rest_deg * turn,
            damping=joint.damping_Nm_s_per_rad,
            lower=-math.inf if stops is None else stops.lower_deg * turn,
            upper=math.inf if stops is None else stops.upper_deg * turn,
            stop_stiffness=0.0 if stops is None else stops.stiffness_Nm_per_rad,
            dissipation=0.0 if stops is None else stops.dissipation_s_per_rad,
            friction=0.0 if friction is None else friction.torque_Nm,
            slip=1.0 if friction is None else friction.slip_deg * turn,
            damping_time=0.0 if friction is None else friction.damping_time_s,
        )
    if joint.type == "slider":
        rod, ends, rub = joint.spring, joint.stops, joint.friction
        return JointLaw(
            stiffness=0.0 if rod is None else rod.stiffness_N_per_m,
            rest=0.0 if rod is None else rod.rest_m,
            damping=joint.damping_N_s_per_m,
            lower=-math.inf if ends is None else ends.lower_m,
            upper=math.inf if ends is None else ends.upper_m,
            stop_stiffness=0.0 if ends is None else ends.stiffness_N_per_m,
            dissipation=0.0 if ends is None else ends.dissipation_s_per_m,
            friction=0.0 if rub is None else rub.force_N,
            slip=1.0 if rub is None else rub.slip_m,
            damping_time=0.0 if rub is None else rub.damping_time_s,
        )
    if joint.type == "ball":
        return _ball_law(joint)
    return JointLaw()


def _ball_law(joint: Any) -> JointLaw:
    """Of a joint of space, by the angle of its rotation from home."""
    spring, stops = joint.spring, joint.stops
    return JointLaw(
        stiffness=0.0 if spring is None else spring.stiffness_Nm_per_rad,
        damping=joint.damping_Nm_s_per_rad,
        upper=math.inf if stops is None else math.radians(stops.upper_deg),
        stop_stiffness=0.0 if stops is None else stops.stiffness_Nm_per_rad,
        dissipation=0.0 if stops is None else stops.dissipation_s_per_rad,
    )
