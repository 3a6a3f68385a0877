"""What a medium and its lines or elements do not ask for has no address in its record, and is not compiled."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support_laws import LOOSE, G

from granular_contact.laws.rft import Rft
from granular_contact.laws.static_friction import Elastoplastic
from granular_contact.sand.kernels import law, space_law
from granular_contact.sand.kernels.forces import medium_record
from granular_contact.sand.kernels.space_joining import space_record

OWN = Rft(LOOSE).record(Elastoplastic(1e-4, 1e-3), G)
LINE = np.zeros(1, law.LINE)


def given(record: np.ndarray, functions: tuple[str, ...]) -> set[str]:
    return {name for name in functions if record[name][0] != 0}


@pytest.mark.parametrize(
    ("asked", "more"),
    [
        ({}, ""),
        ({"paths": True}, "note count begin"),
        ({"heights": True}, "heights"),
        ({"layer": (0.0, 0.1)}, "layer"),
        ({"bodies": True}, "body"),
        ({"bodies": True, "angles": True}, "body angles"),
    ],
    ids=lambda given: given if isinstance(given, str) else "",
)
def test_in_space(asked: dict[str, Any], more: str) -> None:
    record = space_record(Rft, OWN, "surface", **asked)
    always = {"forces", "follow", "gather", "facets", "lead", "anchor"}
    assert given(record, space_law.FUNCTIONS) == always | set(more.split())
    for name, _ in law.FRICTION:  # which kernels of all laws read there
        assert record[name] == OWN[name]


def test_in_the_plane() -> None:
    bare = given(medium_record(OWN, LINE, paths=False, bodies=False), law.FUNCTIONS)
    assert bare == {"forces", "strip_force", "drag_anchor"}
    on_bodies = given(medium_record(OWN, LINE, paths=False, spatial=False), law.FUNCTIONS)
    assert on_bodies - bare == {"line_force", "line_accept"}
    on_spatial = given(medium_record(OWN, LINE, paths=False), law.FUNCTIONS)
    assert on_spatial - on_bodies == {"spatial_stations", "spatial_scatter"}
