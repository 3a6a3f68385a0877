"""Whether media can be where a scenario puts them: on slopes that they keep, at a gravity that they are known at.

A slope without end that is steeper than the angle of repose is refused: no bed of that medium stands so. Corners of a
profile and of a map of heights are told in a note, as measured ground has edges and noise that a pile has not.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from granular_contact.errors import Fault, scene_fault
from granular_contact.laws.gravity import gravity_notes
from granular_contact.laws.repose import steep_places, steeper
from granular_contact.scene.bed import places


def too_steep(scenario: Any) -> Iterator[Fault]:
    """Faults of a slope, in the plane or in space."""
    if scenario.bed is not None:
        media = [medium for medium, *_ in places(scenario)]
        yield from (scene_fault("bed.slope_deg", words) for words in steeper(media, scenario.bed.slope_deg))


def media_notes(scenario: Any, placed: Any, uneven: str) -> Iterator[Fault]:
    """What is assumed of the media of a scenario; placed: its bed, or None; uneven: key of a surface of pieces."""
    for medium, key, *_ in places(scenario):
        yield from (scene_fault(key, words) for words in gravity_notes(medium, scenario.gravity_m_s2))
    if placed is not None:
        yield from (scene_fault(uneven, words) for words in steep_places(placed.media, placed.pieces()))
