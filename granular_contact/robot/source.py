"""A robot file -> XML. Nothing outside the file is read, no entity is expanded, and faults are one plain line.

The text is read as tolerantly as the readers of robotics do (tinyxml2, which MuJoCo and ROS use). They skip the XML
declaration and know no namespaces. What is passed over becomes a notice with its line; damage that leaves open what is
meant, as a tag without an end, is not.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from granular_contact.errors import ConfigError, Fault

# Bytes at the start of a file that say its encoding, the longest first.
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (b"<\0", "utf-16-le"),
    (b"\0<", "utf-16-be"),
)
_DECLARATION = re.compile(r"(\s*)<\?xml\s(.*?)\?>", re.DOTALL | re.IGNORECASE)
_VERSION = re.compile(r"version\s*=\s*[\"']([^\"']*)")
_ENCODING = re.compile(r"encoding\s*=\s*[\"']([^\"']*)")
_READABLE_VERSION = re.compile(r"1\.[0-9]+")
_AMPERSAND = re.compile(r"&(?!(?:amp|lt|gt|quot|apos|#[0-9]+|#x[0-9A-Fa-f]+);)")
_PREFIX = re.compile(r"prefix (\S+)(?: for \S+)? on")


class Notice(NamedTuple):
    """Something that was passed over; line from 1, None for the whole file."""

    line: int | None
    message: str


class DamagedXML(ValueError):
    """It can't be read; the line from 1, None if it is not known."""

    def __init__(self, message: str, line: int | None) -> None:
        super().__init__(message)
        self.line = line


def decoded(raw: bytes) -> tuple[str, list[Notice]]:
    """Text of a file: in the encoding that its first bytes or its declaration say, else in UTF-8, else in Latin-1."""
    marked = next((name for mark, name in _MARKS if raw.startswith(mark)), None)
    if marked is not None:
        return raw.decode(marked, "replace"), []
    found = _DECLARATION.match(raw[:1000].decode("latin-1"))
    said = _ENCODING.search(found[2]) if found is not None else None
    notices = []
    if said is not None and _is_ascii_like(said[1]):
        try:
            return raw.decode(said[1]), []
        except UnicodeDecodeError as error:
            notices.append(_not_in(raw, said[1], error))
    elif said is not None:
        line = raw.count(b"\n", 0, found.end()) + 1 if found is not None else 1
        notices.append(Notice(line, f"says the encoding {said[1][:40]!r}, but is written in another; it is ignored"))
    try:
        return raw.decode(), notices
    except UnicodeDecodeError as error:
        notices = notices or [_not_in(raw, "utf-8", error)]
    return raw.decode("latin-1"), notices


def _is_ascii_like(encoding: str) -> bool:
    """Whether text of ASCII characters, as the declaration is, may be in this encoding."""
    try:
        return "<?xml".encode(encoding) == b"<?xml"
    except (LookupError, UnicodeError):
        return False


def _not_in(raw: bytes, encoding: str, error: UnicodeDecodeError) -> Notice:
    byte = f"the byte {raw[error.start]:#x}"
    line = raw.count(b"\n", 0, error.start) + 1
    return Notice(line, f"holds {byte}, which the encoding {encoding[:40]} has not; read as UTF-8 or Latin-1")


def root_of(text: str) -> tuple[Any, list[Notice]]:
    """The root element of a text, without expanding entities or fetching anything.

    Raises
    ------
    DamagedXML
        It is no XML, or its damage leaves open what is meant.
    ImportError
        lxml is not installed.
    """
    plain, notices = _without_declaration(text)
    root, log = _recovered(plain)
    if any(_is_of_ampersand(entry) for entry in log):
        at = _AMPERSAND.search(plain)
        line = plain.count("\n", 0, at.start()) + 1 if at is not None else None
        root, log = _recovered(_AMPERSAND.sub("&amp;", plain))
        notices.append(Notice(line, "has an & that begins no known entity; it is read as the character &amp;"))
    notices += _tolerated(log)
    if root is None:
        raise DamagedXML("it has no root element", None)
    return root, notices


def _without_declaration(text: str) -> tuple[str, list[Notice]]:
    """The text with blanks in place of its XML declaration, so that lines keep their numbers."""
    found = _DECLARATION.match(text)
    if found is None:
        return text, []
    line, notices = text.count("\n", 0, found.end(1)) + 1, []
    if found[1]:
        notices.append(Notice(line, "the XML declaration does not stand at the start of the file"))
    version = _VERSION.search(found[2])
    if version is None or not _READABLE_VERSION.fullmatch(version[1]):
        shown = "no version" if version is None else f"the version {version[1][:20]!r}"
        notices.append(Notice(line, f"the XML declaration has {shown}; read as 1.0"))
    return "\n" * text.count("\n", 0, found.end()) + text[found.end() :], notices


def _recovered(text: str) -> tuple[Any, list[Any]]:
    """The root as far as it can be read, and what lxml logs."""
    from lxml import etree

    options = {"resolve_entities": False, "no_network": True, "load_dtd": False, "huge_tree": False}
    parser = etree.XMLParser(recover=True, encoding="utf-8", **options)
    try:
        root = etree.fromstring(text.encode(errors="replace"), parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        words = str(getattr(error, "msg", error))
        raise DamagedXML(words, getattr(error, "lineno", None) or None) from None
    return root, list(parser.error_log)


def _is_of_ampersand(entry: Any) -> bool:
    return entry.type_name in ("ERR_NAME_REQUIRED", "ERR_ENTITYREF_SEMICOL_MISSING", "ERR_UNDECLARED_ENTITY") and (
        "ntity" in entry.message
    )


def _tolerated(log: list[Any]) -> Iterator[Notice]:
    """Notices on what lxml logged: the first of each kind.

    Raises
    ------
    DamagedXML
        At the first entry that is none of those that leave the meaning as it is.
    """
    seen = set[str]()
    for entry in log:
        if entry.type_name == "NS_ERR_UNDEFINED_NAMESPACE":
            found = _PREFIX.search(entry.message)
            prefix = found[1][:40] if found is not None else "?"
            words = f"the prefix {prefix!r} is not declared (xmlns:{prefix}); what has it is ignored"
        elif entry.type_name == "ERR_HYPHEN_IN_COMMENT":
            words = "a comment holds --, which XML does not allow"
        elif entry.type_name == "ERR_RESERVED_XML_NAME":
            words = "an XML declaration does not stand at the start of the file; it is ignored"
        else:
            raise DamagedXML(entry.message, entry.line or None)
        if words not in seen:
            seen.add(words)
            yield Notice(entry.line or None, words)


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
        raise refused(path, "needs lxml, which reads robot files: pip install 'granular-contact[robot]'") from None
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
