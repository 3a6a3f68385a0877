"""Parse the text of one YAML file into a tree with positions.

The tree contains numbers, texts, lists and mappings, never a Python object. All problems become faults; a file that
can't be read at all gives one fault and a `Broken` root. PyYAML delivers the events, which are composed here for three
reasons: every value gets its line, duplicate keys are found (PyYAML silently takes the last one), and aliases and
nesting are limited.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path as FilePath
from typing import Any

import yaml

from granular_contact.config.tree import Broken, Items, Mapping, Node, Path, Position, Scalar
from granular_contact.errors import Fault
from granular_contact.values.scalars import resolve

MAX_DEPTH = 64
MAX_ALIASED_NODES = 10_000

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class Stop(Exception):
    """Raised if the rest of the file can't be read; `fault` gives the reason."""

    def __init__(self, position: Position, path: Path, message: str) -> None:
        super().__init__(message)
        self.fault = position.fault(path, message)


class Composer:
    """Composes the events of one document into a tree.

    Faults after which the rest is readable are appended to `faults`; for other faults `Stop` is raised. numbered:
    whether positions have lines.
    """

    def __init__(self, text: str, file: str, faults: list[Fault], numbered: bool) -> None:
        self._text, self._file, self._faults, self._numbered = text, file, faults, numbered
        self._events: Iterator[Any] = iter(())
        self._anchors: dict[str, Node | None] = {}
        self._measures: dict[Node, tuple[int, int]] = {}
        self._aliased = 0

    def position(self, mark: Any) -> Position:
        """Position of a mark of PyYAML."""
        return Position(self._file, mark.line + 1 if mark and self._numbered else None)

    def document(self, path: Path) -> Node:
        """Root of the only document; path: key of the config under which it will be."""
        self._events = yaml.parse(self._text, Loader=_LOADER)
        next(self._events)
        start = next(self._events)
        if isinstance(start, yaml.StreamEndEvent):
            raise Stop(Position(self._file, 1 if self._numbered else None), path, "is empty; a mapping is needed")
        root = self._node(next(self._events), path, 0)
        next(self._events)
        following = next(self._events)
        if not isinstance(following, yaml.StreamEndEvent):
            raise Stop(
                self.position(following.start_mark), (), "a second document starts here; one per file is allowed"
            )
        return root

    def _node(self, event: Any, path: Path, depth: int, at: Position | None = None) -> Node:
        """The node that begins with `event`; at: position of its key, if it has one."""
        position = self.position(event.start_mark)
        if depth > MAX_DEPTH:
            raise Stop(position, (), f"is nested more than {MAX_DEPTH} levels deep")
        if isinstance(event, yaml.AliasEvent):
            return self._alias(event, path, depth, position)
        if event.anchor:
            self._anchors[event.anchor] = None
        node: Node
        if isinstance(event, yaml.ScalarEvent):
            node = Scalar(position, resolve(event.value) if event.implicit[0] else event.value, event.value)
        elif isinstance(event, yaml.SequenceStartEvent):
            node = self._items(at or position, path, depth)
        else:
            node = self._mapping(at or position, path, depth)
        if event.tag is not None:
            node = self._broken(position, path, f"got the tag {event.tag!r}; tags are not used here, leave it out")
        if event.anchor:
            self._anchors[event.anchor] = node
        return node

    def _broken(self, position: Position, path: Path, message: str) -> Broken:
        """Append a fault, and return the node that stands for the faulty one."""
        self._faults.append(position.fault(path, message))
        return Broken(position)

    def _alias(self, event: Any, path: Path, depth: int, position: Position) -> Node:
        """The node of the anchor that an alias refers to."""
        known = self._anchors.get(event.anchor)
        if known is None:
            inside = event.anchor in self._anchors
            problem = "refers to an anchor that contains it" if inside else f"has no anchor &{event.anchor} above it"
            return self._broken(position, path, f"the alias *{event.anchor} {problem}")
        size, height = self._measure(known)
        self._aliased += size
        if self._aliased > MAX_ALIASED_NODES:
            raise Stop(position, path, f"the aliases expand to more than {MAX_ALIASED_NODES} values")
        if depth + height > MAX_DEPTH:
            raise Stop(position, (), f"is nested more than {MAX_DEPTH} levels deep")
        return known

    def _measure(self, node: Node) -> tuple[int, int]:
        """Number of values in `node` with its aliases expanded, and its height; kept for each node."""
        if node not in self._measures:
            below: list[Node] = []
            if isinstance(node, Items | Mapping):
                below = list(node.nodes if isinstance(node, Items) else node.nodes.values())
            parts = [self._measure(part) for part in below]
            self._measures[node] = (1 + sum(s for s, _ in parts), 1 + max((h for _, h in parts), default=0))
        return self._measures[node]

    def _items(self, position: Position, path: Path, depth: int) -> Items:
        nodes: list[Node] = []
        while not isinstance(event := next(self._events), yaml.SequenceEndEvent):
            nodes.append(self._node(event, (*path, len(nodes)), depth + 1))
        return Items(position, tuple(nodes))

    def _mapping(self, position: Position, path: Path, depth: int) -> Mapping:
        nodes: dict[str, Node] = {}
        keys: dict[str, Position] = {}
        while not isinstance(event := next(self._events), yaml.MappingEndEvent):
            at = self.position(event.start_mark)
            key = self._key(event, path, depth + 1)
            value = self._node(next(self._events), path if key is None else (*path, key), depth + 1, at)
            if key in keys:
                lines = f"in lines {keys[key].line} and {at.line}" if self._numbered else "twice"
                self._faults.append(at.fault((*path, key), f"the key is given {lines}; once is allowed"))
            elif key is not None:
                nodes[key], keys[key] = value, at
        return Mapping(position, nodes, keys)

    def _key(self, event: Any, path: Path, depth: int) -> str | None:
        """The key that begins with `event`; None, with a fault, for a key that is no text."""
        is_scalar = isinstance(event, yaml.ScalarEvent)
        node = self._node(event, path, depth)
        position = self.position(event.start_mark)
        if is_scalar and event.implicit[0] and event.value == "<<":
            self._broken(position, path, "got the merge key <<; it is not supported, `from:` does that for models")
        elif isinstance(node, Scalar) and isinstance(node.value, str):
            return node.value
        elif not isinstance(node, Broken):
            got = f"the key {node.text or 'null'}" if isinstance(node, Scalar) else "a list or mapping as key"
            self._broken(position, path, f"got {got}; a key is a text (quote it if it is one), decimals have a point")
        return None


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
    """Tree of the YAML file `path`. Faults are appended to `faults`; faulty nodes are `Broken`."""
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
        node, text_faults = _read(text, str(path))
        faults += text_faults
        return node
    return Broken(whole)


