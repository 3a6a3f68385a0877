"""`--set dotted.key=value` and cases of sweeps: new values in the tree of a config, before it is checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from granular_contact.config import allowed, tree
from granular_contact.config.file_kind import scenario_class
from granular_contact.config.messages import got
from granular_contact.config.yaml_source import MAX_DEPTH, read_text
from granular_contact.errors import Fault

# What these hold is itself a reference, so they must be set before references are resolved.
_REFERENCES = (
    *((*path, *more) for path in (("model",), ("medium",), ("bed", "layers", "medium")) for more in ((), ("from",))),
    *(("bed",), ("bed", "layers")),
)


@dataclass(frozen=True)
class Override:
    """One `--set`, or one key of a sweep: the value that goes under the key `path`."""

    path: tuple[str, ...]
    value: tree.Node
    position: tree.Position

    @property
    def is_reference(self) -> bool:
        """Whether it must be applied before the model and the medium are read."""
        return _is_reference(self.path)


@lru_cache(maxsize=1024)
def _is_reference(path: tuple[str, ...]) -> bool:
    return tuple(key for key in path if not key.isdecimal()) in _REFERENCES


def parse(texts: Sequence[str], faults: list[Fault]) -> list[Override]:
    """Overrides in the given order, without those that a later one replaces as a whole."""
    return effective([one for text in texts if (one := _parse(text, faults)) is not None])


def effective(overrides: Sequence[Override]) -> list[Override]:
    """The overrides without those that a later one replaces as a whole."""
    return [
        one
        for i, one in enumerate(overrides)
        if not any(one.path[: len(later.path)] == later.path for later in overrides[i + 1 :])
    ]


def split(key: str, position: tree.Position, faults: list[Fault], form: str = "dotted.key") -> tuple[str, ...] | None:
    """The parts of a dotted key; None, with a fault that names the allowed `form`, for one that can't be used."""
    path = tuple(key.strip().split("."))
    if not all(path):
        faults.append(position.fault((), f"is not a {form}"))
    elif len(path) > MAX_DEPTH:
        faults.append(position.fault((), f"leads more than {MAX_DEPTH} levels deep"))
    else:
        return path
    return None


def _parse(text: str, faults: list[Fault]) -> Override | None:
    position = tree.Position(f"--set {text}", None)
    key, equals, value = text.partition("=")
    path = split(key if equals else "", position, faults, form="dotted.key=value")
    if path is None:
        return None
    if not value.strip():
        faults.append(position.fault(path, "has no value; write null for none"))
        return None
    return Override(path, read_text(value, position.file, faults, path, numbered=False), position)


def apply(root: tree.Node, overrides: Sequence[Override], faults: list[Fault]) -> tree.Node:
    """`root` with the overrides in it; one without a place is a fault.

    null takes out a key that may be left out and takes no null, so that its default holds.
    """
    for override in overrides:
        if _is_nothing(override.value) and allowed.may_go(override.path, root, scenario_class(root)):
            root = _without(root, override.path)
        else:
            root = _placed(root, override, 0, faults)
    return root


def _without(node: tree.Node, path: tuple[str, ...]) -> tree.Node:
    """A copy of a node without what stands at a path below it."""
    key = path[0]
    if isinstance(node, tree.Items):
        at = tree.index_of(key, node)
        items = (_without(one, path[1:]) if i == at else one for i, one in enumerate(node.nodes))
        return tree.Items(node.position, tuple(items))
    if len(path) > 1:
        return tree.under(node, key, lambda below: _without(below, path[1:]))
    return tree.drop_key(node, key) if isinstance(node, tree.Mapping) else node


def _placed(node: tree.Node | None, override: Override, depth: int, faults: list[Fault]) -> tree.Node:
    """A copy of `node`, which stands under the first `depth` keys of the override, with the value in its place."""
    if depth == len(override.path):
        return override.value
    key = override.path[depth]
    if isinstance(node, tree.Mapping) or _is_nothing(node):
        holder = node if isinstance(node, tree.Mapping) else _begun(override, depth)
        value = _placed(holder.nodes.get(key), override, depth + 1, faults)
        at = override.position if depth + 1 == len(override.path) else holder.keys.get(key, override.position)
        return tree.set_key(holder, key, value, at)
    if isinstance(node, tree.Items):
        return _placed_in_list(node, override, depth, faults)
    if isinstance(node, tree.Scalar):
        held = override.path[:depth]
        faults.append(override.position.fault(override.path, f"{'.'.join(held)} is {got(node)}, which has no keys"))
    return node if node is not None else tree.Broken(override.position)


def _begun(override: Override, depth: int) -> tree.Mapping:
    """A new mapping where the config has none; in a union one of the default kind."""
    empty, tag = tree.Mapping(override.position), allowed.default_tag(override.path[:depth])
    if tag is None:
        return empty
    return tree.set_key(empty, tag[0], tree.Scalar(override.position, tag[1], tag[1]), override.position)


def _is_nothing(node: tree.Node | None) -> bool:
    return node is None or (isinstance(node, tree.Scalar) and node.value is None)


def _placed_in_list(node: tree.Items, override: Override, depth: int, faults: list[Fault]) -> tree.Items:
    key = override.path[depth]
    index = tree.index_of(key, node)
    if index is None:
        allowed = f"0 to {len(node.nodes) - 1}" if node.nodes else "none"
        message = f"got {key!r} as the number of a list item; allowed is {allowed}"
        faults.append(override.position.fault(override.path, message))
        return node
    items = list(node.nodes)
    items[index] = _placed(items[index], override, depth + 1, faults)
    return tree.Items(node.position, tuple(items))
