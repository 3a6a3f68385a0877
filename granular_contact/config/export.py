"""Export a scenario as plain data, and the JSON Schemas of configs, sweeps, optimisations and fits for editors."""

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
    """All values of a scenario, including defaults, in plain YAML types.

    Parameters
    ----------
    scenario : Scenario
        The scenario.

    Returns
    -------
    dict
        Values by the keys of a config, in the units of these keys. Written by `yaml.safe_dump(..., sort_keys=False)`
        and loaded again, they give an equal scenario.
    """
    return scenario.model_dump(mode="json", by_alias=True)


def value_at(plain: Any, key: Sequence[str], missing: Any = None) -> Any:
    """Value at a path of keys and list indices in plain data; `missing` if there is none."""
    for part in key:
        if isinstance(plain, list) and part.isdecimal() and int(part) < len(plain):
            plain = plain[int(part)]
        elif isinstance(plain, dict) and part in plain:
            plain = plain[part]
        else:
            return missing
    return plain


def _single(whole: dict[str, Any]) -> dict[str, Any]:
    """Schema of a single medium, from that of one or more media."""
    union = next(option for option in whole["anyOf"] if "oneOf" in option)
    single: dict[str, Any] = union["oneOf"][0]
    return single


def _shorten_signals(node: Any) -> None:
    """Allow a number and the name of a shared signal wherever a schema allows a signal; changes the schema in place."""
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
    """JSON Schema of a class with the texts under the fields of all classes as descriptions.

    The texts are read from the source files, which takes long. So checks use the schema without them.
    """
    schema = model.model_json_schema()
    classes: dict[str, type[Strict]] = {}
    waiting = [Strict]
    while waiting:
        waiting += (strict_class := waiting.pop()).__subclasses__()
        classes[strict_class.__name__] = strict_class
    for name, part in {model.__name__: schema, **schema["$defs"]}.items():
        if "description" in part:
            part["description"] = part["description"].partition(_PARAMETERS)[0]
        for owner in reversed(classes[name].__mro__):
            for field, text in _texts(owner) if issubclass(owner, Strict) else ():
                part["properties"][classes[name].model_fields[field].alias or field]["description"] = text
    return schema


@cache
def _texts(owner: type[Strict]) -> tuple[tuple[str, str], ...]:
    """Names of the fields of a class with their texts, from its docstring (Parameters) and from below the fields.

    Empty for a class without a source file.
    """
    definition = _classes(owner.__module__).get(owner.__qualname__)
    if definition is None:
        return ()
    _, _, parameters = (ast.get_docstring(definition) or "").partition(_PARAMETERS)
    entries = re.findall(r"^(\S.*) : .*\n((?:    .*\n?)+)", parameters, re.M)
    documented = {name: " ".join(text.split()) for names, text in entries for name in names.split(", ")}
    fields = owner.__annotations__.keys() & owner.model_fields
    texts = [(name, text) for name, text in documented.items() if name in fields]
    for pair in pairwise(definition.body):
        match pair:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(text))):
                texts.append((name, inspect.cleandoc(text)))
    return tuple(texts)


@cache
def _classes(module: str) -> dict[str, ast.ClassDef]:
    """Syntax trees of the classes of a module by name; empty without a source file. Each module is parsed once."""
    file = getattr(sys.modules.get(module), "__file__", None)
    if file is None or not Path(file).is_file():
        return {}
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    return {statement.name: statement for statement in tree.body if isinstance(statement, ast.ClassDef)}


def json_schema(kind: str = "run") -> dict[str, Any]:
    """JSON Schema of a kind of file, with the description of each key.

    Where a file may name a shipped model or medium, the schema lists their names.

    Parameters
    ----------
    kind : str, optional
        A key of `KINDS`: `run`, `sweep`, `fit` or `optimise`; or `model` or `medium`, for a file of this part alone.

    Returns
    -------
    dict
        The schema as plain data, ready for `json.dumps`.

    Raises
    ------
    KeyError
        There is no such kind.
    """
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
    """Add the schema of a config and the short form of ranges to the schema of a sweep or an optimisation."""
    run = _run_schema()
    schema["$defs"] |= run.pop("$defs")
    schema["$defs"]["Scenario"] = run
    config = schema["properties"]["config"]
    config_forms = [{"type": "string"}, {"$ref": "#/$defs/Scenario"}]
    schema["properties"]["config"] = {"anyOf": config_forms, "description": config["description"]}
    ends = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
    ranges["additionalProperties"] = {"anyOf": [ends, ranges["additionalProperties"]]}


