"""Robot file -> XML. Nothing outside the file is read, no entity is expanded, and an error is one plain sentence.

The file is read as tolerantly as by other readers of robotics (tinyxml2, which MuJoCo and ROS use). They skip the XML
declaration and do not support namespaces. Ignored flaws become notices with their lines. Damage that makes the meaning
uncertain, as a tag without an end, is an error.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from granular_contact.errors import ConfigError, Fault

# Bytes at the start of a file that show its encoding; UTF-32 before UTF-16, whose mark is the same at the start.
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
    """Flaw of a file that is ignored; line: from 1, None for the whole file."""

    line: int | None
    message: str


class DamagedXML(ValueError):
    """XML that can't be read; line: from 1, None if unknown."""

    def __init__(self, message: str, line: int | None) -> None:
        super().__init__(message)
        self.line = line


def decode(raw: bytes) -> tuple[str, list[Notice]]:
    """Decode a file: by the encoding of its first bytes or of its declaration, else by UTF-8, else by Latin-1."""
    marked = next((name for mark, name in _MARKS if raw.startswith(mark)), None)
    if marked is not None:
        return raw.decode(marked, "replace"), []
    declaration = _DECLARATION.match(raw[:1000].decode("latin-1"))
    encoding = _ENCODING.search(declaration[2]) if declaration is not None else None
    notices = []
    if encoding is not None and _is_ascii_like(encoding[1]):
        try:
            return raw.decode(encoding[1]), []
        except UnicodeDecodeError as error:
            notices.append(_undecodable(raw, encoding[1], error))
    elif encoding is not None:
        line = raw.count(b"\n", 0, declaration.end()) + 1 if declaration is not None else 1
        words = f"says the encoding {encoding[1][:40]!r}, but is written in another; it is ignored"
        notices.append(Notice(line, words))
    try:
        return raw.decode(), notices
    except UnicodeDecodeError as error:
        notices = notices or [_undecodable(raw, "utf-8", error)]
    return raw.decode("latin-1"), notices


def _is_ascii_like(encoding: str) -> bool:
    """Whether an encoding has ASCII characters as ASCII bytes, as the declaration of the file has them."""
    try:
        return "<?xml".encode(encoding) == b"<?xml"
    except (LookupError, UnicodeError):
        return False


def _undecodable(raw: bytes, encoding: str, error: UnicodeDecodeError) -> Notice:
    """Notice on the first byte that an encoding does not have."""
    byte = f"the byte {raw[error.start]:#x}"
    line = raw.count(b"\n", 0, error.start) + 1
    return Notice(line, f"holds {byte}, which the encoding {encoding[:40]} does not have; read as UTF-8 or Latin-1")


def parse_text(text: str) -> tuple[Any, list[Notice]]:
    """Root element of a text, without expanding entities or fetching anything.

    Raises
    ------
    DamagedXML
        The text is not XML, or damage makes its meaning uncertain.
    ImportError
        lxml is not installed.
    """
    plain, notices = _without_declaration(text)
    root, log = _parse_with_recovery(plain)
    if any(_is_about_ampersand(entry) for entry in log):
        first = _AMPERSAND.search(plain)
        line = plain.count("\n", 0, first.start()) + 1 if first is not None else None
        root, log = _parse_with_recovery(_AMPERSAND.sub("&amp;", plain))
        notices.append(Notice(line, "has an & that begins no known entity; it is read as the character &amp;"))
    notices += _tolerated(log)
    if root is None:
        raise DamagedXML("it has no root element", None)
    return root, notices


def _without_declaration(text: str) -> tuple[str, list[Notice]]:
    """The text without its XML declaration; line breaks in its place keep the numbers of the lines."""
    declaration = _DECLARATION.match(text)
    if declaration is None:
        return text, []
    line, notices = text.count("\n", 0, declaration.end(1)) + 1, []
    if declaration[1]:
        notices.append(Notice(line, "the XML declaration does not stand at the start of the file"))
    version = _VERSION.search(declaration[2])
    if version is None or not _READABLE_VERSION.fullmatch(version[1]):
        shown = "no version" if version is None else f"the version {version[1][:20]!r}"
        notices.append(Notice(line, f"the XML declaration has {shown}; read as 1.0"))
    return "\n" * text.count("\n", 0, declaration.end()) + text[declaration.end() :], notices


