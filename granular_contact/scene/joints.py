"""Joints between the merged rigid bodies and the flexible links of a laid-out model, with their laws."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from granular_contact.config import schema
from granular_contact.scene.joint_law import actuator_limits, joint_law
from granular_contact.scene.layout import STILL, JointState, Layout, Pose, direction, point
from granular_contact.scene.parts import FlexibleLink, RigidBody, rotation
from granular_contact.scene.types import Joint


def joints_of(
    layout: Layout, bodies: Iterable[RigidBody | FlexibleLink], states: Mapping[str, JointState]
) -> Iterator[Joint]:
    """Joints and closures between bodies that move against each other; welds within a rigid body are left out.

    states: of the joints of the tree.
    """
    merged = {name: (body.name, body.motion) for body in bodies for name in body.name.split("+")}
    pose, closures = layout.pose, layout.model.closures
    for name, joint in (layout.model.all_joints | closures).items():
        parent, parent_frame = merged.get(joint.parent, (None, STILL))
        child, child_frame = merged.get(joint.child, (None, STILL))
        if child == parent:
            continue
        assert child is not None  # `closure_faults` refuses a closure whose child is the ground
        pin = pose[joint.child].world(point(joint.child_point_m))
        # A joint with an axis has another point on the parent than on the child; otherwise both points are the pin.
        on_parent = pin
        start, rate = coordinate(pose, name, joint, states)
        axis, offset = None, 0.0
        if hasattr(joint, "axis"):
            on_parent = pose[joint.parent].world(point(joint.parent_point_m))
            axis = rotation(pose[joint.parent].angle - parent_frame.angle) @ direction(joint)
        if isinstance(joint, schema.HingeClosure):
            offset = start - (parent_frame.angle - child_frame.angle)
            offset = 0.0 if abs(offset) < 1e-12 else offset
        yield Joint(
            name=name,
            kind=joint.type,
            parent=parent,
            parent_point=parent_frame.local(on_parent),
            child=child,
            child_point=child_frame.local(pin),
            axis=axis,
            offset=offset,
            start=start,
            rate=rate,
            closes=name in closures,
            law=joint_law(joint),
            **actuator_limits(joint),
        )


def coordinate(
    pose: Pose, name: str, joint: schema.Joint | schema.Closure, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Initial coordinate (rad or m) of a hinge or slider and its rate; for a closure from the poses of its bodies.

    For other joints they have no meaning.
    """
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
    parent, child = pose[joint.parent], pose[joint.child]
    if isinstance(joint, schema.SliderClosure):
        axis = rotation(parent.angle) @ direction(joint)
        pin = child.world(point(joint.child_point_m))
        along = float(axis @ (pin - parent.world(point(joint.parent_point_m))))
        return along, float(axis @ (child.speed_at(pin) - parent.speed_at(pin)))
    if isinstance(joint, schema.HingeClosure):
        # Poses do not show the number of whole turns: the angle is the one between -pi and pi.
        angle = parent.angle - child.angle
        return angle - 2.0 * math.pi * round(angle / (2.0 * math.pi)), parent.rate - child.rate
    return 0.0, 0.0
