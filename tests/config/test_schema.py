"""The JSON schema for editors, and the classes of the schema that Python callers use."""

import json
from pathlib import Path
from typing import Any

import pydantic
import pytest
import yaml

from granular_contact import cli
from granular_contact.config import is_fit, is_run, is_sweep, json_schema, medium_names, schema
from granular_contact.config.schema import fit
from granular_contact.config.schema.drives import DRIVES
from granular_contact.config.schema.joints import CLOSURES, JOINTS, SYNONYMS
from granular_contact.config.schema.mechanism import BODIES
from granular_contact.config.schema.scenario import FRICTIONS
from granular_contact.config.schema.shapes import SHAPES
from granular_contact.config.schema.signals import SIGNALS
from granular_contact.config.tree import plain
from granular_contact.config.yaml_source import read_file
from granular_contact.laws.catalogue import LAWS


@pytest.mark.slow
def test_json_schema_takes_names_and_mappings():
    model, medium = (json_schema()["properties"][key]["anyOf"] for key in ("model", "medium"))
    assert [option.get("type") for option in model] == [None, "object", None, None, "object"]  # and a robot file
    assert medium[1]["required"] == ["from"]
    # Editors offer what is shipped; a model of another name may stand beside the config.
    (models, others), (media, path) = (names[0]["anyOf"] for names in (model, medium))
    assert {"runner", "compound_pendulum"} <= set(models["enum"])
    assert others == {"type": "string"}
    assert media["enum"] == medium_names()
    assert path["pattern"] == r"\.ya?ml$"


def test_models_and_media_have_schemas_of_their_own():
    model, medium = (json_schema(kind) for kind in ("model", "medium"))
    assert model["anyOf"][0]["$ref"] == "#/$defs/Model"
    assert set(medium["anyOf"][0]["discriminator"]["mapping"]) == set(LAWS)


def test_every_class_is_closed_and_frozen():
    classes = [
        schema.Scenario,
        schema.Model,
        schema.Solver,
        schema.Load,
        schema.Initial,
        schema.Output,
        schema.Flexible,
    ]
    for choices in (BODIES, JOINTS, CLOSURES, DRIVES, SIGNALS, SHAPES, FRICTIONS, LAWS):
        classes += choices.values()
    for model in classes:
        assert (model.model_config["extra"], model.model_config["frozen"], model.model_config["strict"]) == (
            "forbid",
            True,
            True,
        )


def test_tags_name_their_class():
    for key, choices in (
        ("type", BODIES),
        ("type", JOINTS),
        ("type", CLOSURES),
        ("type", DRIVES),
        ("type", SIGNALS),
        ("type", SHAPES),
        ("type", FRICTIONS),
        ("law", LAWS),
    ):
        for tag, choice in choices.items():
            allowed = choice.model_json_schema()["properties"][key]
            assert tag in allowed.get("enum", [allowed.get("const")])


@pytest.mark.parametrize(("word", "name"), SYNONYMS.items())
def test_joints_have_two_names(word, name):
    ends = {"parent": "ground", "child": "a"}
    assert JOINTS[word].model_validate({"type": word, **ends}) == JOINTS[name].model_validate({"type": name, **ends})
    assert JOINTS[word].model_validate({"type": word, **ends}).type == name
    assert name == "free" or CLOSURES[word] is CLOSURES[name]


def test_python_callers_get_the_same_checks():
    with pytest.raises(pydantic.ValidationError, match="exceeds end_time_s"):
        schema.Solver(step_s=1)
    with pytest.raises(pydantic.ValidationError, match="no joint has a"):
        schema.Model(
            name="m", bodies={"a": {"type": "link", "length_m": 1, "diameter_m": 1, "density_kg_m3": 1}}, joints={}
        )
    with pytest.raises(pydantic.ValidationError, match="frozen"):
        schema.Solver().step_s = 1


