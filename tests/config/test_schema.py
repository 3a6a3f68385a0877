"""The schema as data: what an editor is told, and what Python callers may rely on."""

import pydantic
import pytest

from granular_contact.config import json_schema, schema
from granular_contact.config.schema.drives import DRIVES
from granular_contact.config.schema.joints import CLOSURES, JOINTS
from granular_contact.config.schema.mechanism import BODIES
from granular_contact.config.schema.scenario import FRICTIONS
from granular_contact.config.schema.shapes import SHAPES
from granular_contact.config.schema.signals import SIGNALS
from granular_contact.laws.catalogue import LAWS


def test_json_schema_takes_names_and_mappings():
    model, medium = (json_schema()["properties"][key]["anyOf"] for key in ("model", "medium"))
    assert [option.get("type") for option in model] == ["string", "object", None]
    assert medium[1]["required"] == ["from"]


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
    for one in classes:
        assert (one.model_config["extra"], one.model_config["frozen"], one.model_config["strict"]) == (
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
            assert choice.model_json_schema()["properties"][key]["const"] == tag


def test_python_callers_get_the_same_checks():
    with pytest.raises(pydantic.ValidationError, match="exceeds end_time_s"):
        schema.Solver(step_s=1)
    with pytest.raises(pydantic.ValidationError, match="no joint has a"):
        schema.Model(
            name="m", bodies={"a": {"type": "link", "length_m": 1, "diameter_m": 1, "density_kg_m3": 1}}, joints={}
        )
    with pytest.raises(pydantic.ValidationError, match="frozen"):
        schema.Solver().step_s = 1