@lru_cache(maxsize=16)
def _read(text: str, file: str) -> tuple[Node, tuple[Fault, ...]]:
    """Tree of the text of a file, with its faults. It is kept, since many configs use the same models and media."""
    faults: list[Fault] = []
    return read_text(text, file, faults), tuple(faults)


def read_text(text: str, file: str, faults: list[Fault], path: Path = (), numbered: bool = True) -> Node:
    """Tree of the YAML `text`.

    file: name for the positions. path: key of the config under which the tree will be. numbered: False for a text from
    the command line, whose positions have no line. Faults are appended to `faults`.
    """
    composer = Composer(text, file, faults, numbered)
    try:
        if unprintable := yaml.reader.Reader.NON_PRINTABLE.search(text):
            line = text.count("\n", 0, unprintable.start()) + 1 if numbered else None
            message = f"holds the character {unprintable.group()!a}; only printable text is allowed"
            raise Stop(Position(file, line), path, message)
        return composer.document(path)
    except Stop as stop:
        faults.append(stop.fault)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        faults.append(composer.position(mark).fault(path, _in_plain_words(error)))
    return Broken(Position(file, None))


def _in_plain_words(error: yaml.MarkedYAMLError) -> str:
    """Message for a syntax error of PyYAML."""
    raw = f"{error.context or ''} {error.problem or ''}"
    explanation = next((plain for part, plain in _PLAIN_WORDS if part in raw), None)
    if explanation is None:
        return f"is not valid YAML: {error.problem}"
    start, end = error.context_mark, error.problem_mark
    since = f" (begun in line {start.line + 1})" if start and end and start.line < end.line else ""
    return f"is not valid YAML: {explanation}{since}"
