"""Provenance of a medium, corrected where a config changes some of its numbers.

A preset with a changed number is no longer published, and a fitted medium no longer fitted.
"""

from __future__ import annotations

from granular_contact.config.tree import Items, Mapping, Node, Scalar, child, plain, set_key

ABOUT = frozenset(
    {"law", "name", "source", "standing", "provenance", "range", "scatter", "measured_scatter", "angle_of_repose_deg"}
)  # all else is a number of the law


def restated(base: Node | None, node: Node) -> Node:
    """The medium `node`, merged over the medium `base`, with its provenance corrected if a number was changed.

    A provenance or standing that was overridden stays, and so does a medium without either.
    """
    if not isinstance(base, Mapping) or not isinstance(node, Mapping) or base is node:
        return node
    numbers = sorted(key for key in node.nodes.keys() - ABOUT if _is_changed(base.nodes.get(key), node.nodes[key]))
    if not numbers or not any(_says(base, key) for key in ("provenance", "standing")):
        return node
    at = node.keys[numbers[0]]
    own = {"provenance": "own", "standing": _standing(base, numbers)}
    for key, text in own.items():
        if node.nodes.get(key) is base.nodes.get(key):
            node = set_key(node, key, Scalar(at, text, text), at)
    return node


def restated_each(base: Node | None, node: Node) -> Node:
    """`restated` of one medium, or of each in a list."""
    if isinstance(base, Items) and isinstance(node, Items) and len(base.nodes) == len(node.nodes):
        return Items(node.position, tuple(map(restated, base.nodes, node.nodes)))
    return restated(base, node)


def _is_changed(before: Node | None, after: Node) -> bool:
    """Whether a number was changed; giving one that its source leaves open (null) is no change.

    A group of numbers that is null, as withdrawing, is not open: it means other numbers of the medium.
    """
    if before is after:
        return False
    if isinstance(before, Scalar) and before.value is None:
        return isinstance(after, Mapping)
    return before is None or plain(before) != plain(after)


def _says(medium: Mapping, key: str) -> bool:
    held = child(medium, key)
    return held is not None and plain(held) is not None


def _standing(base: Mapping, numbers: list[str]) -> str:
    name, held = (child(base, key) for key in ("name", "standing"))
    said = f"changed from {plain(name) if name is not None else 'another'}: "
    before = str(plain(held)) if held is not None else ""
    earlier = before.removeprefix(said).split(", ") if before.startswith(said) else []
    return said + ", ".join(sorted({*earlier, *numbers}))