def _parse_with_recovery(text: str) -> tuple[Any, list[Any]]:
    """Root element as far as lxml can read it, and the entries of its error log."""
    from lxml import etree

    options = {"resolve_entities": False, "no_network": True, "load_dtd": False, "huge_tree": False}
    parser = etree.XMLParser(recover=True, encoding="utf-8", **options)
    try:
        root = etree.fromstring(text.encode(errors="replace"), parser)
    except (etree.XMLSyntaxError, ValueError) as error:
        words = str(getattr(error, "msg", error))
        raise DamagedXML(words, getattr(error, "lineno", None) or None) from None
    return root, list(parser.error_log)


def _is_about_ampersand(entry: Any) -> bool:
    return entry.type_name in ("ERR_NAME_REQUIRED", "ERR_ENTITYREF_SEMICOL_MISSING", "ERR_UNDECLARED_ENTITY") and (
        "ntity" in entry.message
    )


def _tolerated(log: list[Any]) -> Iterator[Notice]:
    """Notices on the error log of lxml, the first of each kind.

    Raises
    ------
    DamagedXML
        At the first entry that makes the meaning uncertain.
    """
    reported = set[str]()
    for entry in log:
        if entry.type_name == "NS_ERR_UNDEFINED_NAMESPACE":
            match = _PREFIX.search(entry.message)
            prefix = match[1][:40] if match is not None else "?"
            words = f"the prefix {prefix!r} is not declared (xmlns:{prefix}); names with it are ignored"
        elif entry.type_name == "ERR_HYPHEN_IN_COMMENT":
            words = "a comment holds --, which XML does not allow"
        elif entry.type_name == "ERR_RESERVED_XML_NAME":
            words = "an XML declaration does not stand at the start of the file; it is ignored"
        else:
            raise DamagedXML(entry.message, entry.line or None)
        if words not in reported:
            reported.add(words)
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
    """Root element `<robot>` of a file, and notices on its ignored flaws."""

    root: Element
    notices: list[Fault]


def parse(path: Path) -> Parsed:
    """Read the root element of a robot file.

    Raises
    ------
    ConfigError
        The file does not exist, is damaged, too large or of another kind; one sentence, with the line of the damage.
    """
    try:
        if path.is_dir():
            raise file_error(path, "is a folder; a URDF file is needed")
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except FileNotFoundError:
        raise file_error(path, "no such file") from None
    except (OSError, ValueError) as error:
        raise file_error(path, f"can't be read: {getattr(error, 'strerror', None) or error}") from None
    if len(raw) > MOST_BYTES:
        raise file_error(path, f"is larger than {MOST_BYTES // 10**6} MB, the most that is read")
    if not raw.strip():
        raise file_error(path, "is empty; a URDF file is needed")
    return _checked(path, raw)


def _checked(path: Path, raw: bytes) -> Parsed:
    """Root element of the bytes of a file, and notices; raises ConfigError as `parse`."""
    text, notices = decode(raw)
    if (start := text.find("<!DOCTYPE")) >= 0:
        raise file_error(path, _DOCTYPE, text.count("\n", 0, start) + 1)
    try:
        root, xml_notices = parse_text(text)
    except ImportError:
        raise file_error(path, "needs lxml, which reads robot files: pip install 'granular-contact[robot]'") from None
    except DamagedXML as error:
        raise file_error(path, f"is not valid XML: {' '.join(str(error).split())[:160]}", error.line) from None
    faults = [Fault(str(path), line, "", words) for line, words in (*notices, *xml_notices)]
    return Parsed(_checked_root(path, root), faults)


def _checked_root(path: Path, root: Element) -> Element:
    """The root element, if it is `<robot>` and nothing in the file is written in xacro."""
    _, tag = _space_and_tag(root)
    if tag != "robot":
        raise file_error(
            path, _OTHERS.get(tag, f"is not a URDF: its root is <{tag[:40]}>, allowed is <robot>"), root.sourceline
        )
    for element in root.iter():
        if not isinstance(element.tag, str):  # a comment
            continue
        if "xacro" in _space_and_tag(element)[0] or "${" in "".join(element.attrib.values()):
            raise file_error(path, _XACRO, element.sourceline)
    return root


def _space_and_tag(element: Element) -> tuple[str, str]:
    """Namespace of an element (its prefix if that is not declared), and its tag without it."""
    if element.tag.startswith("{"):
        space, _, tag = element.tag[1:].partition("}")
    else:
        space, _, tag = element.tag.rpartition(":")
    return space, tag


def file_error(path: Path, message: str, line: int | None = None) -> ConfigError:
    """Error of a file, or of a line of it."""
    return ConfigError([Fault(str(path), line, "", message)])
