"""Tree of a YAML document, with the file and line of each node.

Trees are never changed in place: an alias shares its node with the anchor, so both would change. Nodes compare by
identity, so that a shared node differs from an equal one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from granular_contact.errors import Fault
from granular_contact.values.scalars import ScalarValue

Path = tuple[str | int, ...]


class Position(NamedTuple):
    """Position in a file: its name and the line, from 1; the line is None for the command line and a whole file."""

    file: str
    line: int | None

    def fault(self, path: Path, message: str) -> Fault:
        """A fault of the key `path` at this position."""
        return Fault(self.file, self.line, dotted(path), message)


@dataclass(frozen=True, eq=False)
class Scalar:
    """A number, text, boolean or null; text: its spelling in the file."""

    position: Position
    value: ScalarValue
    text: str


@dataclass(frozen=True, eq=False)
class Items:
    """A YAML sequence; its position is that of its key."""

    position: Position
    nodes: tuple[Node, ...]


@dataclass(frozen=True, eq=False)
class Mapping:
    """A YAML mapping; its position is that of its key. nodes: values by key; keys: positions of the keys."""

    position: Position
    nodes: dict[str, Node] = field(default_factory=dict)
    keys: dict[str, Position] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Broken:
    """Placeholder of a faulty node. Its fault is known, and no other fault is reported about it."""

    position: Position


Node = Scalar | Items | Mapping | Broken
BROKEN = object()


def dotted(path: Iterable[str | int]) -> str:
    """`('a', 0, 'b')` as `a.0.b`."""
    return ".".join(map(str, path))


def plain(node: Node) -> Any:
    """The tree as plain data, without positions; a `Broken` node becomes `BROKEN`, which no schema accepts."""
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


def from_plain(value: Any, at: Position) -> Node:
    """The tree of plain data (dict, list, scalars), all nodes at one position."""
    if isinstance(value, dict):
        nodes = {key: from_plain(below, at) for key, below in value.items()}
        return Mapping(at, nodes, dict.fromkeys(nodes, at))
    return (
        Items(at, tuple(from_plain(item, at) for item in value))
        if isinstance(value, list)
        else Scalar(at, value, _text(value))
    )


def _text(value: Any) -> str:
    """Spelling of a scalar in YAML."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return value if isinstance(value, str) else repr(value)


def index_of(key: str | int, items: Items) -> int | None:
    """`key` (int or digits) as an index into `items`; None if it is none."""
    text = str(key)
    # int() raises for thousands of digits.
    if text.isascii() and text.isdecimal() and len(text) < 10 and int(text) < len(items.nodes):
        return int(text)
    return None


def child(node: Node, key: str | int) -> Node | None:
    """The node under `key`, of a list the item with this index (int or digits); None if there is none."""
    if isinstance(node, Mapping):
        return node.nodes.get(str(key))
    if isinstance(node, Items) and (index := index_of(key, node)) is not None:
        return node.nodes[index]
    return None


def find(node: Node, path: Sequence[str | int]) -> tuple[Node, Sequence[str | int]]:
    """The deepest node that exists on `path`, and the rest of the path below it."""
    for depth, key in enumerate(path):
        below = child(node, key)
        if below is None:
            return node, path[depth:]
        node = below
    return node, ()


def key_position(node: Node, path: Path) -> Position:
    """Position of the last key of `path`; if it does not exist, of the deepest node on the path."""
    holder, missing = find(node, path[:-1])
    if missing or not path or not isinstance(holder, Mapping):
        return find(node, path)[0].position
    return holder.keys.get(str(path[-1]), holder.position)


def set_key(node: Mapping, key: str, value: Node, position: Position) -> Mapping:
    """A copy of `node` in which `key`, written at `position`, holds `value`."""
    return Mapping(node.position, {**node.nodes, key: value}, {**node.keys, key: position})


def change_key(node: Node, key: str, change: Callable[[Node], Node]) -> Node:
    """`node` with `change` applied to the value under a key, if the key exists."""
    if not isinstance(node, Mapping) or key not in node.nodes:
        return node
    return set_key(node, key, change(node.nodes[key]), node.keys[key])


def replace_mappings(node: Node, change: Callable[[Mapping, Path], Node | None], path: Path) -> Node:
    """`node`, which is at `path`, with mappings replaced by what `change` returns for them.

    change: called with each mapping and its path, from the top down. It returns the replacement, or None: the mapping
    stays, and `change` is called for the mappings in it. Lists of scalars are skipped.
    """
    if isinstance(node, Items) and node.nodes and not isinstance(node.nodes[0], Scalar):
        return Items(
            node.position, tuple(replace_mappings(item, change, (*path, i)) for i, item in enumerate(node.nodes))
        )
    if not isinstance(node, Mapping):
        return node
    if (replacement := change(node, path)) is not None:
        return replacement
    nodes = {key: replace_mappings(below, change, (*path, key)) for key, below in node.nodes.items()}
    return Mapping(node.position, nodes, node.keys)


def drop_key(node: Mapping, key: str) -> Mapping:
    """A copy of `node` without `key`."""
    return Mapping(node.position, {k: n for k, n in node.nodes.items() if k != key}, node.keys)


def merge(base: Node, top: Node) -> Node:
    """`top` merged over `base`: mappings are merged key by key; any other value, also null, replaces that of `base`."""
    if not isinstance(base, Mapping) or not isinstance(top, Mapping):
        return top
    nodes = {**base.nodes}
    for key, value in top.nodes.items():
        nodes[key] = merge(nodes[key], value) if key in nodes else value
    return Mapping(top.position, nodes, {**base.keys, **top.keys})
