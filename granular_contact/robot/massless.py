"""Links without mass, or with one in a point: what is fixed to a body becomes part of it; what moves can't be computed.

Robot files have them as roots, sensors, tool points. Their shapes and joints go to the body that they become part of.
It is also said here which joints a mechanism can't have, and which are held.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from granular_contact.robot.elements import Incomplete, Reader
from granular_contact.robot.inertia import added, moved
from granular_contact.robot.types import Inertial, Joint, Link, Pose, Robot, Shape

WORLDS = ("world", "ground")


def has_world(robot: Robot) -> bool:
    """Whether the root stands for the ground."""
    root = robot.links[robot.root]
    return robot.root in WORLDS and root.inertial is None


def completed(robot: Robot, reader: Reader, given: Mapping[str, Incomplete], fixed_base: bool) -> Robot:
    """The robot with mass properties by the names of links, where those of the file are faulty or must not lack.

    Links that are whole in the file, or can be part of another, stay as they are.
    """
    links = dict(robot.links)
    for name in given.keys() & reader.incomplete.keys():
        read = reader.incomplete[name]
        links[name] = _with_mass(links[name], given[name], read)
    trial = Reader(reader.file)
    merged(replace(robot, links=links), trial, fixed_base)
    moving = {name for name in given for fault in trial.faults if fault.key == f"link.{name}"}
    for name in moving:
        links[name] = _with_mass(links[name], given[name], Incomplete(None, None, None, links[name].line))
    return replace(robot, links=links)


def _with_mass(link: Link, given: Incomplete, read: Incomplete) -> Link:
    """A link with what is given, else with what could be read; as it was where that is not all."""
    mass = read.mass if given.mass is None else given.mass
    tensor = read.tensor if given.tensor is None else given.tensor
    if not mass or tensor is None:
        return link
    center = next((one.center for one in (given, read) if one.center is not None), np.zeros(3))
    return replace(link, inertial=Inertial(mass, center, tensor, read.line))


def merged(robot: Robot, reader: Reader, fixed_base: bool = False) -> Robot:
    """The robot without links that have no mass, but for a root that is the ground; faults where one moves.

    fixed_base: whether the root is held, so that it needs no mass.
    """
    left = replace(robot, links=dict(robot.links), joints=dict(robot.joints))
    held = has_world(robot) or fixed_base
    for name in reversed(list(_from_root(robot))):
        if has_inertia(left.links[name]) or (name == robot.root and held):
            continue
        above = left.above(name)
        heavy = [j for j in left.below(name) if j.kind == "fixed" and has_inertia(left.links[j.child])]
        if heavy:
            for joint in heavy:
                _absorb(left, joint)
        elif above is not None and above.kind == "fixed":
            _absorb(left, above)
        else:
            reader.fault(left.links[name].line, f"link.{name}", _motion(above, left.links[name]))
    return left


def has_inertia(link: Link) -> bool:
    """Whether a link has a mass that is not all in one point."""
    return link.inertial is not None and bool(link.inertial.tensor.any())


def _motion(above: Joint | None, link: Link) -> str:
    allowed, lacks = "allowed is <inertial> with a mass above 0", "mass"
    if link.inertial is not None:
        allowed, lacks = "allowed is <inertial> with moments above 0", "moment of inertia"
    if above is None:
        return f"the root has no {lacks}, nor has a link that is fixed to it; {allowed}, or base: fixed in the model"
    return f"moves by the joint {above.name} ({above.kind}) and has no {lacks}; {allowed}, or a fixed joint to a body"


def _from_root(robot: Robot) -> Iterator[str]:
    """Names of the links, each behind its parent."""
    left = [robot.root]
    while left:
        name = left.pop()
        yield name
        left += [joint.child for joint in robot.below(name)]


def _absorb(robot: Robot, joint: Joint) -> None:
    """Make the child of a fixed joint part of its parent."""
    links, joints = robot.links, robot.joints
    parent, child = links[joint.parent], links.pop(joint.child)
    parts = [] if parent.inertial is None else [parent.inertial]
    if child.inertial is not None:
        parts.append(moved(child.inertial, joint.origin))
    links[parent.name] = replace(
        parent,
        inertial=added(parts) if parts else None,
        visual=(*parent.visual, *_moved(child.visual, joint.origin)),
        collision=(*parent.collision, *_moved(child.collision, joint.origin)),
    )
    del joints[joint.name]
    for other in list(robot.below(child.name)):
        joints[other.name] = replace(other, parent=parent.name, origin=joint.origin.then(other.origin))


def _moved(shapes: tuple[Shape, ...], pose: Pose) -> Iterator[Shape]:
    return (replace(shape, pose=pose.then(shape.pose)) for shape in shapes)


def unsupported(robot: Robot) -> Iterator[tuple[Joint, str, str]]:
    """Joints that are not supported, each with the key and a sentence."""
    for joint in robot.joints.values():
        below_world = joint.parent == robot.root and has_world(robot)
        if joint.kind == "planar" or (joint.kind == "floating" and not below_world):
            allowed = "revolute, continuous, prismatic and fixed, floating below a link world, or hold it by fix"
            yield joint, "type", f"{joint.kind} is not supported; allowed are {allowed}"


def mimicking(robot: Robot) -> Iterator[tuple[Joint, str, str]]:
    """Joints that follow another, each with the key and a sentence."""
    for joint in robot.joints.values():
        if joint.mimic:
            allowed = "hold it by fix, or write mimic: ignore and give it a drive of its own"
            yield joint, "mimic", f"follows {joint.mimic}, which is not supported; {allowed}"


def held(robot: Robot, patterns: Iterable[str]) -> Robot:
    """The robot with joints of these names or patterns fixed at coordinate 0."""
    chosen = [name for pattern in patterns for name in matching(pattern, robot.joints)]
    joints = {
        name: replace(joint, kind="fixed", mimic=None) if name in chosen else joint
        for name, joint in robot.joints.items()
    }
    return replace(robot, joints=joints)


def matching(pattern: str, names: Iterable[str]) -> list[str]:
    """Names that a name or a pattern with * and ? means."""
    return [name for name in names if name == pattern or fnmatchcase(name, pattern)]
