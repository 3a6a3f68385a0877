"""Presets by name."""

from __future__ import annotations

from typing import Any

from granular_contact.config import load_medium
from granular_contact.errors import scene_error
from granular_contact.laws.law import Law


def preset(name: str, **values: Any) -> Law:
    """Medium of a preset, or of a YAML file.

    Parameters
    ----------
    name : str
        Name of a preset, as `play_sand`, or path of a YAML file, from the working folder.
    **values
        Values that replace those of the preset, by their keys in YAML, as `stiffness_N_m=60`.

    Returns
    -------
    Law
        The medium, for `GranularBed` or `scenario.replace({"medium": ...})`.

    Raises
    ------
    ConfigError
        There is no such medium (the message lists the presets), or a value is not allowed.
    SceneError
        A number is missing that the source of the preset does not state: give it among the values.

    Examples
    --------
    >>> from granular_contact import preset
    >>> preset("play_sand").eta_d
    6.5
    >>> preset("play_sand", eta_d=5.0).eta_d
    5.0
    """
    medium: Law = load_medium(name, **values)
    for key in medium.lacking:
        raise scene_error(f"medium.{key}", f"the source of {name} does not state it: give the number of your case")
    return medium
