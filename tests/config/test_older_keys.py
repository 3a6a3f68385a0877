"""Keys that counted counter-clockwise: they work as they did, and who writes them is told what replaces them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from support_runs import ROOT, scene_of

from granular_contact import config
from granular_contact.cli.main import main
from granular_contact.errors import ConfigError

TEXT = """
model:
  name: rig
  bodies:
    car: {{type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 2000}}
    leg:
      type: rigid
      density_kg_m3: 1000
      shapes:
        - {{type: arc, radius_m: 0.03, {arc}, width_m: 0.01, thickness_m: 0.002}}
        - {{type: foot, length_m: 0.03, height_m: 0.01, width_m: 0.01, {foot}}}
  joints:
    rail: {{type: slider, parent: ground, child: car, {slider}}}
    clamp: {{type: weld, parent: car, child: leg, {weld}}}
medium: poppy_seeds_close
initial: {{joints: {{}}}}
"""
OLD = {
    "arc": "start_deg: 190, end_deg: 330",
    "foot": "angle_deg: 40",
    "slider": "axis_deg: 120, angle_deg: 25",
    "weld": "angle_deg: -70",
}
NEW = {
    "arc": "from_deg: -190, to_deg: -330",
    "foot": "tilt_deg: -40",
    "slider": "axis: [-1, 1.7320508075688772], home_deg: -25",
    "weld": "home_deg: 70",
}


def file(folder: Path, text: str) -> Path:
    path = folder / "rig.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def test_old_and_new_keys_make_the_same_scene() -> None:
    old, new = (scene_of(TEXT.format(**keys)) for keys in (OLD, NEW))
    for one, other in zip(old.rigid, new.rigid, strict=True):
        assert one.motion.angle == pytest.approx(other.motion.angle, abs=1e-15)
        assert one.motion.position == pytest.approx(other.motion.position, abs=1e-16)
        for a, b in zip(one.shapes, other.shapes, strict=True):
            np.testing.assert_allclose(a.points, b.points, atol=1e-16)
    axes = [scene.joints[0].axis for scene in (old, new)]
    np.testing.assert_allclose(axes[0], axes[1], atol=1e-15)
    # By hand: the rail rises to the left at 120 degrees from the x axis, the bar stands 25 degrees above it.
    np.testing.assert_allclose(axes[0], [-0.5, np.sqrt(0.75)], atol=1e-15)
    assert np.degrees(old.body(old.joints[0].child).motion.angle) == pytest.approx(25.0)


def test_each_old_key_is_told_once_with_its_line_and_what_to_write(tmp_path: Path) -> None:
    path = file(tmp_path, TEXT.format(**OLD))
    scenario, sources = config.load(path)
    said = "is counter-clockwise; write {}, as all angles are clockwise now"
    assert sorted(sources.notices) == sorted(
        f"{path}:{line}: model.{key}: {said.format(new)}"
        for line, key, new in (
            (10, "bodies.leg.shapes.0.start_deg", "from_deg: -190"),
            (10, "bodies.leg.shapes.0.end_deg", "to_deg: -330"),
            (11, "bodies.leg.shapes.1.angle_deg", "tilt_deg: -40"),
            (13, "joints.rail.angle_deg", "home_deg: -25"),
            (13, "joints.rail.axis_deg", "axis: [-0.5, 0.866025]"),
            (14, "joints.clamp.angle_deg", "home_deg: 70"),
        )
    )
    # What is saved with the results has the new keys, and nothing to tell.
    again = config.load(file(tmp_path, yaml.safe_dump(config.scenario_to_dict(scenario))))
    assert again.scenario == scenario
    assert again.sources.notices == ()


def test_the_command_line_tells_it_and_goes_on(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(file(tmp_path, TEXT.format(**OLD)))]) == 0
    shown = capsys.readouterr()
    assert shown.err.count("notice: ") == 6
    assert shown.out.endswith("ok\n")
    assert main(["check", str(file(tmp_path, TEXT.format(**NEW)))]) == 0
    assert capsys.readouterr().err == ""


def test_no_shipped_config_has_old_keys() -> None:
    for path in (ROOT / "configs").glob("*.yaml"):
        if config.is_run(path):
            assert config.load(path).sources.notices == (), path


def test_an_old_key_laid_over_a_new_one_counts_and_both_in_one_place_are_refused(tmp_path: Path) -> None:
    path = file(tmp_path, TEXT.format(**NEW))
    scenario, sources = config.load(path, ["model.joints.rail.axis_deg=90"])
    assert scenario.model.joints["rail"].axis == (0.0, 1.0)
    assert "write axis: [0, 1]" in sources.notices[0]
    # And the other way round: a new value over an old key.
    scenario, sources = config.load(file(tmp_path, TEXT.format(**OLD)), ["model.joints.clamp.home_deg=10"])
    assert scenario.model.joints["clamp"].home_deg == 10.0
    assert not any("clamp" in notice for notice in sources.notices)
    both = TEXT.format(**NEW | {"weld": "home_deg: 70, angle_deg: -70"})
    with pytest.raises(ConfigError, match=r"rig.yaml:14: model.joints.clamp.angle_deg: stands beside home_deg"):
        config.load(file(tmp_path, both))


@pytest.mark.parametrize(
    ("key", "text", "said"),
    [
        ("weld", "angle_deg: up", r"rig.yaml:14: model.joints.clamp.angle_deg: got 'up'; allowed is a finite number"),
        ("slider", "axis: [0, 0]", r"rig.yaml:13: model.joints.rail.axis: got \[0.0, 0.0\]; allowed is a direction"),
        ("arc", "from_deg: 20, to_deg: 20", r"to_deg: got 20, which is 0 from from_deg"),
    ],
)
def test_faults_of_either_have_their_line(key: str, text: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=said):
        config.load(file(tmp_path, TEXT.format(**NEW | {key: text})))
