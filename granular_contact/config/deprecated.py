"""Deprecated keys in the tree of a config: notices with their replacement, and which of old and new key counts."""

from __future__ import annotations

from granular_contact.config import tree
from granular_contact.config.schema.deprecated import SUCCESSORS, successor

Path = tuple[str, ...]


def renewed(node: tree.Node, notices: list[str]) -> tree.Node:
    """The tree without keys that an old or new name of the same thing overrides; a notice for each old key left."""
    return _within(node, (), notices)


def _within(node: tree.Node, path: Path, notices: list[str]) -> tree.Node:
    if isinstance(node, tree.Items):
        items = tuple(_within(one, (*path, str(i)), notices) for i, one in enumerate(node.nodes))
        return tree.Items(node.position, items)
    if not isinstance(node, tree.Mapping) or path[:1] not in ((), ("model",)):
        return node
    nodes = {key: _within(one, (*path, key), notices) for key, one in node.nodes.items()}
    known = SUCCESSORS.get(str(tree.plain(nodes["type"])), {}) if "type" in nodes else {}
    for old, new in known.items():
        if old not in nodes:
            continue
        if new in nodes and (covered := _covered(node, old, new)) is not None:
            del nodes[covered]
        if old in nodes:
            notices.append(_notice((*path, old), nodes[old], node.keys[old], new))
    return tree.Mapping(node.position, nodes, {key: node.keys[key] for key in nodes})


def _covered(node: tree.Mapping, old: str, new: str) -> str | None:
    """Which of two names of one key is overridden by the other, in an override or a model built on another."""
    over = {key: (node.keys[key].line is None, node.keys[key].file == node.position.file) for key in (old, new)}
    if over[old] == over[new]:
        return None
    return new if over[old] > over[new] else old


def _notice(path: Path, node: tree.Node, at: tree.Position, new: str) -> str:
    value, instead = tree.plain(node), new
    if isinstance(value, int | float) and not isinstance(value, bool):
        found = successor(path[-1], float(value))
        shown = f"[{found[0]:.6g}, {found[1]:.6g}]" if isinstance(found, list) else f"{found:g}"
        instead = f"{new}: {shown}"
    place = at.file if at.line is None else f"{at.file}:{at.line}"
    return f"{place}: {'.'.join(path)}: is counter-clockwise; write {instead}, as all angles are clockwise now"
