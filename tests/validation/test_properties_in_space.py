"""The study of random scenes in space: what it draws, its images, and the beginnings of a few scenes."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from granular_contact.config import load_scenario
from granular_contact.scene import build
from validation import properties as study
from validation.random_scenes import images, images_in_space
from validation.random_scenes.in_space import SOLIDS, draw
from validation.random_scenes.scenes import solve, write

SPACE = study.WORLDS["space"]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("scenes")
    return [draw(seed, folder) for seed in range(36)]


@pytest.mark.slow
def test_the_draws_are_of_every_kind(drawn) -> None:
    text = str([one.tree for one in drawn])
    for word in (*SOLIDS, "mesh", "bar", "slope_deg", "height_map", "layers", "'floor'", "'motion'", "'pd'"):
        assert word in text, word
    joints = {joint["type"] for one in drawn for joint in one.tree["model"]["joints"].values()}
    assert joints >= {"hinge", "ball", "slider", "free"}
    assert {one.solver for one in drawn} == {
        f"{s} steps, {by}" for s in ("fixed", "chosen") for by in ("engine", "minimal")
    }


@pytest.mark.slow
def test_images_are_scenes_and_twice_a_mirror_image_is_the_scene(drawn, tmp_path: Path) -> None:
    made = dict.fromkeys(SPACE.images, 0)
    for one in drawn[:12]:
        for name, image in SPACE.images.items():
            try:
                tree = image(one.tree)
            except images.NoImage:
                continue
            build(load_scenario(write(tree, tmp_path)))
            made[name] += 1
    assert min(made.values()) >= 4
    for one in drawn:
        twice = images_in_space.mirrored(images_in_space.mirrored(one.tree))
        assert _close(twice, one.tree)


def _close(one, other) -> bool:
    """Trees with the same numbers but for round-off."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_close(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(_close, one, other))
    return one == other or (isinstance(one, float) and abs(one - other) < 1e-9)


def test_a_kilometre_away_the_engine_takes_no_shorter_steps(tmp_path: Path) -> None:
    """Of an arc and a box that are thrown; its iteration found no end in the round-off of the sand's forces."""
    tree = images_in_space.shifted(draw(4, tmp_path).tree)
    tree["solver"] |= {"end_time_s": 0.05, "max_wall_s": 20.0}
    cost = solve(tree, tmp_path).summary["cost"]
    assert (cost["steps"], cost["shortened_steps"]) == (250, 0)


def test_an_image_that_does_not_end_breaks_its_property(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ended = SimpleNamespace(status=SimpleNamespace(code="time_limit"), warnings=())
    monkeypatch.setattr(study, "solve", lambda *_: ended)
    forms = study._Forms(None, tmp_path, 1.0)  # type: ignore[arg-type]
    assert forms.off(dict, {}, ends=np.inf) == np.inf
    assert np.isnan(forms.off(dict, {}))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1])
def test_beginnings_of_scenes_keep_the_properties(seed: int) -> None:
    found = study.look(seed, quick=True, world="space")
    assert found.end in study.GOOD
    assert np.isfinite(found.steps)
    assert not {name for name, bad in study.violations([found]).items() if bad}
