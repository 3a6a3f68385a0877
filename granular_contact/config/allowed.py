"""Words for the values that the schema allows at a key.

They are derived from the JSON Schema, so they agree with the checks.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from granular_contact.config.schema.fit import FitFile
from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.config.schema.robot import RobotFile
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.schema.sweep import SweepFile
from granular_contact.config.tree import Items, Node, Path, child, plain
from granular_contact.values.strict import ALLOWED

Schema = dict[str, Any]
_FORMS: dict[Any, str] = {"text": "string", "number": "number", "list": "array", "mapping": "object"}


def definitions() -> dict[str, Schema]:
    """JSON Schemas of all classes of files, by the name of the class.

    The schema of a scenario is that of a config with resolved references to models and media.
    """
    return _definitions((Scenario, *Scenario.__subclasses__(), SweepFile, FitFile, OptimiseFile, RobotFile))


@cache
def _definitions(models: tuple[type[BaseModel], ...]) -> dict[str, Schema]:
    _, schemas = models_json_schema([(model, "validation") for model in models])
    by_name: dict[str, Schema] = schemas["$defs"]
    return by_name


def clear_cache() -> None:
    """Make the schemas again at the next use, after a class has changed."""
    _definitions.cache_clear()


def walk(location: Sequence[str | int], model: type[BaseModel] = Scenario) -> tuple[Path, Schema]:
    """Path in the file, and schema, of a `location` of pydantic.

    A location contains tags of unions between the keys, which are no part of the path.
    """
    schema, path = definitions()[model.__name__], list[str | int]()
    for step in location:
        if _takes_forms(schema):
            words = {ALLOWED: schema[ALLOWED]} if ALLOWED in schema else {}
            schema = _of_form(schema, step) | words
            continue
        if "discriminator" in schema:
            schema = _deref(schema["discriminator"]["mapping"].get(step, {}))
            continue
        path.append(step)
        schema = _below(schema, step)
    return tuple(path), schema


def _takes_forms(schema: Schema) -> bool:
    """Whether a schema is a union by the YAML form of the value (text, number, list, mapping).

    pydantic then puts this form, for example `list`, between two keys of a location.
    """
    return "oneOf" in schema and "discriminator" not in schema


def _of_form(schema: Schema, step: str | int) -> Schema:
    """The member of a union of forms for the form `step`; the first member if none fits."""
    options = [_resolved(option) for option in schema["oneOf"]]
    return next((option for option in options if option.get("type") == _FORMS.get(step)), options[0])


def _below(schema: Schema, step: str | int) -> Schema:
    """Schema of the value under a key, or of a list item with an index; empty if there is none."""
    if isinstance(step, int):
        items = schema.get("prefixItems", [])
        below = items[step] if step < len(items) else schema.get("items", {})
    else:
        below = schema.get("properties", {}).get(step, schema.get("additionalProperties"))
    return _resolved(below) if isinstance(below, dict) else {}


def _deref(schema: Schema | str) -> Schema:
    """A schema with its reference to a definition replaced by the definition."""
    if not isinstance(schema, str):
        return _deref(schema["$ref"]) | schema if "$ref" in schema else schema
    return definitions()[schema.rsplit("/", 1)[1]]


def _resolved(schema: Schema) -> Schema:
    """`schema` without reference; an alternative null becomes the key `nullable`."""
    schema = _deref(schema)
    others = [_deref(option) for option in schema.get("anyOf", []) if option.get("type") != "null"]
    return {**others[0], "nullable": True} if len(others) == 1 else schema


def tags(schema: Schema) -> tuple[str, list[str]] | None:
    """Key and allowed values of the tag of a union; None if `schema` is no union with a tag."""
    if "discriminator" not in schema:
        return None
    return schema["discriminator"]["propertyName"], list(schema["discriminator"]["mapping"])


def default_tag(path: Sequence[str]) -> tuple[str, str] | None:
    """Key and value of the tag of the default at a path of a config; None if this default is no member of a union."""
    schema = definitions()[Scenario.__name__]
    for step in path:
        if "oneOf" in schema:
            return None  # the path does not say which member of this union
        schema = _below(schema, step)
    tag, default = tags(schema), schema.get("default")
    return (tag[0], default[tag[0]]) if tag and isinstance(default, dict) else None


def may_be_left_out(path: Sequence[str], root: Node, model: type[BaseModel]) -> bool:
    """Whether the key at a path of a file is optional and does not allow null; False for an unknown key.

    root: tree of the file; its tags select the members of unions, and its names are known keys.
    """
    schema, holder_schema = definitions()[model.__name__], Schema()
    node: Node | None = root
    holder = node
    for step in path:
        holder_schema, holder = _member(schema, node), node
        schema = _below(holder_schema, int(step) if isinstance(node, Items) else step)
        node = child(holder, step) if holder is not None else None
        if node is None and step not in keys(holder_schema):
            return False
    if isinstance(holder, Items) or path[-1] in holder_schema.get("required", ()):
        return False
    options = [_deref(option).get("type") for option in schema.get("anyOf", ())]
    return bool(schema) and not schema.get("nullable") and "null" not in options


def _member(schema: Schema, node: Node | None) -> Schema:
    """The member of a union that fits a node by its form or its tag; empty if the node has no tag."""
    if _takes_forms(schema):
        schema = _of_form(schema, "list" if isinstance(node, Items) else "mapping")
    if (tag := tags(schema)) is None:
        return schema
    tag_node = None if node is None else child(node, tag[0])
    value = None if tag_node is None else plain(tag_node)
    return _deref(schema["discriminator"]["mapping"].get(value, {})) if isinstance(value, str) else {}


def keys(schema: Schema) -> list[str]:
    """Names of the keys that a mapping may have; empty if any key is allowed."""
    return list(schema.get("properties", {}))


def other_places(key: str, above: Path, holder: Schema, model: type[BaseModel] = Scenario) -> list[str]:
    """Dotted keys of at most three other places of a file where a key is known.

    These are the top of the file, the mappings at the top, and the mappings directly below the one that has the key.

    above: path of the mapping that has the unknown key; holder: schema of this mapping.
    """
    top, present = definitions()[model.__name__], ".".join(map(str, above))
    places = [key] if key in keys(top) and present else []
    sections = {name: _below(top, name) for name in keys(top)}
    places += [f"{name}.{key}" for name, section in sections.items() if key in keys(section) and name != present]
    places += [f"{present}.{name}.{key}" for name in keys(holder) if present and key in keys(_below(holder, name))]
    return places[:3]


def describe(schema: Schema) -> str:
    """The allowed values in words, for example `a number above 0, or null`."""
    return _kind(schema) + (", or null" if schema.get("nullable") else "")


def _kind(schema: Schema) -> str:
    """The allowed values in words, null aside."""
    if ALLOWED in schema:
        return str(schema[ALLOWED])
    if "enum" in schema or "const" in schema:
        choices = schema.get("enum", [schema.get("const")])
        listed = ", ".join(str(choice).lower() if isinstance(choice, bool) else str(choice) for choice in choices)
        return listed if len(choices) == 1 else f"one of {listed}"
    if _takes_forms(schema):
        return f"{_kind(_resolved(schema['oneOf'][0]))}, or a list of such"
    if tag := tags(schema):
        return f"a mapping whose {tag[0]} is one of {', '.join(tag[1])}"
    kind = schema.get("type")
    if kind in ("number", "integer"):
        return " ".join(filter(None, ("a whole number" if kind == "integer" else "a finite number", _range(schema))))
    if kind == "array":
        size, least = len(schema.get("prefixItems", ())), schema.get("minItems", 0)
        if size:
            return f"a list of {size} numbers"
        return f"a list of {'one item' if least == 1 else f'{least} items'} or more" if least else "a list"
    if kind == "object":
        return f"a mapping with the keys {', '.join(keys(schema))}" if keys(schema) else "a mapping of one name or more"
    return {"boolean": "true or false", "string": "text"}.get(str(kind), "another value")


def _range(schema: Schema) -> str:
    """The range of a number in words; empty for any number."""
    least, most, above, below = map(schema.get, ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"))
    if least is not None and most is not None:
        return f"from {least:.10g} to {most:.10g}"
    if above is not None and below is not None:
        return f"above {above:g} and below {below:g}"
    if above is not None and most is not None:
        return f"above {above:g} and at most {most:.10g}"
    if least is not None and below is not None:
        return f"from {least:.10g} to below {below:.10g}"
    return f"of at least {least:g}" if least is not None else f"above {above:g}" if above is not None else ""
