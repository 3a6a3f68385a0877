"""Scenarios changed from Python: checked like a config, and saying of their media what is true of the new numbers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from granular_contact.config import tree
from granular_contact.config.export import scenario_to_dict
from granular_contact.config.given import changes, plain_data
from granular_contact.config.load import load_medium
from granular_contact.config.references import medium_names, restated
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.template import Template, scenario_of
from granular_contact.errors import Fault

_HERE = tree.Position("", None)
_ABOUT = ("provenance", "standing")


def filled(scenario: Scenario, at: tree.Position = _HERE) -> Template:
    """Template of a scenario with every default in place, so that each single value can be replaced."""
    return Template(tree.made(scenario_to_dict(scenario), at), Path(scenario.name or "scenario"), [])


def replaced(scenario: Scenario, values: Mapping[str, Any]) -> Scenario:
    """A scenario with other values, by their dotted keys; as `--set` does it.

    Raises
    ------
    ConfigError
        With every fault.
    """
    faults: list[Fault] = []
    parsed = changes(values, "replace", faults)
    return filled(checked(scenario)).make(parsed, faults).scenario


def checked(scenario: Scenario) -> Scenario:
    """The scenario as a config would give it, however it was made (`model_copy` and `model_construct` check nothing).

    A medium that bears the name, the provenance and the standing of a preset, but not its numbers, says so.

    Raises
    ------
    ConfigError
        With every fault.
    """
    plain = scenario.model_dump(by_alias=True, warnings=False)
    plain |= {
        key: held for key, held in vars(scenario).items() if key not in type(scenario).model_fields
    }  # to be refused
    changed = _restate(plain)
    try:
        valid = type(scenario).model_validate(plain)
    except ValidationError:  # once more, as a tree, in which messages find what was got
        return scenario_of(tree.made(plain_data(plain), _HERE), [])
    return scenario if not changed and valid == scenario else valid


def _restate(plain: dict[str, Any]) -> bool:
    """Put right what the media of a scenario, as plain data, say of their numbers; whether one said what is not so."""
    medium, bed = plain.get("medium"), plain.get("bed")
    layers = bed.get("layers") if isinstance(bed, dict) else None
    media = [*(medium if isinstance(medium, list | tuple) else [medium])]
    media += [layer.get("medium") for layer in layers or () if isinstance(layer, dict)]
    return any([_restate_one(one) for one in media if isinstance(one, dict)])


def _restate_one(medium: dict[str, Any]) -> bool:
    """The same of one medium."""
    preset = _preset(medium.get("name"))
    if preset is None or preset["law"] != medium.get("law"):
        return False
    base, node = tree.made(preset, _HERE), tree.made(plain_data(medium), _HERE)
    assert isinstance(base, tree.Mapping)
    assert isinstance(node, tree.Mapping)
    for key in _ABOUT:  # what stands there was not written over
        if preset[key] == medium.get(key):
            node = tree.set_key(node, key, base.nodes[key], _HERE)
    after = tree.plain(restated(base, node))
    said = {key: after[key] for key in _ABOUT if after.get(key) != medium.get(key)}
    medium |= said
    return bool(said)


@cache
def _preset(name: object) -> dict[str, Any] | None:
    """The preset of this name as plain data; None if there is none."""
    if name not in medium_names():
        return None
    dumped = load_medium(str(name)).model_dump(by_alias=True)
    listed: dict[str, Any] = plain_data(dumped)
    return listed
