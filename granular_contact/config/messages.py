"""pydantic's errors -> faults at a line, in sentences."""

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
from granular_contact.values.strict import FAULTS, did_you_mean

M = TypeVar("M", bound=BaseModel)


def validated(model: type[M], tree: Node, faults: list[Fault]) -> M | None:
    """The tree as a model; None, with faults, if it is none."""
    try:
        return model.model_validate(plain(tree))
    except ValidationError as error:
        faults += faults_of(error.errors(include_url=False, include_input=False), tree, model)
    return None


def faults_of(errors: Iterable[Mapping[str, Any]], tree: Node, model: type[BaseModel] = Scenario) -> list[Fault]:
    """Faults for the `errors()` of a pydantic ValidationError about `tree`, which was to be a `model`.

    There is none about a `Broken` node, whose fault is known, nor about a list that is too short only because items in
    it are faulty: pydantic counts only valid ones.
    """
    errors = list(errors)
    faults = [fault for error in errors if not _is_short_of(error, errors) for fault in _faults(error, tree, model)]
    return [fault for fault in faults if fault is not None]


def _is_short_of(error: Mapping[str, Any], errors: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a list lacks no more than the items in it that have errors of their own."""
    size = len(error["loc"])
    return error["type"] == "too_short" and any(
        len(other["loc"]) > size and other["loc"][:size] == error["loc"] for other in errors
    )


def got(node: Node) -> str:
    """The value of `node` with its YAML type, cut to a readable length."""
    if isinstance(node, Scalar):
        text = short(node.text)
        if isinstance(node.value, str):
            return f"the text {text!r}"
        return "null" if node.value is None else f"the {_scalar_kind(node.value)} {text}"
    if isinstance(node, Items):
        return f"a list of {len(node.nodes)} item{'s' * (len(node.nodes) != 1)}"
    return "a mapping" if isinstance(node, MappingNode) and node.nodes else "an empty mapping"


def kind_of(node: Node) -> str:
    """The YAML type of what a whole file holds. Its content is not shown: it may be any file, with secrets in it."""
    if isinstance(node, Scalar):
        value = node.value
        return "nothing" if value is None else "a text" if isinstance(value, str) else f"a {_scalar_kind(value)}"
    if isinstance(node, MappingNode) and node.nodes:
        return f"a mapping of {len(node.nodes)} key{'s' * (len(node.nodes) != 1)}, none of which is known here"
    return got(node)


def is_foreign(node: Node, known: Sequence[str]) -> bool:
    """Whether a file is of another kind: not a mapping, or one without a known or nearly known key."""
    if not isinstance(node, MappingNode):
        return True
    return bool(node.nodes) and not any(get_close_matches(key, known, 1, 0.75) for key in node.nodes)


def of_file(
    root: Node, model: type[BaseModel], what: str, faults: list[Fault], also: Sequence[str] = ()
) -> MappingNode:
    """The tree of a file that is to be a `model`: a mapping with one of its keys, or of those that it may have besides.

    what: what any other file is, as `not a sweep`.

    Raises
    ------
    ConfigError
        It is such a file, or can't be read; with the `faults` found so far.
    """
    keys = [one.alias or key for key, one in model.model_fields.items()]
    if isinstance(root, MappingNode) and not is_foreign(root, [*keys, *also]):
        return root
    if not isinstance(root, Broken):
        words = f"is {what}: it holds {kind_of(root)}; allowed is a mapping with the keys {', '.join(keys)}"
        faults.append(root.position.fault((), words))
    raise ConfigError(sorted(faults, key=by_place))


def by_place(fault: Fault) -> tuple[str, int]:
    """Key by which faults are sorted."""
    return fault.file, fault.line or 0


def _scalar_kind(value: bool | int | float) -> str:
    return "boolean" if isinstance(value, bool) else "number"


def unknown(word: str, known: Sequence[str]) -> str:
    """Which of `known` the unknown `word` may have meant, or all of them."""
    return did_you_mean(word, known) or (f"allowed are {', '.join(known)}" if known else "none is allowed here")


def _faults(error: Mapping[str, Any], tree: Node, model: type[BaseModel]) -> list[Fault | None]:
    path, schema = allowed.walk(error["loc"], model)
    if error["type"] == FAULTS:
        return [_at(tree, (*path, *below), message) for below, message in error["ctx"][FAULTS]]
    if error["type"] == "extra_forbidden":
        above, holder = allowed.walk(error["loc"][:-1], model)
        places = allowed.places(str(path[-1]), above, holder, model)
        words = f"stands in the wrong place; it belongs at {' or '.join(places)}" if places else ""
        if not words:
            key, keys = str(path[-1]), allowed.keys(holder)
            content = _places_of_content(find(tree, path)[0], above, holder, model)
            words = f"unknown key; {did_you_mean(key, keys) or content or unknown(key, keys)}"
        return [_at_key(tree, path, words)]
    if error["type"] == "missing":
        _, holder = allowed.walk(error["loc"][:-1], model)
        return [_missing(tree, path, schema, holder)]
    node, _ = find(tree, path)
    tag = allowed.tags(schema)
    if tag and isinstance(node, MappingNode):
        return [_tag_fault(tree, path, *tag)]
    return [_at(tree, path, f"got {got(node)}; allowed is {allowed.describe(schema)}{_hint(node, schema)}")]


def _places_of_content(node: Node, above: Path, holder: allowed.Schema, model: type[BaseModel]) -> str:
    """Where the keys below an unknown key belong; empty if they are known nowhere."""
    keys = node.nodes if isinstance(node, MappingNode) else ()
    found = {str(key): allowed.places(str(key), above, holder, model) for key in keys}
    hints = [f"{key} belongs at {' or '.join(places)}" for key, places in found.items() if places]
    return ", ".join(hints)


def _missing(tree: Node, path: Path, schema: allowed.Schema, around: allowed.Schema) -> Fault | None:
    """A fault of what is not there, with its schema and that of what it would stand in."""
    holder, _ = find(tree, path[:-1])
    if isinstance(holder, Items):
        size = len(around.get("prefixItems", ())) or 2
        return _at(tree, path[:-1], f"got {got(holder)}; allowed is a list of {size} numbers")
    return _at_key(tree, path, f"is missing; allowed is {allowed.describe(schema)}")


def _tag_fault(tree: Node, path: Path, key: str, choices: list[str]) -> Fault | None:
    node = child(find(tree, path)[0], key)
    path = (*path, key)
    if node is None:
        return _at_key(tree, path, f"is missing; allowed are {', '.join(choices)}")
    if key == "law" and isinstance(node, Scalar) and ":" in node.text:
        words = "a config never loads code; in Python load(FILE, laws=[YourLaw]) makes your law known by its tag"
        return _at(tree, path, f"got {got(node)}; {words}")
    hint = unknown(node.text if isinstance(node, Scalar) else "", choices)
    listed = "" if hint.startswith("allowed") else f" (of {', '.join(choices)})"
    return _at(tree, path, f"got {got(node)}; {hint}{listed}")


def _hint(node: Node, schema: allowed.Schema) -> str:
    """How to write numbers, for a text that looks like one."""
    if schema.get("type") in ("number", "integer") and isinstance(node, Scalar) and isinstance(node.value, str):
        looks_like_one = node.text[:1].isdigit() or node.text[:1] in ("+", "-", ".")
        return "; write numbers as 12, 0.5 or 1e-3, without quotes" if looks_like_one and node.text.strip() else ""
    return ""


def _at(tree: Node, path: Path, message: str) -> Fault | None:
    """A fault of the value at `path`."""
    node, missing = find(tree, path)
    if missing:
        return _at_key(tree, path, message)
    return None if isinstance(node, Broken) else node.position.fault(path, message)


def _at_key(tree: Node, path: Path, message: str) -> Fault | None:
    """A fault of the last key of `path`: that it stands there, or that it does not."""
    node, _ = find(tree, path)
    return None if isinstance(node, Broken) else key_position(tree, path).fault(path, message)