CONFIGS = Path(__file__).parents[2] / "configs"
TYPES: dict[str, Any] = {"object": dict, "array": list, "string": str, "number": int | float, "integer": int}


def fits(part: dict[str, Any], data: Any, whole: dict[str, Any]) -> bool:
    """Whether data fit a part of a JSON Schema, by the words that ours use of it."""
    if "$ref" in part:
        return fits(whole["$defs"][part["$ref"].rpartition("/")[2]], data, whole)
    among = [
        sum(fits(alternative, data, whole) for alternative in part[key]) for key in ("anyOf", "oneOf") if key in part
    ]
    kind = part.get("type")
    if kind == "null" or not all(among) or ("enum" in part and data not in part["enum"]):
        return kind == "null" and data is None
    if "const" in part and data != part["const"]:
        return False
    if kind in TYPES and (not isinstance(data, TYPES[kind]) or isinstance(data, bool)):
        return False
    if isinstance(data, list):
        return all(fits(part.get("items", {}), item, whole) for item in data) and len(data) >= part.get("minItems", 0)
    if not isinstance(data, dict):
        return part.get("minimum", data) <= data if kind in ("number", "integer") else True
    properties, others = part.get("properties", {}), part.get("additionalProperties", True)
    if not set(part.get("required", ())) <= set(data) or (others is False and not set(data) <= set(properties)):
        return False
    return all(
        fits(properties.get(key, others if isinstance(others, dict) else {}), item, whole) for key, item in data.items()
    )


def printed(capsys: pytest.CaptureFixture[str], kind: str) -> dict[str, Any]:
    assert cli.main(["schema", "--of", kind]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_every_shipped_file_fits_the_printed_schema(capsys):
    schemas = {kind: printed(capsys, kind) for kind in ("run", "sweep", "fit", "optimise")}
    files = [path for path in sorted(CONFIGS.glob("*.yaml")) if not is_fit(path)]
    kinds = {path: "sweep" if is_sweep(path) else "run" if is_run(path) else "optimise" for path in files}
    assert [list(kinds.values()).count(kind) for kind in ("sweep", "optimise")] == [3, 5]
    for path, kind in kinds.items():
        data = plain(read_file(path, []))  # PyYAML takes 1e-3 for a text
        assert {
            schema_name: fits(schemas[schema_name], data, schemas[schema_name])
            for schema_name in ("run", "sweep", "optimise")
        } == {schema_name: schema_name == kind for schema_name in ("run", "sweep", "optimise")}, path
    example = yaml.safe_load(fit.__doc__.partition("\n\n")[2])
    assert fits(schemas["fit"], example, schemas["fit"])
    assert fit.FitFile.model_validate(example).starts == 8
    for spoilt in ({"runs": []}, {"runs": [{"config": "a"}]}, example | {"loss": "cauchy"}, example | {"start": 3}):
        assert not fits(schemas["fit"], spoilt, schemas["fit"])


@pytest.mark.slow
def test_a_sweep_holds_a_whole_config_and_one_kind_of_cases(capsys):
    whole = printed(capsys, "sweep")
    config = yaml.safe_load((CONFIGS / "pendulum.yaml").read_text())
    assert fits(
        whole,
        {"config": config, "vary": {"solver.step_s": [1e-3], "gravity_m_s2": {"from": 1, "to": 2, "count": 3}}},
        whole,
    )
    assert not fits(whole, {"config": config | {"medum": 3}, "vary": {"gravity_m_s2": [1]}}, whole)
    assert not fits(whole, {"config": "run.yaml", "vary": {"gravity_m_s2": {"from": 1, "to": 2}}}, whole)
    assert not fits(whole, {"config": "run.yaml"}, whole)


def test_models_of_both_kinds_fit_the_schema_of_models() -> None:
    model = json_schema("model")
    for path in sorted((CONFIGS.parent / "models").glob("*.yaml")):
        assert fits(model, plain(read_file(path, [])), model), path.name
    assert not fits(model, {"name": "a", "bodys": {}}, model)
