"""A scenario as plain data, and the schemas of configs, and of files of sweeps, searches and fits, for editors."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from granular_contact import examples
from granular_contact.config.references import FROM, medium_names
from granular_contact.config.schema.fit import FitFile
from granular_contact.config.schema.method import WORDS
from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.schema.signals import SIGNALS
from granular_contact.config.schema.sweep import SweepFile
from granular_contact.values.strict import Strict

KINDS: dict[str, type[BaseModel]] = {"run": Scenario, "sweep": SweepFile, "fit": FitFile, "optimise": OptimiseFile}
_PARAMETERS = "\n\nParameters\n----------\n"


def scenario_to_dict(scenario: Scenario) -> dict[str, Any]:
    """Every value of the scenario, defaults too, in plain YAML types.

    Written with `yaml.safe_dump(..., sort_keys=False)` and loaded again, it gives an equal scenario.
    """
    return scenario.model_dump(mode="json", by_alias=True)


def value_at(plain: Any, key: Sequence[str], missing: Any = None) -> Any:
    """Value under a key of a scenario as plain data, by its path of names and numbers."""
    for part in key:
        if isinstance(plain, list) and part.isdecimal() and int(part) < len(plain):
            plain = plain[int(part)]
        elif isinstance(plain, dict) and part in plain:
            plain = plain[part]
        else:
            return missing
    return plain


def _single(whole: dict[str, Any]) -> dict[str, Any]:
    """Of the schema of one or more media, that of one."""
    several = next(option for option in whole["anyOf"] if "oneOf" in option)
    single: dict[str, Any] = several["oneOf"][0]
    return single


def _shorten_signals(node: Any) -> None:
    """Wherever a signal is allowed, allow a number and the name of a shared one, too; changes the schema."""
    if isinstance(node, list):
        for item in node:
            _shorten_signals(item)
        return
    if not isinstance(node, dict):
        return
    for item in node.values():
        _shorten_signals(item)
    if set(node.get("discriminator", {}).get("mapping", {})) == set(SIGNALS):
        whole = {key: node.pop(key) for key in ("discriminator", "oneOf")}
        node["anyOf"] = [{"type": "number"}, {"type": "string"}, whole]


def _described(model: type[BaseModel]) -> dict[str, Any]:
    """Schema of a model with the texts under the fields of all classes; reading sources takes long, so only here."""
    schema = model.model_json_schema()
    classes: dict[str, type[Strict]] = {}
    more = [Strict]
    while more:
        more += (one := more.pop()).__subclasses__()
        classes[one.__name__] = one
    for name, part in {model.__name__: schema, **schema["$defs"]}.items():
        if "description" in part:
            part["description"] = part["description"].partition(_PARAMETERS)[0]
        for owner in reversed(classes[name].__mro__):
            for field, text in _texts(owner) if issubclass(owner, Strict) else ():
                part["properties"][classes[name].model_fields[field].alias or field]["description"] = text
    return schema


@cache
def _texts(owner: type[Strict]) -> tuple[tuple[str, str], ...]:
    """Fields of a class with the texts under them, or among its Parameters; none of a class without a source."""
    tree = _classes(owner.__module__).get(owner.__qualname__)
    if tree is None:
        return ()
    _, _, parameters = (ast.get_docstring(tree) or "").partition(_PARAMETERS)
    listed = re.findall(r"^(\S.*) : .*\n((?:    .*\n?)+)", parameters, re.M)
    given = {name: " ".join(text.split()) for names, text in listed for name in names.split(", ")}
    found = [(name, text) for name, text in given.items() if name in owner.__annotations__.keys() & owner.model_fields]
    for pair in pairwise(tree.body):
        match pair:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                found.append((name, inspect.cleandoc(text)))
    return tuple(found)


@cache
def _classes(module: str) -> dict[str, ast.ClassDef]:
    """Classes of a module as they are written: it is read once for all of them."""
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None or not Path(file).is_file():
        return {}
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    return {one.name: one for one in tree.body if isinstance(one, ast.ClassDef)}


def json_schema(kind: str = "run") -> dict[str, Any]:
    """JSON Schema of a file: one of `KINDS`, a `model` or a `medium`; names of what is shipped are among the values."""
    if kind == "run":
        return _run_schema()
    if kind in ("model", "medium"):
        return _part_schema(kind)
    schema = _described(KINDS[kind])
    if kind == "sweep":
        _complete(schema, schema["$defs"]["Sample"]["properties"]["ranges"])
        schema["oneOf"] = [{"required": [key]} for key in ("cases", "vary", "sample")]
    if kind == "optimise":
        _complete(schema, schema["properties"]["parameters"])
    return schema


def _complete(schema: dict[str, Any], ranges: dict[str, Any]) -> None:
    """Add to the schema of a file of many runs its config, and to its ranges their short form."""
    run = _run_schema()
    schema["$defs"] |= run.pop("$defs")
    schema["$defs"]["Scenario"] = run
    schema["properties"]["config"] = {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/Scenario"}]}
    ends = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
    ranges["additionalProperties"] = {"anyOf": [ends, ranges["additionalProperties"]]}


def _part_schema(key: str) -> dict[str, Any]:
    """Of the file of a model or a medium, which may begin from another one."""
    run = _run_schema()
    _, patch, whole, *more = run["properties"][key]["anyOf"]
    if key == "medium":
        whole, more = _single(whole), []
    forms, kept = [whole, patch, *more], dict[str, Any]()
    queue = _references(forms)
    while queue:
        if (name := queue.pop()) not in kept:
            kept[name] = run["$defs"][name]
            queue += _references(kept[name])
    return {"$defs": dict(sorted(kept.items())), "title": key.capitalize(), "anyOf": forms}


def _references(node: Any) -> list[str]:
    """Names of the definitions that a piece of a schema refers to."""
    if isinstance(node, list):
        return [name for item in node for name in _references(item)]
    if not isinstance(node, dict):
        return []
    own = [node["$ref"].rpartition("/")[2]] if isinstance(node.get("$ref"), str) else []
    return own + [name for item in node.values() for name in _references(item)]


def _names(noun: str, known: Sequence[str], others: bool) -> dict[str, Any]:
    """Of a name or a path: editors offer the known names; others: whether there may be more of them."""
    path = {"type": "string"} if others else {"type": "string", "pattern": r"\.ya?ml$"}
    return {"anyOf": [{"enum": [*known]}, path], "description": f"Name of a {noun}, or a path ending in .yaml."}


def _add_space(schema: dict[str, Any]) -> None:
    """Allow in a run what one in space may say: its model, from a robot file too, its bed and its start."""
    from granular_contact.config.schema.space import SpatialScenario

    spatial = _described(SpatialScenario)
    schema["$defs"] = spatial.pop("$defs") | schema["$defs"]
    for key in ("model", "bed", "initial"):
        planar, other = schema["properties"][key], spatial["properties"][key]
        forms = planar["anyOf"] if "anyOf" in planar else [{"$ref": planar["$ref"]}]
        more = [one for one in other.get("anyOf", [{"$ref": other.get("$ref")}]) if one not in forms]
        schema["properties"][key] = {"anyOf": [*forms, *more], "description": planar.get("description", "")}
    file = {"type": "string", "description": "Robot file; what else may stand here: models/README.md."}
    schema["properties"]["model"]["anyOf"].append(
        {"type": "object", "required": ["urdf"], "properties": {"urdf": file}}
    )


def _run_schema() -> dict[str, Any]:
    """Of a config, in which model and medium may be names, paths, or mappings with `from`; the method may be a word."""
    schema = _described(Scenario)
    models = sorted(path.stem for path in (examples.home() / "models").glob("*.yaml"))
    for key, noun, known in (("model", "model", models), ("medium", "medium preset", medium_names())):
        whole = schema["properties"][key]
        name = _names(noun, known, others=key == "model")
        patch = {"type": "object", "required": [FROM], "properties": {FROM: name}}
        forms = [name, patch, whole]
        if key == "medium":
            forms.append({"type": "array", "minItems": 1, "items": {"anyOf": [name, patch, _single(whole)]}})
        schema["properties"][key] = {"anyOf": forms}
    layer = schema["$defs"]["BedLayer"]["properties"]
    layer["medium"] = {"anyOf": [name, patch, layer["medium"]]}
    _add_space(schema)
    _shorten_signals(schema)
    words = {"enum": list(WORDS)}
    schema["properties"]["method"] = {"anyOf": [words, schema["properties"]["method"]]}
    return schema
