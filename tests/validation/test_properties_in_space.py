"""The study of random scenes in space: draws, images, and the starts of a few scenes."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from support_images import built_images, close

from validation import properties as study
from validation.random_scenes import images_in_space
from validation.random_scenes.in_space import SOLIDS, draw
from validation.random_scenes.scenes import solve


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory):
    folder = tmp_path_factory.mktemp("scenes")
    return [draw(seed, folder) for seed in range(36)]


@pytest.mark.slow
def test_the_draws_are_of_every_kind(drawn) -> None:
    text = str([scene.tree for scene in drawn])
    for word in (*SOLIDS, "mesh", "bar", "slope_deg", "height_map", "layers", "'floor'", "'motion'", "'pd'"):
        assert word in text, word
    joints = {joint["type"] for scene in drawn for joint in scene.tree["model"]["joints"].values()}
    assert joints >= {"hinge", "ball", "slider", "free"}
    assert {scene.solver for scene in drawn} == {
        f"{s} steps, {by}" for s in ("fixed", "chosen") for by in ("engine", "minimal")
    }


@pytest.mark.slow
def test_images_are_scenes_and_mirroring_twice_restores_the_scene(drawn, tmp_path: Path) -> None:
    made = Counter(name for name, _, _ in built_images(drawn[:12], "space", tmp_path))
    assert min(made[name] for name in study.WORLDS["space"].images) >= 4
    for scene in drawn:
        twice = images_in_space.mirrored(images_in_space.mirrored(scene.tree))
        assert close(twice, scene.tree)


def test_the_engine_takes_no_shorter_steps_after_translation_by_1_km(tmp_path: Path) -> None:
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
    outcome = study.look(seed, quick=True, world="space")
    assert outcome.end in study.GOOD
    assert np.isfinite(outcome.steps)
    assert not {name for name, bad in study.violations([outcome]).items() if bad}
