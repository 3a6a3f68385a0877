"""Scenarios changed from Python: checked as strictly as `--set`; results name the scenario that was run."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from support_refusals import faults_of, message_of
from support_runs import CONFIGS, scenario_of, scene_of

import granular_contact
from granular_contact.config import Scenario, is_run, load, load_medium, scenario_to_dict
from granular_contact.errors import ConfigError, SceneError
from granular_contact.scene import build
from granular_contact.scene.drives import controls_of

SHORT = ("output.figures=false", "solver.end_time_s=0.002", "method={reduced: {modes: 0}}")
CHANGES: tuple[tuple[str, object, str], ...] = (
    ("medium.eta_d", 5, "5"),
    ("medium.plunging.lambda", 1.3, "1.3"),
    ("medium", "rft_generic", "rft_generic"),
    ("medium", None, "null"),
    ("load.friction", {"type": "smooth", "reference_speed_m_s": 0.01}, "{type: smooth, reference_speed_m_s: 0.01}"),
    ("initial.impact_angle_deg", np.float64(12.5), "12.5"),
    ("bed.profile_m", np.array([[-1.0, 0.0], [1.0, -0.2]]), "[[-1.0, 0.0], [1.0, -0.2]]"),
    ("model.bodies.link.flexible", None, "null"),
    ("output.figures", False, "false"),
    ("solver.step_s", None, "null"),
    ("solver.end_time_s", None, "null"),
)
FAULTY: tuple[tuple[str, object, str], ...] = (
    ("medium.eta_d", -5, "-5"),
    ("medium.eta_q", 5, "5"),
    ("initial.impact_angle_deg", 120, "120"),
    ("solver.step_s", "fast", "fast"),
    ("medium", "no_sand", "no_sand"),
    ("model.joints.pivot.parent", "nobody", "nobody"),
    ("load.friction.type", True, "true"),
)


def pendulum(*overrides: str) -> Scenario:
    return scenario_of("pendulum", *overrides)


@pytest.mark.parametrize(("key", "value", "text"), CHANGES)
def test_replace_has_the_effect_of_set(key: str, value: object, text: str) -> None:
    assert pendulum().replace({key: value}) == pendulum(f"{key}={text}")


# Keys of configs/stepping_leg.yaml, and what is there after None: nothing, the default, or a null that the key takes.
GONE = object()
NOTHING: tuple[tuple[str, object], ...] = (
    ("drives.knee", GONE),
    ("drives", {}),
    ("initial.joints.swing", GONE),
    ("initial.joints", None),
    ("drives.knee.limit_Nm", None),
    ("drives.knee.angle_deg.phase_deg", 0.0),
    ("solver.end_time_s", 0.5),
    ("solver.rest_time_s", None),
    ("gravity_m_s2", 9.81),
)


@pytest.mark.slow
@pytest.mark.parametrize(("key", "left"), NOTHING)
def test_none_removes_a_key_at_every_depth(key: str, left: object) -> None:
    leg = load("stepping_leg")
    *above, last = key.split(".")
    nested: object = {last: None}
    for name in reversed(above):
        nested = {name: nested}
    made = [leg.scenario.replace({key: None}), leg.replace({key: None}).scenario, leg.replace(nested).scenario]  # type: ignore[arg-type]
    for scenario in (*made, load("stepping_leg", [f"{key}=null"]).scenario):
        held = scenario_to_dict(scenario)
        for name in above:
            held = held[name]
        assert held.get(last, GONE) == left


@pytest.mark.parametrize("key", ["drives.hip", "model", "model.bodies.thigh", "model.joints.knee.type", "solver.end_s"])
def test_none_for_required_or_unknown_keys_is_refused(key: str) -> None:
    for scenario in (load("stepping_leg"), load("stepping_leg").scenario):
        with pytest.raises(ConfigError):
            scenario.replace({key: None})


def test_drives_of_a_robot_with_a_clock_can_be_replaced() -> None:
    """The clock that nobody follows any more is told of where keys have places, and taken away by None."""
    robot = load("hexapod")
    external = {name: {"type": "external", "torque_Nm": 0} for name in robot.scenario.drives}
    changed = robot.replace(drives=external)
    [notice] = changed.sources.notices
    assert re.fullmatch(r"\S*hexapod.yaml:\d+: signals.stride: no drive uses it; .*", notice)
    assert len(controls_of(build(robot.scenario.replace(drives=external)))) == len(external)
    without = robot.replace(drives=external, signals=None)
    assert (without.scenario.signals, without.sources.notices) == ({}, ())


def test_several_values_at_once() -> None:
    changed = pendulum().replace({"medium": "poppy_seeds_loose", "medium.zeta": 0.5, "gravity_m_s2": 1.62})
    assert changed == pendulum("medium=poppy_seeds_loose", "medium.zeta=0.5", "gravity_m_s2=1.62")
    assert pendulum().replace({}) == pendulum()


@pytest.mark.parametrize(("key", "value", "text"), FAULTY)
def test_replace_refuses_what_set_refuses_in_the_same_words(key: str, value: object, text: str) -> None:
    with pytest.raises(ConfigError) as by_set:
        pendulum(f"{key}={text}")
    with pytest.raises(ConfigError) as by_replace:
        pendulum().replace({key: value})
    reported = [[(fault.key, fault.message) for fault in error.value.faults] for error in (by_replace, by_set)]
    assert reported[0] == reported[1]
    assert by_replace.value.faults[0].file.startswith(f"replace {key}=")


def test_a_changed_medium_is_not_what_was_published() -> None:
    before = pendulum().medium
    for changed in (
        pendulum().replace({"medium.eta_d": 5}),
        build(pendulum().model_copy(update={"medium": before.model_copy(update={"eta_d": 5.0})})).scenario,
    ):
        assert changed is not None
        assert (before.provenance, changed.medium.provenance) == ("published", "own")
        assert changed.medium.standing == "changed from play_sand: eta_d"
    layered = pendulum().replace({"bed.layers": [{"top_m": 0.1, "medium": before.model_copy(update={"eta_h": 9.0})}]})
    assert build(layered).scenario.bed.layers[0].medium.provenance == "own"


def test_a_stated_provenance_of_a_medium_is_kept() -> None:
    changes = {"medium.eta_d": 5, "medium.provenance": "fitted", "medium.standing": "our own tests"}
    medium = build(pendulum().replace(changes)).scenario.medium
    assert (medium.provenance, medium.standing) == ("fitted", "our own tests")
    for name in ("play_sand", "rft_generic", "hill_cylinders", "rft3d_sand"):
        loaded = load_medium(name)
        assert pendulum().replace({"medium": loaded}).medium == loaded
    open_number = pendulum().replace({"medium": {"from": "hill_cylinders", "density_kg_m3": 1500}})
    assert build(open_number).scenario.medium.provenance == load_medium("hill_cylinders").provenance


@pytest.mark.parametrize(
    ("update", "key", "message"),
    [
        ({"gravity_m_s2": "down"}, "gravity_m_s2", "got the text 'down'; allowed is a finite number"),
        ({"surface_height_m": float("nan")}, "surface_height_m", "allowed is a finite number"),
        ({"drives": {"nowhere": {"type": "torque", "torque_Nm": 1.0}}}, "drives.nowhere", "pivot"),
        ({"windy": 3}, "windy", "unknown key"),
    ],
)
def test_updates_unchecked_by_model_copy_are_refused_when_built(
    update: dict[str, object], key: str, message: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        build(pendulum().model_copy(update=update))
    assert (caught.value.faults[0].key, message in caught.value.faults[0].message) == (key, True)


def test_nested_values_that_the_schema_forbids_are_refused_when_built() -> None:
    scenario = pendulum()
    wrong = scenario.model_copy(update={"medium": scenario.medium.model_copy(update={"eta_d": -5.0})})
    with pytest.raises(ConfigError, match=r"medium\.eta_d: got the number -5\.0; allowed is a finite number"):
        build(wrong)


def test_a_scene_knows_its_scenario() -> None:
    scenario = pendulum(*SHORT)
    scene = granular_contact.build(scenario)
    assert scene.scenario == scenario
    alone, both = granular_contact.simulate(scene), granular_contact.simulate(scene, scenario)
    assert alone.scenario == both.scenario == scenario_to_dict(scenario)
    np.testing.assert_array_equal(alone.table, both.table)


def test_a_scenario_that_was_not_run_is_refused() -> None:
    scenario, scene = pendulum(*SHORT), scene_of("pendulum", *SHORT)
    other = scenario.replace({"medium.eta_d": 5, "gravity_m_s2": 1})
    (line,) = message_of(SceneError, granular_contact.simulate, scene, other).splitlines()
    assert line.startswith("scenario: is not the one that the scene was built from: they differ in medium.")
    assert "medium.eta_d" in line
    assert "gravity_m_s2" in line


def test_a_changed_scene_has_no_scenario() -> None:
    scene = replace(scene_of("pendulum", *SHORT), gravity=1.0)
    assert scene.scenario is None
    for more in ((), (pendulum(*SHORT),)):
        with pytest.raises(SceneError, match=r"^scene: the scene was changed after it was built"):
            granular_contact.simulate(scene, *more)


def test_a_copy_with_changed_numbers_is_run_as_such() -> None:
    """The scenario that was built may be given again, though what it says of its medium was put right meanwhile."""
    scenario = pendulum(*SHORT)
    copied = scenario.model_copy(update={"medium": scenario.medium.model_copy(update={"eta_d": 5.0})})
    medium = granular_contact.simulate(build(copied), copied).scenario["medium"]
    assert (medium["eta_d"], medium["provenance"]) == (5.0, "own")


def test_a_link_too_stiff_to_bend_keeps_the_given_scenario() -> None:
    scenario = pendulum("model.bodies.link.flexible.bending_stiffness_N_m2=1e12", "medium=null")
    scene = build(scenario)
    assert (scene.stiff, scene.scenario) == (("link",), scenario)


def test_every_config_is_its_own_scenario() -> None:
    for path in sorted(CONFIGS.glob("*.yaml")):
        if is_run(path):
            scenario = load(path).scenario
            assert build(scenario).scenario is scenario


def test_a_sweep_from_python_has_the_numbers_of_single_runs() -> None:
    speeds = np.array([2.0, 6.0])
    base = pendulum(*SHORT)
    rows = granular_contact.sweep(base, {"initial.impact_speed_rad_s": speeds}, workers=1)
    assert [row["case"] for row in rows] == ["case_1", "case_2"]
    for row, speed in zip(rows, speeds, strict=True):
        single = granular_contact.simulate(build(base.replace({"initial.impact_speed_rad_s": speed})))
        assert row["initial.impact_speed_rad_s"] == speed
        assert row["max_depth_m"] == single.summary["max_depth_m"]
        assert row["energy.final_J"] == single.summary["energy"]["final_J"]


def test_a_sweep_from_python_is_checked_before_anything_runs() -> None:
    refused = partial(faults_of, ConfigError, granular_contact.sweep, pendulum())
    faults = refused({"medium.eta_d": [4, -1], "medium.eta_q": [1], "gravity_m_s2": {"from": 1}})
    assert [fault.key for fault in faults] == ["vary.gravity_m_s2.to", "vary.gravity_m_s2.count"]
    faults = refused({"medium.eta_d": [4, -1], "medium.eta_q": [1, 2]}, combine="zip")
    assert {fault.key for fault in faults} == {"medium.eta_d", "medium.eta_q"}
    with pytest.raises(ConfigError, match="none of cases, vary and sample"):
        granular_contact.sweep(pendulum())
