"""Errors of pydantic as faults: sentences with file, line and key."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from difflib import get_close_matches
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from granular_contact.config import allowed
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.tree import Broken, Items, Node, Path, Scalar, child, find, key_position, plain
from granular_contact.config.tree import Mapping as MappingNode
from granular_contact.errors import ConfigError, Fault, short
from granular_contact.values.strict import FAULTS, MEANT, did_you_mean

M = TypeVar("M", bound=BaseModel)


def validated(model: type[M], tree: Node, faults: list[Fault]) -> M | None:
    """The tree as an object of the class `model`; None, with faults, if it is not valid."""
    try:
        return model.model_validate(plain(tree))
    except ValidationError as error:
        faults += faults_of(error.errors(include_url=False, include_input=False), tree, model)
    return None


def faults_of(errors: Iterable[Mapping[str, Any]], tree: Node, model: type[BaseModel] = Scenario) -> list[Fault]:
    """Faults for the `errors()` of a pydantic ValidationError of `tree` as a `model`.

    No fault is made of a `Broken` node, whose fault is known. Nor of a list that is too short only because some of its
    items are faulty, since pydantic counts valid items alone.
    """
    errors = list(errors)
    faults = [fault for error in errors if not _follows(error, errors) for fault in _faults(error, tree, model)]
    return [fault for fault in faults if fault is not None]


def _follows(error: Mapping[str, Any], errors: Sequence[Mapping[str, Any]]) -> bool:
    """Whether an error says that a list is too short, while other errors are about items of this list."""
    size = len(error["loc"])
    return error["type"] == "too_short" and any(
        len(other["loc"]) > size and other["loc"][:size] == error["loc"] for other in errors
    )


def got(node: Node) -> str:
    """The value of `node` with its YAML type, for messages; a long text is cut."""
    if isinstance(node, Scalar):
        text = short(node.text)
        if isinstance(node.value, str):
            return f"the text {text!r}"
        return "null" if node.value is None else f"the {_scalar_kind(node.value)} {text}"
    if isinstance(node, Items):
        return f"a list of {len(node.nodes)} item{'s' * (len(node.nodes) != 1)}"
    return "a mapping" if isinstance(node, MappingNode) and node.nodes else "an empty mapping"


def kind_of(node: Node) -> str:
    """The YAML type of the content of a file, for messages.

    The content itself is not shown: it may be any file, also one with secrets.
    """
    if isinstance(node, Scalar):
        value = node.value
        return "nothing" if value is None else "a text" if isinstance(value, str) else f"a {_scalar_kind(value)}"
    if isinstance(node, MappingNode) and node.nodes:
        return f"a mapping of {len(node.nodes)} key{'s' * (len(node.nodes) != 1)}, none of which is known here"
    return got(node)


def is_foreign(node: Node, known: Sequence[str]) -> bool:
    """Whether a file is of another kind: it is no mapping, or none of its keys resembles a known key."""
    if not isinstance(node, MappingNode):
        return True
    return bool(node.nodes) and not any(get_close_matches(key, known, 1, 0.75) for key in node.nodes)


def root_of_kind(
    root: Node, model: type[BaseModel], otherwise: str, faults: list[Fault], also: Sequence[str] = ()
) -> MappingNode:
    """The tree of a file, which must be a mapping with at least one key of the class `model`, or of `also`.

    otherwise: words for any other file in the message, as `not a sweep`.

    Raises
    ------
    ConfigError
        The file is of another kind, or can't be read; with the `faults` found so far.
    """
    keys = [field.alias or key for key, field in model.model_fields.items()]
    if isinstance(root, MappingNode) and not is_foreign(root, [*keys, *also]):
        return root
    if not isinstance(root, Broken):
        message = f"is {otherwise}: it holds {kind_of(root)}; allowed is a mapping with the keys {', '.join(keys)}"
        faults.append(root.position.fault((), message))
    raise ConfigError(sorted(faults, key=by_place))


def by_place(fault: Fault) -> tuple[str, int]:
    """Sorting key of faults: file and line."""
    return fault.file, fault.line or 0


def _scalar_kind(value: bool | int | float) -> str:
    """YAML type of a scalar that is neither text nor null."""
    return "boolean" if isinstance(value, bool) else "number"


def unknown(word: str, known: Sequence[str]) -> str:
    """Hint for an unknown `word`: the most similar known word, else all known words."""
    return did_you_mean(word, known) or (f"allowed are {', '.join(known)}" if known else "none is allowed here")


def _faults(error: Mapping[str, Any], tree: Node, model: type[BaseModel]) -> list[Fault | None]:
    """Faults of one error of pydantic; None for a fault that is already known."""
    path, schema = allowed.walk(error["loc"], model)
    if error["type"] == FAULTS:
        return [_at(tree, (*path, *below), message) for below, message in error["ctx"][FAULTS]]
    if error["type"] == "extra_forbidden":
        above, holder = allowed.walk(error["loc"][:-1], model)
        key, keys = str(path[-1]), allowed.keys(holder)
        message = holder.get(MEANT, {}).get(key, "")
        if not message and (places := allowed.other_places(key, above, holder, model)):
            message = f"stands in the wrong place; it belongs at {' or '.join(places)}"
        if not message:
            content = _places_of_content(find(tree, path)[0], above, holder, model)
            message = f"unknown key; {did_you_mean(key, keys) or content or unknown(key, keys)}"
        return [_at_key(tree, path, message)]
    if error["type"] == "missing":
        _, holder = allowed.walk(error["loc"][:-1], model)
        return [_missing(tree, path, schema, holder)]
    node, _ = find(tree, path)
    tag = allowed.tags(schema)
    if tag and isinstance(node, MappingNode):
        return [_tag_fault(tree, path, *tag)]
    return [_at(tree, path, f"got {got(node)}; allowed is {allowed.describe(schema)}{_hint(node, schema)}")]


def _places_of_content(node: Node, above: Path, holder: allowed.Schema, model: type[BaseModel]) -> str:
    """Hint where the keys below an unknown key belong; empty if none of them is known."""
    keys = node.nodes if isinstance(node, MappingNode) else ()
    places_by_key = {str(key): allowed.other_places(str(key), above, holder, model) for key in keys}
    hints = [f"{key} belongs at {' or '.join(places)}" for key, places in places_by_key.items() if places]
    return ", ".join(hints)


def _missing(tree: Node, path: Path, schema: allowed.Schema, holder_schema: allowed.Schema) -> Fault | None:
    """Fault of a missing key or list item; schema: its schema; holder_schema: that of the mapping or list."""
    holder, _ = find(tree, path[:-1])
    if isinstance(holder, Items):
        size = len(holder_schema.get("prefixItems", ())) or 2
        return _at(tree, path[:-1], f"got {got(holder)}; allowed is a list of {size} numbers")
    return _at_key(tree, path, f"is missing; allowed is {allowed.describe(schema)}")


def _tag_fault(tree: Node, path: Path, key: str, choices: list[str]) -> Fault | None:
    """Fault of the key that names the member of a union: it is missing, or its value is none of `choices`."""
    node = child(find(tree, path)[0], key)
    path = (*path, key)
    if node is None:
        return _at_key(tree, path, f"is missing; allowed are {', '.join(choices)}")
    if key == "law" and isinstance(node, Scalar) and ":" in node.text:
        hint = "a config never loads code; in Python load(FILE, laws=[YourLaw]) makes your law known by its tag"
        return _at(tree, path, f"got {got(node)}; {hint}")
    hint = unknown(node.text if isinstance(node, Scalar) else "", choices)
    listed = "" if hint.startswith("allowed") else f" (of {', '.join(choices)})"
    return _at(tree, path, f"got {got(node)}; {hint}{listed}")


def _hint(node: Node, schema: allowed.Schema) -> str:
    """Hint how to write numbers, for a text that looks like a number where one is allowed; else empty."""
    if schema.get("type") in ("number", "integer") and isinstance(node, Scalar) and isinstance(node.value, str):
        is_like_number = node.text[:1].isdigit() or node.text[:1] in ("+", "-", ".")
        return "; write numbers as 12, 0.5 or 1e-3, without quotes" if is_like_number and node.text.strip() else ""
    return ""


def _at(tree: Node, path: Path, message: str) -> Fault | None:
    """A fault of the value at `path`; None if the value is `Broken`."""
    node, missing = find(tree, path)
    if missing:
        return _at_key(tree, path, message)
    return None if isinstance(node, Broken) else node.position.fault(path, message)


def _at_key(tree: Node, path: Path, message: str) -> Fault | None:
    """A fault of the last key of `path`, which is there or is missing; None if its mapping is `Broken`."""
    node, _ = find(tree, path)
    return None if isinstance(node, Broken) else key_position(tree, path).fault(path, message)
