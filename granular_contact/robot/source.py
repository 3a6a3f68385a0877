"""A robot file -> XML. Nothing outside the file is read, no entity is expanded, and faults are one plain line."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

from granular_contact.errors import ConfigError, Fault
from granular_contact.robot.tolerant_xml import DamagedXML, decoded, root_of

MOST_BYTES = 20_000_000
Element = Any  # of lxml, which has no types
_OTHERS = {
    "sdf": "is an SDF file; allowed is URDF (`gz sdf` and `sdformat_urdf` translate)",
    "mujoco": "is a file of MuJoCo (MJCF); allowed is URDF",
    "world": "is a world; allowed is the URDF of one robot",
}
_DOCTYPE = "has a DOCTYPE; allowed is a URDF without one, as entities are not expanded"
_XACRO = "is written in xacro; expand it first: xacro FILE > robot.urdf"


class Parsed(NamedTuple):
    """The root element `<robot>` of a file, and notices on what was passed over in it."""

    root: Element
    notices: list[Fault]


def parse(path: Path) -> Parsed:
    """The root element of a file.

    Raises
    ------
    ConfigError
        There is no such file, it is damaged, too large or of another kind; one line, with the line of the damage.
    """
    try:
        if path.is_dir():
            raise refused(path, "is a folder; a URDF file is needed")
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except FileNotFoundError:
        raise refused(path, "no such file") from None
    except (OSError, ValueError) as error:
        raise refused(path, f"can't be read: {getattr(error, 'strerror', None) or error}") from None
    if len(raw) > MOST_BYTES:
        raise refused(path, f"is larger than {MOST_BYTES // 10**6} MB, the most that is read")
    if not raw.strip():
        raise refused(path, "is empty; a URDF file is needed")
    return _checked(path, raw)


def _checked(path: Path, raw: bytes) -> Parsed:
    text, notices = decoded(raw)
    if (start := text.find("<!DOCTYPE")) >= 0:
        raise refused(path, _DOCTYPE, text.count("\n", 0, start) + 1)
    try:
        root, more = root_of(text)
    except ImportError:
        raise refused(path, "robot files are read by lxml: pip install 'granular-contact[robot]'") from None
    except DamagedXML as error:
        raise refused(path, f"is not valid XML: {' '.join(str(error).split())[:160]}", error.line) from None
    found = [Fault(str(path), line, "", words) for line, words in (*notices, *more)]
    return Parsed(_robot(path, root), found)


def _robot(path: Path, root: Element) -> Element:
    _, tag = _space_and_tag(root)
    if tag != "robot":
        raise refused(
            path, _OTHERS.get(tag, f"is not a URDF: its root is <{tag[:40]}>, allowed is <robot>"), root.sourceline
        )
    for element in root.iter():
        if not isinstance(element.tag, str):  # a comment
            continue
        if "xacro" in _space_and_tag(element)[0] or "${" in "".join(element.attrib.values()):
            raise refused(path, _XACRO, element.sourceline)
    return root


def _space_and_tag(element: Element) -> tuple[str, str]:
    """Namespace of an element, or its prefix if that is not declared, and its name there."""
    if element.tag.startswith("{"):
        space, _, tag = element.tag[1:].partition("}")
    else:
        space, _, tag = element.tag.rpartition(":")
    return space, tag


def refused(path: Path, message: str, line: int | None = None) -> ConfigError:
    """The error of a file as a whole, or of a line of it."""
    return ConfigError([Fault(str(path), line, "", message)])
