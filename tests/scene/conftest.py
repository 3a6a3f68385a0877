"""Scenes of one body on a ground hinge."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from granular_contact.config import load
from granular_contact.scene import Scene, build


@pytest.fixture
def scene_of(tmp_path: Path) -> Callable[..., Scene]:
    """Scene of a body, given as YAML, that hangs on the ground at its origin, 30 degrees below the horizontal."""

    def make(body: str, medium: str = "play_sand") -> Scene:
        path = tmp_path / "run.yaml"
        path.write_text(
            f"model: {{name: one, bodies: {{body: {body}}},"
            " joints: {pin: {type: hinge, parent: ground, child: body}}}\n"
            f"medium: {medium}\ninitial: {{impact_angle_deg: 30}}\n"
        )
        return build(load(path).scenario)

    return make
