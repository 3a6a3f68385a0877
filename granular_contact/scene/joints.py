"""Joints of a laid-out model between the merged rigid bodies, and the forces that act in them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from granular_contact.config import schema
from granular_contact.scene.joint_law import joint_law
from granular_contact.scene.layout import ZERO, Frame, JointState, Layout, direction, point
from granular_contact.scene.types import Joint, RigidBody, Vector, rotation


def joints_of(layout: Layout, rigid: tuple[RigidBody, ...], states: Mapping[str, JointState]) -> Iterator[Joint]:
    """Joints and closures between what moves on its own.

    states: of the joints of the tree.
    """
    homes, loops = _homes(layout, rigid), layout.model.closures
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
            law=joint_law(joint),
        )


def _homes(layout: Layout, rigid: tuple[RigidBody, ...]) -> dict[str, tuple[str | None, Frame]]:
    """By the name of each body the merged one that it is a part of, None for the ground, and the frame of that."""
    homes: dict[str, tuple[str | None, Frame]] = {name: (name, frame) for name, frame in layout.frames.items()}
    merged = {body.name: body for body in rigid}
    for group in layout.groups:
        body = merged.get("+".join(group))
        home = (None, Frame(ZERO, 0.0)) if body is None else (body.name, Frame(body.motion.position, body.motion.angle))
        homes |= dict.fromkeys(group, home)
    return homes


def _origin(layout: Layout, joint: schema.SliderClosure) -> Vector:
    return layout.frames[joint.parent].world(point(joint.parent_point_m))


def coordinate(
    layout: Layout, name: str, joint: schema.Joint | schema.Closure, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Coordinate of a hinge or slider at the start, and its rate; of a closure from the bodies that it joins."""
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
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
