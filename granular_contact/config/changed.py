"""Changes of scenarios from Python. The result is checked as a config is, and the provenance of its media corrected."""

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
from granular_contact.config.references import medium_names, with_true_provenance
from granular_contact.config.schema.scenario import Scenario
from granular_contact.config.template import Template, scenario_of
from granular_contact.errors import Fault

_HERE = tree.Position("", None)
_ABOUT = ("provenance", "standing")


def filled(scenario: Scenario, at: tree.Position = _HERE) -> Template:
    """Template of a scenario that contains all defaults, so that each single value can be replaced.

    at: position of all its keys in messages.
    """
    return Template(tree.from_plain(scenario_to_dict(scenario), at), Path(scenario.name or "scenario"), [])


def replaced(scenario: Scenario, values: Mapping[str, Any]) -> Scenario:
    """A scenario with other values by dotted key, as `--set` gives it.

    Raises
    ------
    ConfigError
        With every fault.
    """
    faults: list[Fault] = []
    overrides = changes(values, "replace", faults)
    return filled(checked(scenario)).make(overrides, faults).scenario


def checked(scenario: Scenario) -> Scenario:
    """The scenario, checked as a config is, however it was made (`model_copy` and `model_construct` check nothing).

    A medium with the name, provenance and standing of a preset, but other numbers, gets corrected provenance and
    standing.

    Raises
    ------
    ConfigError
        With every fault.
    """
    plain = scenario.model_dump(by_alias=True, warnings=False)
    unknown = {key: value for key, value in vars(scenario).items() if key not in type(scenario).model_fields}
    plain |= unknown  # which the check refuses
    is_corrected = _correct_provenance(plain)
    try:
        valid = type(scenario).model_validate(plain)
    except ValidationError:  # check it again as a tree, from which messages quote the faulty values
        return scenario_of(tree.from_plain(plain_data(plain), _HERE), [])
    return scenario if not is_corrected and valid == scenario else valid


def _correct_provenance(plain: dict[str, Any]) -> bool:
    """Correct the provenance of the media of a scenario, as plain data; return whether any of them was wrong."""
    medium, bed = plain.get("medium"), plain.get("bed")
    layers = bed.get("layers") if isinstance(bed, dict) else None
    media = [*(medium if isinstance(medium, list | tuple) else [medium])]
    media += [layer.get("medium") for layer in layers or () if isinstance(layer, dict)]
    return any([_correct_medium(data) for data in media if isinstance(data, dict)])


def _correct_medium(medium: dict[str, Any]) -> bool:
    """Correct the provenance of one medium; return whether it was wrong."""
    preset = _preset(medium.get("name"))
    if preset is None or preset["law"] != medium.get("law"):
        return False
    base, node = tree.from_plain(preset, _HERE), tree.from_plain(plain_data(medium), _HERE)
    assert isinstance(base, tree.Mapping)
    assert isinstance(node, tree.Mapping)
    for key in _ABOUT:  # a text equal to that of the preset gets its node, which marks it as not overridden
        if preset[key] == medium.get(key):
            node = tree.set_key(node, key, base.nodes[key], _HERE)
    after = tree.plain(with_true_provenance(base, node))
    corrections = {key: after[key] for key in _ABOUT if after.get(key) != medium.get(key)}
    medium |= corrections
    return bool(corrections)


@cache
def _preset(name: object) -> dict[str, Any] | None:
    """The preset of this name as plain data; None if there is none."""
    if name not in medium_names():
        return None
    plain: dict[str, Any] = plain_data(load_medium(str(name)).model_dump(by_alias=True))
    return plain
