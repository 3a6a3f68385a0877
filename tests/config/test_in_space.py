"""The key in_space: true gives a model in space, false or none a model in the plane."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from support_runs import CONFIGS

from granular_contact import Simulation, load
from granular_contact.config import scenario_to_dict
from granular_contact.config.schema import Scenario
from granular_contact.errors import ConfigError

FOOT = """
model:
  in_space: false
  name: foot
  bodies:
    foot: {type: rigid, density_kg_m3: 1000, shapes: [{type: disc, diameter_m: 0.1, thickness_m: 0.1}]}
  joints: {fall: {type: free, parent: ground, child: foot}}
medium: poppy_seeds_loose
"""


@pytest.fixture
def foot(tmp_path: Path) -> Path:
    path = tmp_path / "foot.yaml"
    path.write_text(FOOT, encoding="utf-8")
    return path


def test_a_model_that_says_it_is_in_the_plane_is(foot: Path) -> None:
    explicit, implicit = load(foot).scenario, load(yaml.safe_load(FOOT.replace("  in_space: false\n", ""))).scenario
    assert type(explicit) is Scenario
    assert explicit.model == implicit.model
    reloaded = load(scenario_to_dict(explicit)).scenario
    assert reloaded.model == explicit.model
    ends = [Simulation(scenario).step(None, 0.05)["foot_y_m"] for scenario in (explicit, implicit)]
    assert ends[0] == ends[1]


@pytest.mark.parametrize("name", ["pendulum", "runner", "chain"])
def test_in_space_false_changes_no_shipped_planar_model(name: str) -> None:
    assert load(CONFIGS / f"{name}.yaml", ["model.in_space=false"]).scenario == load(CONFIGS / f"{name}.yaml").scenario


@pytest.mark.parametrize("value", ["null", "'yes'", "2", "[]"])
def test_in_space_must_be_true_or_false(foot: Path, value: str) -> None:
    foot.write_text(FOOT.replace("in_space: false", f"in_space: {value}"), encoding="utf-8")
    with pytest.raises(
        ConfigError, match=r"model.in_space: got .*; allowed is true, or false for a model in the plane"
    ):
        load(foot)


def test_a_robot_file_is_in_space(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text("model: {urdf: robot.urdf, in_space: false}\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"model.in_space: got false, but a robot file is in space"):
        load(path)
