"""What of a robot's joints a mechanism here can't have, and joints that are held."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fnmatch import fnmatchcase

from granular_contact.robot.massless import has_world
from granular_contact.robot.types import Joint, Robot


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
