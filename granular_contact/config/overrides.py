"""Overrides: `--set dotted.key=value` and values of sweep cases, put into the tree of a config before it is checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from granular_contact.config import allowed, tree
from granular_contact.config.file_kind import scenario_class
from granular_contact.config.messages import got
from granular_contact.config.schema.robot import RobotFile
from granular_contact.config.yaml_source import MAX_DEPTH, read_text
from granular_contact.errors import Fault

# Keys (list indices left out) whose value is or contains a reference. They are set before references are resolved.
_REFERENCES = (
    *((*path, *more) for path in (("model",), ("medium",), ("bed", "layers", "medium")) for more in ((), ("from",))),
    *(("bed",), ("bed", "layers")),
)


@dataclass(frozen=True)
class Override:
    """A new value for the key `path`, from `--set`, a sweep or Python; position: where the override was written."""

    path: tuple[str, ...]
    value: tree.Node
    position: tree.Position

    @property
    def is_reference(self) -> bool:
        """Whether the value is or contains a reference, so that it is set before references are resolved."""
        return _is_reference(self.path)


@lru_cache(maxsize=1024)
def _is_reference(path: tuple[str, ...]) -> bool:
    return _is_of_robot_file(path) or tuple(key for key in path if not key.isdecimal()) in _REFERENCES


def _is_of_robot_file(path: tuple[str, ...]) -> bool:
    """Whether a key stands beside `urdf`. It says how the robot file is read, so it is set before that."""
    return path[0] == "model" and len(path) > 1 and path[1] in RobotFile.model_fields


def parse(texts: Sequence[str], faults: list[Fault]) -> list[Override]:
    """The effective overrides of texts `dotted.key=value`, in the given order."""
    return effective([override for text in texts if (override := _parse(text, faults)) is not None])


def effective(overrides: Sequence[Override]) -> list[Override]:
    """The overrides without those whose value a later override replaces as a whole."""
    return [
        override
        for i, override in enumerate(overrides)
        if not any(override.path[: len(later.path)] == later.path for later in overrides[i + 1 :])
    ]


def split(key: str, position: tree.Position, faults: list[Fault], form: str = "dotted.key") -> tuple[str, ...] | None:
    """The parts of a dotted key; None, with a fault that names the allowed `form`, for an invalid key."""
    path = tuple(key.strip().split("."))
    if not all(path):
        faults.append(position.fault((), f"is not a {form}"))
    elif len(path) > MAX_DEPTH:
        faults.append(position.fault((), f"leads more than {MAX_DEPTH} levels deep"))
    else:
        return path
    return None


def _parse(text: str, faults: list[Fault]) -> Override | None:
    """The override of a text `dotted.key=value`; None, with a fault, for any other text."""
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
    """`root` with the overrides set. An override that fits nowhere in the tree is a fault.

    An override with null removes an optional key that does not allow null, so that its default holds.
    """
    for override in overrides:
        if _is_null(override.value) and allowed.may_be_left_out(override.path, root, scenario_class(root)):
            root = _without(root, override.path)
        else:
            root = _with(root, override, 0, faults)
    return root


def _without(node: tree.Node, path: tuple[str, ...]) -> tree.Node:
    """A copy of a node without the key at a path below it."""
    key = path[0]
    if isinstance(node, tree.Items):
        index = tree.index_of(key, node)
        items = (_without(item, path[1:]) if i == index else item for i, item in enumerate(node.nodes))
        return tree.Items(node.position, tuple(items))
    if len(path) > 1:
        return tree.change_key(node, key, lambda below: _without(below, path[1:]))
    return tree.drop_key(node, key) if isinstance(node, tree.Mapping) else node


def _with(node: tree.Node | None, override: Override, depth: int, faults: list[Fault]) -> tree.Node:
    """A copy of `node` with the value of the override; the node is at the first `depth` keys of its path."""
    if depth == len(override.path):
        return override.value
    key = override.path[depth]
    if (
        isinstance(node, tree.Scalar)
        and isinstance(node.value, str)
        and depth == 1
        and _is_of_robot_file(override.path)
    ):
        node = tree.mapping({"from": node}, node.position)  # the model of this name, with a change
    if isinstance(node, tree.Mapping) or _is_null(node):
        holder = node if isinstance(node, tree.Mapping) else _new_mapping(override, depth)
        value = _with(holder.nodes.get(key), override, depth + 1, faults)
        at = override.position if depth + 1 == len(override.path) else holder.keys.get(key, override.position)
        return tree.set_key(holder, key, value, at)
    if isinstance(node, tree.Items):
        return _with_in_list(node, override, depth, faults)
    if isinstance(node, tree.Scalar):
        above = override.path[:depth]
        faults.append(override.position.fault(override.path, f"{'.'.join(above)} is {got(node)}, which has no keys"))
    return node if node is not None else tree.Broken(override.position)


def _new_mapping(override: Override, depth: int) -> tree.Mapping:
    """A new mapping for a key that the config lacks; in a union it has the tag of the default."""
    empty, tag = tree.Mapping(override.position), allowed.default_tag(override.path[:depth])
    if tag is None:
        return empty
    return tree.set_key(empty, tag[0], tree.Scalar(override.position, tag[1], tag[1]), override.position)


def _is_null(node: tree.Node | None) -> bool:
    """Whether there is no node, or it is null."""
    return node is None or (isinstance(node, tree.Scalar) and node.value is None)


def _with_in_list(node: tree.Items, override: Override, depth: int, faults: list[Fault]) -> tree.Items:
    """`_with` of a list; a key that is no index of an item is a fault."""
    key = override.path[depth]
    index = tree.index_of(key, node)
    if index is None:
        allowed = f"0 to {len(node.nodes) - 1}" if node.nodes else "none"
        message = f"got {key!r} as the number of a list item; allowed is {allowed}"
        faults.append(override.position.fault(override.path, message))
        return node
    items = list(node.nodes)
    items[index] = _with(items[index], override, depth + 1, faults)
    return tree.Items(node.position, tuple(items))
