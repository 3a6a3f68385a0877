"""Joints of a laid-out model between the merged rigid bodies, and the forces that act in them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping

from granular_contact.config import schema
from granular_contact.scene.joint_law import joint_law
from granular_contact.scene.layout import STILL, JointState, Layout, Pose, direction, point
from granular_contact.scene.parts import FlexibleLink, RigidBody, rotation
from granular_contact.scene.types import Joint


def joints_of(
    layout: Layout, bodies: Iterable[RigidBody | FlexibleLink], states: Mapping[str, JointState]
) -> Iterator[Joint]:
    """Joints and closures between what moves on its own.

    states: of the joints of the tree.
    """
    homes = {name: (body.name, body.motion) for body in bodies for name in body.name.split("+")}
    placed, loops = layout.placed, layout.model.closures
    for name, joint in (layout.model.all_joints | loops).items():
        parent, parent_frame = homes.get(joint.parent, (None, STILL))
        child, child_frame = homes.get(joint.child, (None, STILL))
        if child == parent:
            continue
        assert child is not None  # closures with child and parent swapped are refused before
        pin = placed[joint.child].world(point(joint.child_point_m))
        # The points of a joint with an axis stay where they are on their bodies; elsewhere both are the pin.
        at = pin
        start, rate = coordinate(placed, name, joint, states)
        axis, offset = None, 0.0
        if hasattr(joint, "axis"):
            at = placed[joint.parent].world(point(joint.parent_point_m))
            axis = rotation(placed[joint.parent].angle - parent_frame.angle) @ direction(joint)
        if isinstance(joint, schema.HingeClosure):
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
            law=joint_law(joint),
        )


def coordinate(
    placed: Pose, name: str, joint: schema.Joint | schema.Closure, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Coordinate of a hinge or slider at the start, and its rate; of a closure from the bodies that it joins."""
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
    parent, child = placed[joint.parent], placed[joint.child]
    if isinstance(joint, schema.SliderClosure):
        axis = rotation(parent.angle) @ direction(joint)
        pin = child.world(point(joint.child_point_m))
        along = float(axis @ (pin - parent.world(point(joint.parent_point_m))))
        return along, float(axis @ (child.speed_at(pin) - parent.speed_at(pin)))
    if isinstance(joint, schema.HingeClosure):
        # Which turn it is in can't be known: the one nearest to zero.
        turned = parent.angle - child.angle
        return turned - 2.0 * math.pi * round(turned / (2.0 * math.pi)), parent.rate - child.rate
    return 0.0, 0.0
