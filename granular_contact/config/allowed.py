"""What the schema allows at a key, in words; read from the JSON Schema, so that it agrees with the checks."""

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
    """JSON Schemas of all classes of files, by their names; in a scenario model and medium are resolved."""
    return _definitions((Scenario, *Scenario.__subclasses__(), SweepFile, FitFile, OptimiseFile, RobotFile))


@cache
def _definitions(models: tuple[type[BaseModel], ...]) -> dict[str, Schema]:
    _, whole = models_json_schema([(model, "validation") for model in models])
    found: dict[str, Schema] = whole["$defs"]
    return found


def forget() -> None:
    """Read the schemas anew, after a class changed."""
    _definitions.cache_clear()


def walk(location: Sequence[str | int], model: type[BaseModel] = Scenario) -> tuple[Path, Schema]:
    """Path in the file and schema of a `location` of pydantic, in which the tag of a union is between two keys."""
    schema, path = definitions()[model.__name__], list[str | int]()
    for step in location:
        if _takes_forms(schema):
            said = {ALLOWED: schema[ALLOWED]} if ALLOWED in schema else {}
            schema = _of_form(schema, step) | said
            continue
        if "discriminator" in schema:
            schema = _deref(schema["discriminator"]["mapping"].get(step, {}))
            continue
        path.append(step)
        schema = _below(schema, step)
    return tuple(path), schema


def _takes_forms(schema: Schema) -> bool:
    """Whether pydantic puts the form of a value, as `list`, between two keys."""
    return "oneOf" in schema and "discriminator" not in schema


def _of_form(schema: Schema, step: str | int) -> Schema:
    """Of a union of forms, the member for the form that pydantic names; the first one for any other."""
    options = [_resolved(option) for option in schema["oneOf"]]
    return next((one for one in options if one.get("type") == _FORMS.get(step)), options[0])


def _below(schema: Schema, step: str | int) -> Schema:
    if isinstance(step, int):
        items = schema.get("prefixItems", [])
        below = items[step] if step < len(items) else schema.get("items", {})
    else:
        below = schema.get("properties", {}).get(step, schema.get("additionalProperties"))
    return _resolved(below) if isinstance(below, dict) else {}


def _deref(schema: Schema | str) -> Schema:
    if not isinstance(schema, str):
        return _deref(schema["$ref"]) | schema if "$ref" in schema else schema
    return definitions()[schema.rsplit("/", 1)[1]]


def _resolved(schema: Schema) -> Schema:
    """`schema` without reference, and without its null alternative, which becomes the key `nullable`."""
    schema = _deref(schema)
    others = [_deref(option) for option in schema.get("anyOf", []) if option.get("type") != "null"]
    return {**others[0], "nullable": True} if len(others) == 1 else schema


def tags(schema: Schema) -> tuple[str, list[str]] | None:
    """Key and allowed values of the tag of a union; None if `schema` is none."""
    if "discriminator" not in schema:
        return None
    return schema["discriminator"]["propertyName"], list(schema["discriminator"]["mapping"])


def default_tag(path: Sequence[str]) -> tuple[str, str] | None:
    """Key and value of the tag of the union's member that stands at a path of the file by default; None without one."""
    schema = definitions()[Scenario.__name__]
    for step in path:
        if "oneOf" in schema:
            return None  # which of several it is, the path does not say
        schema = _below(schema, step)
    tag, default = tags(schema), schema.get("default")
    return (tag[0], default[tag[0]]) if tag and isinstance(default, dict) else None


def may_go(path: Sequence[str], root: Node, model: type[BaseModel]) -> bool:
    """Whether the key at a path of a file may be left out, and takes no null; not of one that is not known.

    root: tree of the file, which says of what kinds its parts are and what names there are.
    """
    schema, holder = definitions()[model.__name__], Schema()
    node: Node | None = root
    above = node
    for step in path:
        holder, above = _chosen(schema, node), node
        schema = _below(holder, int(step) if isinstance(node, Items) else step)
        node = child(above, step) if above is not None else None
        if node is None and step not in keys(holder):
            return False
    if isinstance(above, Items) or path[-1] in holder.get("required", ()):
        return False
    options = [_deref(option).get("type") for option in schema.get("anyOf", ())]
    return bool(schema) and not schema.get("nullable") and "null" not in options


def _chosen(schema: Schema, node: Node | None) -> Schema:
    """Of a schema with alternatives the one that a node says it is; none where it says nothing."""
    if _takes_forms(schema):
        schema = _of_form(schema, "list" if isinstance(node, Items) else "mapping")
    if (tag := tags(schema)) is None:
        return schema
    said = None if node is None else child(node, tag[0])
    kind = None if said is None else plain(said)
    return _deref(schema["discriminator"]["mapping"].get(kind, {})) if isinstance(kind, str) else {}


def keys(schema: Schema) -> list[str]:
    """Names of the keys that a mapping may have; empty if it takes any."""
    return list(schema.get("properties", {}))


def places(key: str, above: Path, holder: Schema, model: type[BaseModel] = Scenario) -> list[str]:
    """Where else a key may stand that is not known below the path `above`: at the top of the file, one key further
    down from there, or one further down from where it is; dotted, and none if it is known nowhere.
    """
    top, here = definitions()[model.__name__], ".".join(map(str, above))
    found = [key] if key in keys(top) and here else []
    sections = {name: _below(top, name) for name in keys(top)}
    found += [f"{name}.{key}" for name, part in sections.items() if key in keys(part) and name != here]
    found += [f"{here}.{name}.{key}" for name in keys(holder) if here and key in keys(_below(holder, name))]
    return found[:3]


def describe(schema: Schema) -> str:
    """The allowed values in words, as `a number above 0, or null`."""
    return _kind(schema) + (", or null" if schema.get("nullable") else "")


def _kind(schema: Schema) -> str:
    if ALLOWED in schema:
        return str(schema[ALLOWED])
    if "enum" in schema or "const" in schema:
        choices = schema.get("enum", [schema.get("const")])
        words = ", ".join(str(one).lower() if isinstance(one, bool) else str(one) for one in choices)
        return words if len(choices) == 1 else f"one of {words}"
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
    least, most, above, below = map(schema.get, ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum"))
    if least is not None and most is not None:
        return f"from {least:.10g} to {most:.10g}"
    if above is not None and below is not None:
        return f"above {above:g} and below {below:g}"
    if least is not None and below is not None:
        return f"from {least:.10g} to below {below:.10g}"
    return f"of at least {least:g}" if least is not None else f"above {above:g}" if above is not None else ""