def _part_schema(key: str) -> dict[str, Any]:
    """JSON Schema of the file of a model or a medium, which may begin from another one (`from`)."""
    run = _run_schema()
    _, patch, whole, *others = run["properties"][key]["anyOf"]
    if key == "medium":
        whole, others = _single(whole), []
    forms, needed = [whole, patch, *others], dict[str, Any]()
    queue = _references(forms)
    while queue:
        if (name := queue.pop()) not in needed:
            needed[name] = run["$defs"][name]
            queue += _references(needed[name])
    return {"$defs": dict(sorted(needed.items())), "title": key.capitalize(), "anyOf": forms}


def _references(node: Any) -> list[str]:
    """Names of the definitions to which a part of a schema refers."""
    if isinstance(node, list):
        return [name for item in node for name in _references(item)]
    if not isinstance(node, dict):
        return []
    direct = [node["$ref"].rpartition("/")[2]] if isinstance(node.get("$ref"), str) else []
    return direct + [name for item in node.values() for name in _references(item)]


def _names(noun: str, known: Sequence[str], others: bool) -> dict[str, Any]:
    """Schema of a name or a path. Editors offer the known names; others: whether other names are allowed too."""
    path = {"type": "string"} if others else {"type": "string", "pattern": r"\.ya?ml$"}
    return {"anyOf": [{"enum": [*known]}, path], "description": f"Name of a {noun}, or a path ending in .yaml."}


def _add_space(schema: dict[str, Any]) -> None:
    """Allow the model (also from a robot file), bed and initial state of a run in space in the schema of a run."""
    from granular_contact.config.schema.space import SpatialScenario

    spatial_schema = _described(SpatialScenario)
    schema["$defs"] = spatial_schema.pop("$defs") | schema["$defs"]
    for key in ("model", "bed", "initial"):
        planar, spatial = schema["properties"][key], spatial_schema["properties"][key]
        forms = planar["anyOf"] if "anyOf" in planar else [{"$ref": planar["$ref"]}]
        more = [form for form in spatial.get("anyOf", [{"$ref": spatial.get("$ref")}]) if form not in forms]
        schema["properties"][key] = {"anyOf": [*forms, *more], "description": planar["description"]}
    file = {"type": "string", "description": "Path of a robot file (URDF). Other keys: see models/README.md."}
    schema["properties"]["model"]["anyOf"].append(
        {"type": "object", "required": ["urdf"], "properties": {"urdf": file}}
    )


def _run_schema() -> dict[str, Any]:
    """JSON Schema of a config. Model and medium may be names, paths, or mappings with `from`; the method a word."""
    schema = _described(Scenario)
    models = sorted(path.stem for path in (examples.home() / "models").glob("*.yaml"))
    for key, noun, known in (("model", "model", models), ("medium", "medium preset", medium_names())):
        whole = schema["properties"][key]
        name = _names(noun, known, others=key == "model")
        patch = {"type": "object", "required": [FROM], "properties": {FROM: name}}
        forms = [name, patch, whole]
        if key == "medium":
            forms.append({"type": "array", "minItems": 1, "items": {"anyOf": [name, patch, _single(whole)]}})
        schema["properties"][key] = {"anyOf": forms, "description": whole["description"]}
    layer = schema["$defs"]["BedLayer"]["properties"]
    layer["medium"] = {"anyOf": [name, patch, layer["medium"]], "description": layer["medium"]["description"]}
    _add_space(schema)
    _shorten_signals(schema)
    method = schema["properties"]["method"]
    schema["properties"]["method"] = {"anyOf": [{"enum": list(WORDS)}, method], "description": method["description"]}
    return schema
