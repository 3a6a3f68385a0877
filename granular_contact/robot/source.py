"""A robot file -> XML. Nothing outside the file is read, no entity is expanded, and faults are one plain line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from granular_contact.errors import ConfigError, Fault

MOST_BYTES = 20_000_000
Element = Any  # of lxml, which has no types
_OTHERS = {
    "sdf": "is an SDF file; allowed is URDF (`gz sdf` and `sdformat_urdf` translate)",
    "mujoco": "is a file of MuJoCo (MJCF); allowed is URDF",
    "world": "is a world; allowed is the URDF of one robot",
}
_DOCTYPE = "has a DOCTYPE; allowed is a URDF without one, as entities are not expanded"
_XACRO = "is written in xacro; expand it first: xacro FILE > robot.urdf"


def parse(path: Path) -> Element:
    """The root element `<robot>` of a file.

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


def _checked(path: Path, raw: bytes) -> Element:
    try:
        from lxml import etree
    except ImportError:
        raise refused(path, "robot files are read by lxml: pip install 'granular-contact[robot]'") from None
    if (start := raw.find(b"<!DOCTYPE")) >= 0:
        raise refused(path, _DOCTYPE, raw.count(b"\n", 0, start) + 1)
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False)
    try:
        root = etree.fromstring(raw, parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        line = getattr(error, "lineno", None) or None
        words = " ".join(str(getattr(error, "msg", error)).split())[:160]
        raise refused(path, f"is not valid XML: {words}", line) from None
    if root.getroottree().docinfo.internalDTD is not None:  # in an encoding that hid it
        raise refused(path, _DOCTYPE, 1)
    return _robot(path, root)


def _robot(path: Path, root: Element) -> Element:
    from lxml import etree

    tag = etree.QName(root).localname
    if tag != "robot":
        raise refused(
            path, _OTHERS.get(tag, f"is not a URDF: its root is <{tag[:40]}>, allowed is <robot>"), root.sourceline
        )
    for element in root.iter(etree.Element):
        if "xacro" in (etree.QName(element).namespace or "") or "${" in "".join(element.attrib.values()):
            raise refused(path, _XACRO, element.sourceline)
    return root


def refused(path: Path, message: str, line: int | None = None) -> ConfigError:
    """The error of a file as a whole, or of a line of it."""
    return ConfigError([Fault(str(path), line, "", message)])
