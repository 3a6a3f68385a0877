"""A URDF file -> a robot, or every fault in it at once."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from os import PathLike
from pathlib import Path

from granular_contact.errors import ConfigError
from granular_contact.robot.elements import Reader
from granular_contact.robot.joints import read_joint
from granular_contact.robot.links import read_link
from granular_contact.robot.source import Element, parse
from granular_contact.robot.structure import root_of
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
        if isinstance(element.tag, str) and element.tag not in _TAGS and get_close_matches(element.tag, _TAGS, 1, 0.75):
            near = get_close_matches(element.tag, _TAGS, 1, 0.75)[0]
            reader.fault(element, element.tag[:40], f"unknown element; did you mean <{near}>?")
