"""A YAML document as a tree with the position of each part.

Trees are never changed in place: an alias shares its node with the anchor, and both would change. Nodes compare by
identity, so that shared ones can be distinguished from equal ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from granular_contact.errors import Fault
from granular_contact.values.scalars import ScalarValue

Path = tuple[str | int, ...]


class Position(NamedTuple):
    """Position in a file; line from 1, None for the command line."""

    file: str
    line: int | None

    def fault(self, path: Path, message: str) -> Fault:
        """A fault at this place, under the dotted `path`."""
        return Fault(self.file, self.line, dotted(path), message)


@dataclass(frozen=True, eq=False)
class Scalar:
    """A number, text, boolean or null, with its spelling in the file."""

    position: Position
    value: ScalarValue
    text: str


@dataclass(frozen=True, eq=False)
class Items:
    """A YAML sequence; its position is that of the key it belongs to."""

    position: Position
    nodes: tuple[Node, ...]


@dataclass(frozen=True, eq=False)
class Mapping:
    """A YAML mapping; its position is that of the key it belongs to. `keys` holds the position of each key."""

    position: Position
    nodes: dict[str, Node] = field(default_factory=dict)
    keys: dict[str, Position] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Broken:
    """Marks a place with a known fault, about which no other is reported."""

    position: Position


Node = Scalar | Items | Mapping | Broken
BROKEN = object()


def dotted(path: Iterable[str | int]) -> str:
    """`('a', 0, 'b')` as `a.0.b`."""
    return ".".join(map(str, path))


def plain(node: Node) -> Any:
    """The tree without positions; a broken part becomes `BROKEN`, which no schema accepts."""
    if isinstance(node, Scalar):
        return node.value
    if isinstance(node, Items):
        return [plain(item) for item in node.nodes]
    if isinstance(node, Mapping):
        return {key: plain(value) for key, value in node.nodes.items()}
    return BROKEN


def mapping(nodes: dict[str, Node], at: Position) -> Mapping:
    """A mapping whose keys have the positions of their values."""
    return Mapping(at, nodes, {key: node.position for key, node in nodes.items()})


def made(value: Any, at: Position) -> Node:
    """The tree of plain data (dict, list, scalars), with one position for all of it."""
    if isinstance(value, dict):
        nodes = {key: made(held, at) for key, held in value.items()}
        return Mapping(at, nodes, dict.fromkeys(nodes, at))
    return (
        Items(at, tuple(made(held, at) for held in value))
        if isinstance(value, list)
        else Scalar(at, value, _text(value))
    )


def _text(value: Any) -> str:
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return value if isinstance(value, str) else repr(value)


def index_of(key: str | int, items: Items) -> int | None:
    """`key` as the index of one of `items`, or None."""
    text = str(key)
    # int() raises for thousands of digits.
    if text.isascii() and text.isdecimal() and len(text) < 10 and int(text) < len(items.nodes):
        return int(text)
    return None


def child(node: Node, key: str | int) -> Node | None:
    """The value under `key` (a list takes its index as int or digits), or None."""
    if isinstance(node, Mapping):
        return node.nodes.get(str(key))
    if isinstance(node, Items) and (index := index_of(key, node)) is not None:
        return node.nodes[index]
    return None


def find(node: Node, path: Sequence[str | int]) -> tuple[Node, Sequence[str | int]]:
    """The deepest node on `path`, and the part of the path that is missing below it."""
    for depth, key in enumerate(path):
        below = child(node, key)
        if below is None:
            return node, path[depth:]
        node = below
    return node, ()


def key_position(node: Node, path: Path) -> Position:
    """Where the last key of `path` was written, or the mapping that should hold it."""
    holder, missing = find(node, path[:-1])
    if missing or not path or not isinstance(holder, Mapping):
        return find(node, path)[0].position
    return holder.keys.get(str(path[-1]), holder.position)


def set_key(node: Mapping, key: str, value: Node, position: Position) -> Mapping:
    """A copy of `node` in which `key`, written at `position`, holds `value`."""
    return Mapping(node.position, {**node.nodes, key: value}, {**node.keys, key: position})


def under(node: Node, key: str, change: Callable[[Node], Node]) -> Node:
    """`node` with what stands under a key changed, if it is there."""
    if not isinstance(node, Mapping) or key not in node.nodes:
        return node
    return set_key(node, key, change(node.nodes[key]), node.keys[key])


def rewritten(node: Node, change: Callable[[Mapping, Path], Node | None], path: Path) -> Node:
    """`node`, which stands at `path`, with other parts where `change` gives them.

    change: asked of each mapping, with its path; what it gives stands there, and where it gives None the parts of the
    mapping are gone through. A list of scalars has no such parts.
    """
    if isinstance(node, Items) and node.nodes and not isinstance(node.nodes[0], Scalar):
        return Items(node.position, tuple(rewritten(one, change, (*path, i)) for i, one in enumerate(node.nodes)))
    if not isinstance(node, Mapping):
        return node
    if (made := change(node, path)) is not None:
        return made
    parts = {key: rewritten(below, change, (*path, key)) for key, below in node.nodes.items()}
    return Mapping(node.position, parts, node.keys)


def drop_key(node: Mapping, key: str) -> Mapping:
    """A copy of `node` without `key`."""
    return Mapping(node.position, {k: n for k, n in node.nodes.items() if k != key}, node.keys)


def merge(base: Node, top: Node) -> Node:
    """`top` merged over `base`: mappings are merged key by key, anything else (also null) replaces the value below."""
    if not isinstance(base, Mapping) or not isinstance(top, Mapping):
        return top
    nodes = {**base.nodes}
    for key, value in top.nodes.items():
        nodes[key] = merge(nodes[key], value) if key in nodes else value
    return Mapping(top.position, nodes, {**base.keys, **top.keys})
