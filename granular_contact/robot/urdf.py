"""A URDF file -> a robot, or every fault in it at once; its links and joints form one tree."""

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
    """The robot in a URDF file, of which the shapes for "collision" or "visual" are used.

    Raises
    ------
    ConfigError
        With every fault of the file, each with its line; elements of simulators (`gazebo`, `transmission`) are ignored.
    """
    robot, reader = read_all(path)
    reader.use(which)
    if reader.faults:
        raise ConfigError(sorted(reader.faults, key=lambda fault: fault.line or 0))
    return robot


def read_all(path: str | PathLike[str]) -> tuple[Robot, Reader]:
    """The robot as far as it can be read, and the reader with its faults; those of shapes once they are used.

    Raises
    ------
    ConfigError
        The file can't be read as XML.
    """
    root, notices = parse(Path(path))
    reader = Reader(str(path))
    reader.notices += notices
    named = dict[str, dict[str, Element]]()
    for tag in _TAGS:
        named[tag] = dict(_named(reader, root, tag))
    _misspelt(reader, root)
    links: dict[str, Link] = {name: read_link(reader, one, name) for name, one in named["link"].items()}
    read_ones = {name: read_joint(reader, one, name) for name, one in named["joint"].items()}
    joints: dict[str, Joint] = {name: joint for name, joint in read_ones.items() if joint is not None}
    complete = len(joints) == len(root.findall("joint"))
    top = root_of(reader, links, joints, complete)
    return Robot(root.get("name") or Path(path).stem, str(path), links, joints, top), reader


def _named(reader: Reader, root: Element, tag: str) -> Iterator[tuple[str, Element]]:
    seen: dict[str, int] = {}
    for element in root.findall(tag):
        name = reader.text(element, "name", tag)
        if name in seen:
            reader.fault(element, f"{tag}.{name}", f"is the name of a {tag} already, in line {seen[name]}")
        elif name:
            seen[name] = element.sourceline
            yield name, element


def _misspelt(reader: Reader, root: Element) -> None:
    for element in root:
        known = not isinstance(element.tag, str) or element.tag in _TAGS
        for near in () if known else get_close_matches(element.tag, _TAGS, 1, 0.75):
            reader.fault(element, element.tag[:40], f"unknown element; did you mean <{near}>?")


def root_of(reader: Reader, links: Mapping[str, Link], joints: Mapping[str, Joint], complete: bool) -> str:
    """The link that is the child of no joint; faults where the joints make no tree.

    complete: False if joints are missing for faults of their own; several roots are then no fault.
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
            f"no joint has {roots[1]} as its child, nor {roots[0]}; allowed is one root, every other link is a child"
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
    seen: set[str] = set()
    for start in links:
        chain: list[str] = []
        name = start
        while name in above and name not in seen:
            seen.add(name)
            chain.append(name)
            name = above[name].parent
        if name in chain and above[name].parent != name:
            loop = " -> ".join(reversed([*chain[chain.index(name) :], name]))
            key = f"joint.{above[name].name}.parent"
            reader.fault(above[name].lines["parent"], key, f"{loop} is a closed chain; URDF has trees only")
