"""Presets by name."""

from __future__ import annotations

from typing import Any

from granular_contact.config import load_medium
from granular_contact.errors import scene_error
from granular_contact.laws.law import Law


def preset(name: str, **values: Any) -> Law:
    """Medium by the name of its preset (`play_sand`) or by the path of a YAML file.

    values: top-level keys that replace those of the preset, as stiffness_N_m=60.

    Raises
    ------
    ConfigError
        There is no such medium, with a list of those there are, or a value is at fault.
    SceneError
        The preset lacks a number that its source does not state: give it among the values.
    """
    medium: Law = load_medium(name, **values)
    for key in medium.lacking:
        raise scene_error(f"medium.{key}", f"the source of {name} does not state it: give the number of your case")
    return medium
