"""Links without mass or with a point mass: they become part of the body that they are fixed to; else there is a fault.

Robot files have such links as roots, sensors and tool points. Their shapes and joints go to the body. This module also
lists joints that a mechanism does not support, and fixes joints that the config holds.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from granular_contact.robot.elements import PartialInertial, Reader
from granular_contact.robot.inertia import combined, moved
from granular_contact.robot.types import Inertial, Joint, Link, Pose, Robot, Shape

WORLDS = ("world", "ground")


def has_world(robot: Robot) -> bool:
    """Whether the root stands for the ground."""
    root = robot.links[robot.root]
    return robot.root in WORLDS and root.inertial is None


def with_given_inertials(robot: Robot, reader: Reader, given: Mapping[str, PartialInertial], fixed_base: bool) -> Robot:
    """The robot with given mass properties (by link) where those of the file are faulty, or missing but required.

    Other links do not change: those without faults, and those that become part of another body.
    """
    links = dict(robot.links)
    for name in given.keys() & reader.partial_inertials.keys():
        links[name] = _with_inertial(links[name], given[name], reader.partial_inertials[name])
    trial = Reader(reader.file)
    merge_massless(replace(robot, links=links), trial, fixed_base)
    still_massless = {name for name in given for fault in trial.faults if fault.key == f"link.{name}"}
    for name in still_massless:
        links[name] = _with_inertial(links[name], given[name], PartialInertial(None, None, None, links[name].line))
    return replace(robot, links=links)


def _with_inertial(link: Link, given: PartialInertial, read: PartialInertial) -> Link:
    """The link with given mass properties, completed by those read; unchanged if mass or tensor is still missing."""
    mass = read.mass if given.mass is None else given.mass
    tensor = read.tensor if given.tensor is None else given.tensor
    if not mass or tensor is None:
        return link
    center = next((partial.center for partial in (given, read) if partial.center is not None), np.zeros(3))
    return replace(link, inertial=Inertial(mass, center, tensor, read.line))


def merge_massless(robot: Robot, reader: Reader, fixed_base: bool = False) -> Robot:
    """Merge links without moment of inertia into bodies that they are fixed to; a fault for each that can't be merged.

    A root that is the ground or held needs no mass. fixed_base: whether the root is held.
    """
    remaining = replace(robot, links=dict(robot.links), joints=dict(robot.joints))
    root_is_held = has_world(robot) or fixed_base
    for name in reversed(list(_outward(robot))):
        if has_inertia(remaining.links[name]) or (name == robot.root and root_is_held):
            continue
        above = remaining.above(name)
        fixed_bodies = [
            joint
            for joint in remaining.below(name)
            if joint.kind == "fixed" and has_inertia(remaining.links[joint.child])
        ]
        if fixed_bodies:
            for joint in fixed_bodies:
                _absorb(remaining, joint)
        elif above is not None and above.kind == "fixed":
            _absorb(remaining, above)
        else:
            reader.fault(remaining.links[name].line, f"link.{name}", _missing_inertia(above, remaining.links[name]))
    return remaining


def has_inertia(link: Link) -> bool:
    """Whether a link has a moment of inertia: no point mass, and not massless."""
    return link.inertial is not None and bool(link.inertial.tensor.any())


def _missing_inertia(above: Joint | None, link: Link) -> str:
    """Sentence on a link that moves without mass or moment of inertia."""
    allowed, lacks = "allowed is <inertial> with a mass above 0", "mass"
    if link.inertial is not None:
        allowed, lacks = "allowed is <inertial> with moments above 0", "moment of inertia"
    if above is None:
        return f"the root has no {lacks}, nor has a link that is fixed to it; {allowed}, or base: fixed in the model"
    return f"moves by the joint {above.name} ({above.kind}) and has no {lacks}; {allowed}, or a fixed joint to a body"


def _outward(robot: Robot) -> Iterator[str]:
    """Names of the links from the root outward, each after its parent."""
    remaining = [robot.root]
    while remaining:
        name = remaining.pop()
        yield name
        remaining += [joint.child for joint in robot.below(name)]


def _absorb(robot: Robot, joint: Joint) -> None:
    """Merge the child of a fixed joint into its parent; the robot is changed in place."""
    links, joints = robot.links, robot.joints
    parent, child = links[joint.parent], links.pop(joint.child)
    parts = [] if parent.inertial is None else [parent.inertial]
    if child.inertial is not None:
        parts.append(moved(child.inertial, joint.origin))
    links[parent.name] = replace(
        parent,
        inertial=combined(parts) if parts else None,
        visual=(*parent.visual, *_moved(child.visual, joint.origin)),
        collision=(*parent.collision, *_moved(child.collision, joint.origin)),
    )
    del joints[joint.name]
    for other in list(robot.below(child.name)):
        joints[other.name] = replace(other, parent=parent.name, origin=joint.origin.then(other.origin))


def _moved(shapes: tuple[Shape, ...], pose: Pose) -> Iterator[Shape]:
    return (replace(shape, pose=pose.then(shape.pose)) for shape in shapes)


def unsupported(robot: Robot) -> Iterator[tuple[Joint, str, str]]:
    """Joints of kinds that mechanisms do not support, each with the key and a sentence."""
    for joint in robot.joints.values():
        below_world = joint.parent == robot.root and has_world(robot)
        if joint.kind == "planar" or (joint.kind == "floating" and not below_world):
            allowed = "revolute, continuous, prismatic and fixed, floating below a link world, or hold it by fix"
            yield joint, "type", f"{joint.kind} is not supported; allowed are {allowed}"


def mimicking(robot: Robot) -> Iterator[tuple[Joint, str, str]]:
    """Joints that follow another joint, each with the key and a sentence."""
    for joint in robot.joints.values():
        if joint.mimic:
            allowed = "hold it by fix, or write mimic: ignore and give it a drive of its own"
            yield joint, "mimic", f"follows {joint.mimic}, which is not supported; {allowed}"


def with_fixed_joints(robot: Robot, patterns: Iterable[str]) -> Robot:
    """The robot with joints of these names or patterns fixed at coordinate 0."""
    chosen = [name for pattern in patterns for name in matching(pattern, robot.joints)]
    joints = {
        name: replace(joint, kind="fixed", mimic=None) if name in chosen else joint
        for name, joint in robot.joints.items()
    }
    return replace(robot, joints=joints)


def matching(pattern: str, names: Iterable[str]) -> list[str]:
    """Names that match a name or a pattern with * and ?."""
    return [name for name in names if name == pattern or fnmatchcase(name, pattern)]
