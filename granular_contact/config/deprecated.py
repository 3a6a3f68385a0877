"""Deprecated keys in the tree of a config: notices with their replacement, and which of old and new key counts."""

from __future__ import annotations

from granular_contact.config import tree
from granular_contact.config.schema.deprecated import SUCCESSORS, successor


def renewed(node: tree.Node, key: str, notices: list[str]) -> tree.Node:
    """The tree under a key of a scenario without keys that an old or new name of the same thing overrides; a notice for
    each old key left.
    """

    def change(node: tree.Mapping, path: tree.Path) -> tree.Node | None:
        known = SUCCESSORS.get(str(tree.plain(node.nodes["type"])), {}) if "type" in node.nodes else {}
        for old, new in known.items():
            if old in node.nodes and new in node.nodes and (covered := _covered(node, old, new)) is not None:
                node = tree.drop_key(node, covered)
            if old in node.nodes:
                notices.append(_notice((*path, old), node.nodes[old], node.keys[old], new))
        return node if known else None

    return tree.rewritten(node, change, (key,)) if key == "model" else node


def _covered(node: tree.Mapping, old: str, new: str) -> str | None:
    """Which of two names of one key is overridden by the other, in an override or a model built on another."""
    over = {key: (node.keys[key].line is None, node.keys[key].file == node.position.file) for key in (old, new)}
    if over[old] == over[new]:
        return None
    return new if over[old] > over[new] else old


def _notice(path: tree.Path, node: tree.Node, at: tree.Position, new: str) -> str:
    value, instead = tree.plain(node), new
    if isinstance(value, int | float) and not isinstance(value, bool):
        found = successor(str(path[-1]), float(value))
        shown = f"[{found[0]:.6g}, {found[1]:.6g}]" if isinstance(found, list) else f"{found:g}"
        instead = f"{new}: {shown}"
    place = at.file if at.line is None else f"{at.file}:{at.line}"
    return f"{place}: {tree.dotted(path)}: is counter-clockwise; write {instead}, as all angles are clockwise now"
