"""URDF file -> robot whose links and joints form one tree, or all faults of the file at once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

from granular_contact.errors import ConfigError, unknown_name
from granular_contact.robot.elements import Reader
from granular_contact.robot.links import read_joint, read_link
from granular_contact.robot.source import Element, parse
from granular_contact.robot.types import Joint, Link, Robot

_TAGS = ("link", "joint")


def read(path: str | PathLike[str], which: str = "collision") -> Robot:
    """Read the robot of a URDF file. which: kind of shapes whose faults count, "collision" or "visual".

    Elements of simulators (`gazebo`, `transmission`) are ignored.

    Raises
    ------
    ConfigError
        With all faults of the file, each with its line.
    """
    robot, reader = read_all(path)
    reader.use_shapes(which)
    if reader.faults:
        raise ConfigError(sorted(reader.faults, key=lambda fault: fault.line or 0))
    return robot


def read_all(path: str | PathLike[str]) -> tuple[Robot, Reader]:
    """Read a robot as far as possible; return it with its reader, which has the faults.

    Faults of shapes count only after `Reader.use_shapes`.

    Raises
    ------
    ConfigError
        The file can't be read as XML.
    """
    root, notices = parse(Path(path))
    reader = Reader(str(path))
    reader.notices += notices
    elements = dict[str, dict[str, Element]]()
    for tag in _TAGS:
        elements[tag] = dict(_elements_by_name(reader, root, tag))
    _check_spelling(reader, root)
    links: dict[str, Link] = {name: read_link(reader, element, name) for name, element in elements["link"].items()}
    joints_or_none = {name: read_joint(reader, element, name) for name, element in elements["joint"].items()}
    joints: dict[str, Joint] = {name: joint for name, joint in joints_or_none.items() if joint is not None}
    complete = len(joints) == len(root.findall("joint"))
    top = root_link(reader, links, joints, complete)
    return Robot(root.get("name") or Path(path).stem, str(path), links, joints, top), reader


def _elements_by_name(reader: Reader, root: Element, tag: str) -> Iterator[tuple[str, Element]]:
    """Names and elements with a tag; a fault for each name that is missing or used twice."""
    lines: dict[str, int] = {}
    for element in root.findall(tag):
        name = reader.text(element, "name", tag)
        if name in lines:
            reader.fault(element, f"{tag}.{name}", f"is the name of a {tag} already, in line {lines[name]}")
        elif name:
            lines[name] = element.sourceline
            yield name, element


def _check_spelling(reader: Reader, root: Element) -> None:
    """Add a fault for each unknown element whose tag is similar to a known one."""
    for element in root:
        known = not isinstance(element.tag, str) or element.tag in _TAGS
        for similar in () if known else get_close_matches(element.tag, _TAGS, 1, 0.75):
            reader.fault(element, element.tag[:40], f"unknown element; did you mean <{similar}>?")


def root_link(reader: Reader, links: Mapping[str, Link], joints: Mapping[str, Joint], complete: bool) -> str:
    """Name of the link that is the child of no joint; faults if the joints form no tree.

    complete: False if joints were left out for their own faults; several roots are then no fault.
    """
    above: dict[str, Joint] = {}
    for joint in joints.values():
        _check_ends(reader, joint, links)
        if joint.child in above:
            message = (
                f"{joint.child} is the child of {above[joint.child].name} already; each link has one joint above it"
            )
            reader.fault(joint.lines["child"], f"joint.{joint.name}.child", message)
        else:
            above[joint.child] = joint
        if joint.mimic and joint.mimic not in joints:
            reader.fault(
                joint.lines["mimic"], f"joint.{joint.name}.mimic", unknown_name("joint", joint.mimic[:60], joints)
            )
    roots = [name for name in links if name not in above]
    if not links:
        reader.fault(None, "link", "is missing; a robot has one link or more")
    elif len(roots) > 1 and complete:
        words = (
            f"no joint has {roots[1]} or {roots[0]} as its child; allowed is one such root, every other link is a child"
        )
        reader.fault(links[roots[1]].line, f"link.{roots[1]}", words)
    _check_loops(reader, links, above)
    return roots[0] if roots else ""


def _check_ends(reader: Reader, joint: Joint, links: Mapping[str, Link]) -> None:
    for end, name in (("parent", joint.parent), ("child", joint.child)):
        if name not in links:
            reader.fault(joint.lines[end], f"joint.{joint.name}.{end}", unknown_name("link", name[:60], links))
    if joint.parent == joint.child:
        reader.fault(joint.lines["child"], f"joint.{joint.name}.child", f"joins {joint.child} to itself")


def _check_loops(reader: Reader, links: Mapping[str, Link], above: Mapping[str, Joint]) -> None:
    """Add a fault for each closed chain of joints; above: the joint above each link."""
    visited: set[str] = set()
    for start in links:
        chain: list[str] = []
        name = start
        while name in above and name not in visited:
            visited.add(name)
            chain.append(name)
            name = above[name].parent
        if name in chain and above[name].parent != name:
            loop = " -> ".join(reversed([*chain[chain.index(name) :], name]))
            key = f"joint.{above[name].name}.parent"
            reader.fault(above[name].lines["parent"], key, f"{loop} is a closed chain; URDF has trees only")
