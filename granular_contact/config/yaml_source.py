"""Text of one YAML file -> positioned tree. Builds numbers, texts, lists and mappings, never a Python object.

All problems become faults: a file that can't be read at all is one fault, and a `Broken` root.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path as FilePath

import yaml

from granular_contact.config.compose import MAX_DEPTH, Composer, Stop
from granular_contact.config.tree import Broken, Node, Path, Position
from granular_contact.errors import Fault

MAX_BYTES = 1_000_000
_PLAIN_WORDS = (
    ("tab character", "a tab in the indentation; indent with spaces"),
    ("cannot start any token", "a character that can't start a value: a tab, % or @; indent with spaces, quote texts"),
    (
        "mapping values are not allowed",
        "a ':' where no key can stand; check the indentation, and quote a text with ':'",
    ),
    ("expected ':'", "a key without ':' behind it"),
    ("expected ',' or ']'", "a list opened with [ has no ',' or ']' where one is due"),
    ("expected ',' or '}'", "a mapping opened with { has no ',' or '}' where one is due"),
    ("unexpected end of stream", "a quoted text is not closed"),
    ("expected key", "the indentation fits no mapping above, or the line is not 'key: value'"),
    ("expected <block end>", "the indentation fits no mapping above, or the line is not 'key: value'"),
    ("'-' indicator", "the indentation fits no list above, or the line is not '- item'"),
    ("while parsing a tag", "a '!' where none can stand; tags are not used here"),
    ("maximum nesting depth", f"it is nested more than {MAX_DEPTH} levels deep"),  # PyYAML's own, from 6.0.4 on
)


def read_file(path: FilePath, faults: list[Fault]) -> Node:
    """Tree of the YAML file `path`; what is wrong with it is appended to `faults`, and is `Broken` in the tree."""
    whole = Position(str(path), None)
    try:
        if path.is_dir():
            raise Stop(whole, (), "is a folder; a YAML file is needed")
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
        if len(raw) > MAX_BYTES:
            raise Stop(whole, (), f"is larger than {MAX_BYTES} bytes, the most that is read")
        text = raw.decode("utf-8-sig")
    except Stop as stop:
        faults.append(stop.fault)
    except FileNotFoundError:
        faults.append(whole.fault((), "no such file"))
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        faults.append(Position(str(path), line).fault((), "is not text in UTF-8; save it as UTF-8"))
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        faults.append(whole.fault((), f"can't be read: {reason}"))
    else:
        node, found = _read(text, str(path))
        faults += found
        return node
    return Broken(whole)


@lru_cache(maxsize=16)
def _read(text: str, file: str) -> tuple[Node, tuple[Fault, ...]]:
    """Tree of the text of a file, with its faults; models and media are read for one config after another."""
    faults: list[Fault] = []
    return read_text(text, file, faults), tuple(faults)


def read_text(text: str, file: str, faults: list[Fault], path: Path = (), numbered: bool = True) -> Node:
    """Tree of the YAML `text`.

    file: name for the positions; `numbered=False` leaves lines out, for a text from the command line.
    path: key under which the text will stand. Faults are appended to `faults`.
    """
    composer = Composer(text, file, faults, numbered)
    try:
        if odd := yaml.reader.Reader.NON_PRINTABLE.search(text):
            line = text.count("\n", 0, odd.start()) + 1 if numbered else None
            raise Stop(
                Position(file, line), path, f"holds the character {odd.group()!a}; only printable text is allowed"
            )
        return composer.document(path)
    except Stop as stop:
        faults.append(stop.fault)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        faults.append(composer.position(mark).fault(path, _in_plain_words(error)))
    return Broken(Position(file, None))


def _in_plain_words(error: yaml.MarkedYAMLError) -> str:
    raw = f"{error.context or ''} {error.problem or ''}"
    words = next((plain for part, plain in _PLAIN_WORDS if part in raw), None)
    if words is None:
        return f"is not valid YAML: {error.problem}"
    start, end = error.context_mark, error.problem_mark
    since = f" (begun in line {start.line + 1})" if start and end and start.line < end.line else ""
    return f"is not valid YAML: {words}{since}"
