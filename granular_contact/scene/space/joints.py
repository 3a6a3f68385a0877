"""Joints of a laid-out model in space, between the merged rigid bodies."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from granular_contact.config.schema import space as schema
from granular_contact.config.schema.space.joints import AnyClosure, AnyJoint
from granular_contact.geometry import rotations
from granular_contact.scene.joint_law import joint_law
from granular_contact.scene.layout import GROUND
from granular_contact.scene.space.layout import STILL, JointState, Pose, axis_of
from granular_contact.scene.space.loops import CONSTRAINED, joint_frame
from granular_contact.scene.space.types import SpatialJoint, SpatialRigidBody, Vector


def joints_of(
    model: schema.SpatialModel,
    placed: Pose,
    rigid: tuple[SpatialRigidBody, ...],
    states: Mapping[str, JointState],
    needed: Mapping[str, tuple[bool, ...]],
) -> Iterator[SpatialJoint]:
    """Joints and closures between what moves on its own; needed: which constraints of closures count."""
    homes = {name: (body.name, body.motion) for body in rigid for name in body.name.split("+")}
    for name, joint in (model.all_joints | model.closures).items():
        parent, parent_frame = homes.get(joint.parent, (None, STILL))
        child, child_frame = homes.get(joint.child, (None, STILL))
        if child == parent:
            continue
        assert child is not None  # closures with child and parent swapped are refused before
        turn, at_child = joint_frame(joint, placed)
        at_parent = _origin(placed, joint) if joint.type == "slider" else at_child
        on_child = turn  # closed to round-off
        if joint.type in ("hinge", "ball", "free"):
            on_child = placed[joint.child].rotation @ rotations.to_axis(axis_of(joint))
        start, rate = coordinate(name, joint, placed, states)
        yield SpatialJoint(
            name=name,
            kind=joint.type,
            parent=parent,
            parent_point=parent_frame.local(at_parent),
            parent_turn=parent_frame.rotation.T @ turn,
            child=child,
            child_point=child_frame.local(at_child),
            child_turn=child_frame.rotation.T @ on_child,
            constrained=needed.get(name, CONSTRAINED[joint.type]),
            start=start,
            rate=rate,
            closes=name in model.closures,
            law=joint_law(joint),
        )


def _origin(placed: Pose, joint: AnyJoint | AnyClosure) -> Vector:
    """Point (3,) m of a joint on its parent: of a slider another one than that on its child."""
    return placed[joint.parent].world(np.array(joint.parent_point_m))


def coordinate(
    name: str, joint: AnyJoint | AnyClosure, placed: Pose, states: Mapping[str, JointState]
) -> tuple[float, float]:
    """Coordinate of a hinge or slider at the start, and its rate; of a closure from the bodies that it joins."""
    if joint.type not in ("hinge", "slider"):
        return 0.0, 0.0
    if name in states:
        return states[name].coordinate, float(states[name].rates[0])
    turn, at_child = joint_frame(joint, placed)
    axis, parent, child = turn[:, 2], placed[joint.parent], placed[joint.child]
    if joint.type == "slider":
        apart, speed = at_child - _origin(placed, joint), child.speed_at(at_child) - parent.speed_at(at_child)
        return float(axis @ apart), float(axis @ speed)
    relative = turn.T @ child.rotation @ rotations.to_axis(axis_of(joint))
    # Which turn it is in can't be known: the one nearest to zero.
    angle = math.atan2(relative[1, 0], relative[0, 0])
    return angle, float(axis @ (child.rate - parent.rate))


def on_ground(model: schema.SpatialModel) -> list[AnyJoint]:
    """Joints on the ground."""
    return [joint for joint in model.all_joints.values() if joint.parent == GROUND]
