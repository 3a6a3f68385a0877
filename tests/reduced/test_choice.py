"""The choice of the reduced model: config, command line, refusals, and imports it avoids."""

from __future__ import annotations

import pytest
from support_refusals import faults_of, message_of
from support_runs import ROOT, scenario_of, scene_of

from granular_contact import cli, config
from granular_contact.config.export import scenario_to_dict
from granular_contact.errors import ConfigError, SceneError

LINK = "{type: link, length_m: 0.2, diameter_m: 0.006, density_kg_m3: 7700, flexible: {bending_stiffness_N_m2: 15}}"
HUB = "{type: rigid, density_kg_m3: 7700, shapes: [{type: disc, diameter_m: 0.02, thickness_m: 0.01}]}"
PIVOT = "{type: hinge, parent: ground, child: a}"


def mechanism(bodies: dict[str, str], joints: dict[str, str]) -> str:
    lines = ["model:", "  name: m", "  bodies:", *(f"    {name}: {body}" for name, body in bodies.items())]
    lines += ["  joints:", *(f"    {name}: {joint}" for name, joint in joints.items())]
    return "\n".join([*lines, "initial: {impact_angle_deg: 20}", "method: reduced", ""])


def weld(parent: str, child: str, kind: str = "weld", more: str = "") -> str:
    return f"{{type: {kind}, parent: {parent}, child: {child}{more}}}"


TIP, SIDE, TURNED = ", parent_point_m: [0.2, 0]", ", child_point_m: [0.2, 0]", ", home_deg: -90"
HINGED = {"p": PIVOT, "w": weld("a", "b")}
REFUSED = {
    "a chain": (
        mechanism({"a": HUB, "b": LINK, "c": HUB}, {**HINGED, "h": weld("b", "c", "hinge", TIP)}),
        "2 hinges",
    ),
    "a hinged link": (mechanism({"a": LINK}, {"p": PIVOT}), "the root of the flexible a"),
    "two links": (
        mechanism({"a": HUB, "b": LINK, "c": LINK}, {**HINGED, "v": weld("a", "c", "weld", TURNED)}),
        "2 flexible links",
    ),
    "a load at the tip": (
        mechanism({"a": HUB, "b": LINK, "c": HUB}, {**HINGED, "v": weld("b", "c", "weld", TIP)}),
        "2 rigid bodies",
    ),
    "a link by its tip": (
        mechanism({"a": HUB, "b": LINK}, {"p": PIVOT, "w": weld("a", "b", "weld", SIDE)}),
        "the tip of the flexible b",
    ),
    "a cantilever": (mechanism({"b": LINK}, {"w": weld("ground", "b")}), "no hinges"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_mechanisms_without_a_reduction(name):
    text, reason = REFUSED[name]
    (fault,) = faults_of(SceneError, scene_of, text)
    assert fault.key == "method"
    assert reason in fault.message
    assert "the reduced model is for one hinge on the ground" in fault.message
    assert "\n" not in str(fault)


def test_a_rigid_model_has_no_modes():
    message = message_of(SceneError, scene_of, "pendulum_rigid", "method=reduced")
    assert message == "method.reduced.modes: got 1, but the model has no flexible link: allowed is 0"
    assert scene_of("pendulum_rigid", "method.reduced.modes=0").method.modes == 0


def test_the_fault_gets_its_line(tmp_path, capsys):
    path = tmp_path / "chain.yaml"
    path.write_text(REFUSED["a chain"][0])
    assert cli.main(["check", str(path)]) == 2
    assert f"{path}:12: method: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("method.reduced.modes=-1", "got the number -1; allowed is a whole number from 0 to 20"),
        ("method.reduced.modes=21", "from 0 to 20"),
        ("method.reduced.rtol=0", "from 1e-13 to 0.01"),
        ("method.reduced.order=2", "unknown key"),
        ("method=fem", "allowed are auto, engine, minimal, reduced, and a mapping whose key is one of the last three"),
        ("method={minimal: {rtol: 1e-5}}", "method.minimal.rtol: unknown key; none is allowed here"),
        ("method=[1]", "allowed is a mapping with the keys engine, minimal, reduced"),
        ("method.reduced.static=smooth", "load.friction has the type elastoplastic"),
    ],
)
def test_faults_of_the_choice(setting, message):
    with pytest.raises(ConfigError, match="method") as caught:
        scenario_of("pendulum", setting)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "written", ["auto", "engine", "minimal", "reduced", "{reduced: {modes: 3, static: elastoplastic}}"]
)
def test_choice_survives_a_file(written):
    scenario = scenario_of("pendulum", f"method={written}")
    reloaded = config.Scenario.model_validate(scenario_to_dict(scenario))
    assert reloaded == scenario
    assert (scenario_to_dict(scenario)["method"] == "engine") == (written == "engine")


def test_command_line(tmp_path, capsys):
    pendulum, out = str(ROOT / "configs" / "pendulum.yaml"), ("--no-plots", "--out", str(tmp_path / "out"))
    assert cli.main(["run", pendulum, "--method", "reduced", "--modes", "0", *out]) == 0
    assert "35.235 deg" in capsys.readouterr().out
    assert cli.main(["run", pendulum, "--modes", "99", *out]) == 2
    assert "from 0 to 20" in capsys.readouterr().err
    assert cli.main(["run", pendulum, "--method", "engine", "--modes", "1", *out]) == 2
    assert "--modes 1: the engine has none" in capsys.readouterr().err
