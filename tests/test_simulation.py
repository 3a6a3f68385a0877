"""Scenes that go on step by step: the same as in one call, set from outside, and back to earlier states bit for bit."""

from __future__ import annotations

import pickle
import re
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from support_runs import scenario_of

from granular_contact import Simulation, build, simulate
from granular_contact.config import Scenario
from granular_contact.errors import ConfigError, ControlError, ControllerError, unknown_name
from granular_contact.run import run

BAR = "type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 2700"
# Two links on a hinge over the sand: the lower joint has stops and dry friction, both are set from outside.
LEG = f"""
model:
  name: leg
  bodies:
    thigh: {{{BAR}}}
    shank: {{{BAR}}}
  joints:
    hip: {{type: hinge, parent: ground, child: thigh}}
    knee:
      type: hinge
      parent: thigh
      child: shank
      parent_point_m: [0.1, 0]
      stops: {{lower_deg: -20, upper_deg: 60, stiffness_Nm_per_rad: 50}}
      friction: {{torque_Nm: 0.01}}
medium: play_sand
bed: {{height_m: -0.12, depth_m: 0.03, floor: {{stiffness_N_m2: 1e4, damping_s_m: 0.3}}}}
initial: {{joints: {{hip: {{angle_deg: 30}}, knee: {{angle_deg: 10}}}}}}
drives:
  hip:
    {{type: external, angle_deg: 30, gain_Nm_per_rad: 3, rate_gain_Nm_s_per_rad: 0.03, limit_Nm: 1, range: [-45, 120]}}
  knee: {{type: external, torque_Nm: 0, range: [-0.5, 0.5]}}
solver: {{end_time_s: 0.15, step_s: 5e-4}}
load: {{strips_per_rigid_part: 4}}
output: {{bodies: all}}
"""
SHORT = ("solver.end_time_s=0.03", "solver.rest_time_s=null")
# Of every way of solving, with fixed steps and chosen ones, with beams, clocks, settling and rows that are cut off.
SCENES = {
    "leg": (LEG, ()),
    "leg by accuracy": (LEG, ("solver.accuracy=1e-2",)),
    "flexible": ("pendulum", SHORT),
    "flexible by accuracy": ("pendulum", (*SHORT, "solver.accuracy=1e-3")),
    "runner": ("runner", ("solver.accuracy=1e-2", "solver.end_time_s=0.06")),
    "vacuum": ("pendulum", (*SHORT, "medium=null")),
    "minimal": ("pendulum_rigid", (*SHORT, "method=minimal")),
    "leg, minimal": (LEG, ("method=minimal",)),
    "reduced": ("pendulum", (*SHORT, "method.reduced.modes=1")),
    "reduced with bristles": ("pendulum", (*SHORT, "method={reduced: {modes: 1, static: elastoplastic}}")),
}
PAUSES = 12


def of(name: str) -> Simulation:
    text, overrides = SCENES[name]
    return Simulation(scenario_of(text, *overrides))


def swing(count: int, names: tuple[str, ...]) -> dict[str, float]:
    """Controls of a pause, of those that there are; the leg is pressed through the sand to the floor."""
    wanted = {"hip_angle_deg": 30.0 + 70.0 * np.sin(0.4 * count), "knee_torque_Nm": 0.3 * (-1.0) ** count}
    return {name: wanted[name] for name in names}


def go_on(simulation: Simulation, pauses: int) -> list[np.ndarray]:
    """All that is seen in the pauses to come."""
    pause, seen = simulation.scenario.solver.end_time_s / PAUSES, []
    for _ in range(pauses):
        count = round(simulation.time / pause)
        reached = simulation.step(swing(count, simulation.controls), pause)
        seen.append(np.array(list(reached.values())))
    return seen


# ---- the same run ----


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "pauses", "more"),
    [("pendulum_rigid", 1000, ()), ("pendulum", 100, ()), ("pendulum", 1000, SCENES["reduced"][1][2:])],
)
def test_a_run_in_a_thousand_steps_equals_the_run_in_one_call(name: str, pauses: int, more: tuple[str, ...]) -> None:
    scenario = scenario_of(name, "solver.end_time_s=0.02", "solver.step_s=2e-5", "solver.rest_time_s=null", *more)
    whole, simulation, calls = run(build(scenario)), Simulation(scenario), 0
    while simulation.ended is None:
        simulation.step(None, 0.02 / pauses)
        calls += 1
    parts = simulation.results()
    assert calls == pauses
    assert [column.name for column in parts.columns] == [column.name for column in whole.columns]
    # Times differ by their sum's round-off, 1e-13 of the step, at speeds up to 2 m/s and accelerations up to 1e4 m/s2.
    # The reduced model chooses its steps by their error and ends one at each pause, so that it differs by that error.
    share = build(scenario).method.rtol if more else 1e-8
    scale = np.abs(whole.table).max(axis=0)
    assert (np.abs(parts.table - whole.table).max(axis=0) <= share * np.maximum(scale, 1e-3)).all()
    for key in () if more else ("steps", "newton_iterations", "jacobians"):  # of the engine
        assert parts.summary["cost"][key] == whole.summary["cost"][key]
    assert parts.status == whole.status


@pytest.mark.parametrize("name", ["minimal", "reduced", "reduced with bristles", "flexible by accuracy"])
def test_pauses_leave_chosen_steps_as_exact(name: str) -> None:
    simulation = of(name)
    go_on(simulation, PAUSES)
    parts, whole = simulation.results(), run(build(simulation.scenario))
    assert parts.status == whole.status
    # Both are off by their tolerances, 1e-3 of the way at the most, over which the pendulum turns by 5 degrees.
    assert parts["pivot_angle_deg"][-1] == pytest.approx(whole["pivot_angle_deg"][-1], abs=0.005)


@pytest.mark.parametrize("name", ["leg", "minimal", "leg, minimal", "reduced", "reduced with bristles"])
def test_all_solvers_go_on_to_the_end(name: str) -> None:
    simulation = of(name)
    np.testing.assert_array_equal(simulation.run().table, run(build(simulation.scenario)).table)
    with pytest.raises(ControlError, match="the run is over"):
        simulation.run()
    # From half way, under a controller that is called first there.
    simulation.reset()
    half = simulation.step(None, 0.5 * simulation.scenario.solver.end_time_s).time
    called: list[float] = []

    def watch(t: float, _: object) -> None:
        called.append(t)

    results = simulation.run(watch, control_rate_Hz=4.0 / half)
    assert results.status == simulation.ended
    np.testing.assert_allclose(called, half * np.array([1.0, 1.25, 1.5, 1.75]))


def test_a_scene_that_settles_starts_where_its_run_does() -> None:
    scenario = scenario_of(LEG, "initial={settle: true}", "solver.end_time_s=0.002")
    whole, simulation = run(build(scenario)), Simulation(scenario)
    assert simulation.observe()["hip_angle_deg"] == whole["hip_angle_deg"][0]
    simulation.step(None, 1.0)
    np.testing.assert_array_equal(simulation.results().table, whole.table)


# ---- back to a state ----


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_a_state_in_mid_stride_has_the_same_future_bit_by_bit(name: str) -> None:
    simulation = of(name)
    before = go_on(simulation, 5)
    kept = pickle.dumps(simulation.state())
    future = go_on(simulation, PAUSES - 5)
    assert simulation.ended is not None
    table = simulation.results().table
    for other in (simulation, of(name)):
        other.restore(pickle.loads(kept))
        np.testing.assert_array_equal(go_on(other, PAUSES - 5), future)
        np.testing.assert_array_equal(other.results().table, table)
    # To look at a state does not change what comes, and to begin anew is to begin.
    simulation.reset()
    np.testing.assert_array_equal(go_on(simulation, PAUSES), before + future)


def test_leg_scene_uses_bristles_floor_and_friction() -> None:
    simulation = of("leg")
    seen = go_on(simulation, PAUSES)
    results = simulation.results()
    assert any("floor was reached" in warning for warning in results.warnings)
    assert np.abs(results["floor_force_y_N"]).max() > 0.1
    assert results["depth_m"].max() > 0.03
    assert results["friction_work_J"][-1] < -1e-3
    assert np.ptp([row[1] for row in seen]) > 10.0


def test_a_state_of_another_scene_is_refused() -> None:
    simulation = of("leg")
    other = Simulation(simulation.scenario.replace({"medium.eta_d": 5, "gravity_m_s2": 3.7})).state()
    with pytest.raises(ControlError, match=r"another scene.*medium.eta_d.*gravity_m_s2"):
        simulation.restore(other)
    with pytest.raises(ControlError, match=r"got {}, allowed is what state\(\) gave"):
        simulation.restore({})  # type: ignore[arg-type]
    assert simulation.time == 0.0


# ---- what is seen ----


SEEN = {name: SCENES[name] for name in ("leg", "flexible", "minimal", "leg, minimal")}
SEEN["sliders"] = "dragged_plate", ("solver.end_time_s=0.02", "method=engine")
SEEN["hinges of links that bend"] = "chain_flexible", ("solver.end_time_s=0.01", "solver.rest_time_s=null")


@pytest.mark.parametrize("name", SEEN)
def test_observations_are_the_columns_of_the_results(name: str) -> None:
    text, overrides = SEEN[name]
    simulation = Simulation(scenario_of(text, *overrides, "output.bodies=all"))
    go_on(simulation, 7)
    seen, results = simulation.observe(), simulation.results()
    shared = [column.name for column in results.columns if column.name in seen]
    unshared = [key for key in seen if key not in shared]
    assert len(shared) >= 10
    assert all(key.endswith(("_rad", "_depth_m", "_contact")) for key in unshared)
    for key in shared:
        assert seen[key] == pytest.approx(results[key][-1], rel=1e-9, abs=1e-9 * np.abs(results[key]).max()), key
    np.testing.assert_allclose(seen.array(shared), [seen[key] for key in shared])
    assert dict(pickle.loads(pickle.dumps(seen))) == dict(seen)
    with pytest.raises(KeyError, match="no observation 'nothing'; there are: time_s, "):
        seen["nothing"]


def test_links_that_bend_keep_their_turns() -> None:
    scenario = scenario_of("pendulum", *SHORT, "medium=null", "output.bodies=all").replace(
        {"initial.impact_speed_rad_s": 200, "solver.end_time_s": 0.05}
    )
    simulation = Simulation(scenario)
    simulation.step(None, 0.04)  # a turn and more at once
    turned = simulation.step(None, 1.0)["link_orientation_deg"]
    assert turned > 400.0
    assert turned == pytest.approx(simulation.results()["link_orientation_deg"][-1], rel=1e-9)
    kept = simulation.state()
    simulation.reset()
    assert simulation.restore(kept)["link_orientation_deg"] == turned


# ---- controls ----


def test_controls_act_as_drives_do() -> None:
    drives = "drives={hip: {type: pd, angle_deg: 50, gain_Nm_per_rad: 3, rate_gain_Nm_s_per_rad: 0.03, limit_Nm: 1}, "
    drives += "knee: {type: torque, torque_Nm: 0.2}}"
    driven = Simulation(scenario_of(LEG, drives, "solver.end_time_s=0.1"))
    steered = Simulation(scenario_of(LEG, "solver.end_time_s=0.1"))
    controls: Any
    for controls in ({"hip_angle_rad": np.radians(50.0), "knee_torque_Nm": 0.2}, None, [50.0, 0.2], {}):
        driven.step(None, 0.02)
        steered.step(controls, 0.02)
    a, b = driven.results(), steered.results()
    np.testing.assert_allclose(a.table, b.table, rtol=1e-12, atol=1e-12)
    assert np.abs(b["knee_torque_Nm"] - 0.2).max() == 0.0


def test_controls_beyond_their_range_are_limited_with_a_warning() -> None:
    simulation = of("leg")
    assert not any("beyond" in warning for warning in simulation.results().warnings)
    simulation.step({"knee_torque_Nm": 0.5, "hip_angle_rad": np.radians(120.0)}, 0.01)  # the ends themselves
    before = simulation.state()
    simulation.step({"knee_torque_Nm": 7.0}, 0.01)
    simulation.step([-60.0, 0.6], 0.01)
    results = simulation.results()
    assert results["knee_torque_Nm"][-1] == 0.5
    expected = (
        "hip_angle_deg was given beyond its range, -45 to 120, once, by 15 at the most: ",
        "knee_torque_Nm was given beyond its range, -0.5 to 0.5, 2 times, by 6.5 at the most: ",
    )
    for warning in expected:
        assert f"{warning}it was set to the end of the range" in results.warnings
    simulation.restore(before)
    simulation.step([120.0, 0.5], 0.01)
    assert not any("beyond" in warning for warning in simulation.results().warnings)


def test_the_energy_balance_holds_under_a_controller_that_switches() -> None:
    def bang(_: float, seen: Any) -> dict[str, float]:
        return {"knee_torque_Nm": -0.4 if seen["knee_angle_deg"] > 20.0 else 0.4}

    results = simulate(scenario_of(LEG, "solver.step_s=1e-4"), control=bang, control_rate_Hz=200)
    switches = np.flatnonzero(np.diff(results["knee_torque_Nm"]))
    assert len(switches) > 4
    # At whole periods of 5 ms: what is set at one acts from the step after it.
    periods = results["time_s"][switches] / 0.005
    np.testing.assert_allclose(periods, np.round(periods), atol=1e-9)
    assert results.summary["energy"]["imbalance_relative"] < 1e-3
    assert np.abs(results["drive_work_J"]).max() > 0.1


BAD: tuple[tuple[Any, Any, str], ...] = (
    ({"hips_angle_deg": 1.0}, 0.01, r"no control 'hips_angle_deg'; did you mean hip_angle_deg\?"),
    ({"hip_angle": 1.0}, 0.01, r"no control 'hip_angle'; did you mean hip_angle_deg\?"),
    ({"hip_angle_m": 1.0}, 0.01, "no control 'hip_angle_m'"),
    ({"knee_torque_rad": 1.0}, 0.01, "no control 'knee_torque_rad'"),
    ({"knee_torque_Nm": 0.1, "hip_angle_deg": np.nan}, 0.01, "hip_angle_deg: got nan, allowed is a finite number"),
    ({"knee_torque_Nm": "much"}, 0.01, "knee_torque_Nm: got 'much'"),
    ([1.0, 2.0, 3.0], 0.01, r"got the shape \(3,\), allowed is \(2,\): hip_angle_deg, knee_torque_Nm"),
    ([1.0, np.inf], 0.01, "knee_torque_Nm: got inf"),
    ([[1.0], [2.0, 3.0]], 0.01, r"controls: got \[\[1.0\], \[2.0, 3.0\]\], allowed is one number for each"),
    ({}, 0.0, "dt: got 0.0, allowed is a time of at least"),
    ({}, np.nan, "dt: got nan"),
    ({}, True, "dt: got True"),
)


@pytest.mark.parametrize(("controls", "dt", "message"), BAD)
def test_bad_controls_are_reported_and_change_nothing(controls: Any, dt: float, message: str) -> None:
    simulation = of("leg")
    simulation.step({"knee_torque_Nm": 0.1}, 0.01)
    kept = simulation.state()
    with pytest.raises(ControlError, match=message):
        simulation.step(controls, dt)
    assert simulation.time == kept.time
    assert simulation.state().controls == kept.controls
    future = list(simulation.step(None, 0.01).values())
    simulation.restore(kept)
    assert list(simulation.step(None, 0.01).values()) == future


def test_a_run_without_external_drives_says_what_gives_a_control() -> None:
    with pytest.raises(ControlError, match=r"no control 'hip_torque_Nm': no drive is external; give a joint one"):
        of("flexible").step({"hip_torque_Nm": 1.0}, 0.01)


def test_a_step_after_the_end_is_refused() -> None:
    simulation = of("flexible")
    seen = simulation.step(None, 1.0)
    assert seen.time == pytest.approx(0.03)
    assert simulation.ended is not None
    with pytest.raises(ControlError, match=r"the run is over \(end time 0.03 s reached\)"):
        simulation.step(None, 0.01)
    assert simulation.reset().time == 0.0
    assert simulation.ended is None


def raising(*_: object) -> dict[str, float]:
    raise RuntimeError("lost its way")


# What a controller does at last, and how the status tells it.
CONTROLLERS: dict[str, tuple[Callable[..., Any], str]] = {
    "raises": (raising, r"RuntimeError: lost its way \(.*test_simulation.py:\d+\)"),
    "another name": (lambda *_: {"hip_angle_dg": 1.0}, r"no control 'hip_angle_dg'; did you mean hip_angle_deg\?$"),
    "another number": (lambda *_: [1.0], r"controls: got the shape \(1,\), allowed is \(2,\): hip_angle_deg, knee"),
    "no number": (lambda *_: {"hip_angle_deg": np.nan}, "hip_angle_deg: got nan, allowed is a finite number$"),
    "words": (lambda *_: "stop", r"controls: got the shape \(\), allowed is \(2,\)"),
}


@pytest.mark.parametrize("case", CONTROLLERS)
def test_results_before_a_controller_failure_are_kept(case: str) -> None:
    last, message = CONTROLLERS[case]
    controls = {"knee_torque_Nm": 0.1}
    with pytest.raises(ControllerError) as caught:
        simulate(scenario_of(LEG), control=lambda t, _: last() if t > 0.0199 else controls, control_rate_Hz=100)
    results = caught.value.results
    assert results.status.code == "failed"
    assert re.match(f"the controller failed at 0.02 s: {message}", results.status.message)
    assert str(caught.value) == results.status.message
    assert type(caught.value.__cause__) is (RuntimeError if case == "raises" else ControlError)
    assert results.summary["status"] == "failed"
    undisturbed = Simulation(scenario_of(LEG))
    for _ in range(2):
        undisturbed.step(controls, 0.01)
    np.testing.assert_array_equal(results.table, undisturbed.results().table)


@pytest.mark.parametrize("rate", [0.0, np.nan, "fast"])
def test_a_rate_of_control_is_above_nothing(rate: Any) -> None:
    with pytest.raises(ControlError, match="control_rate_Hz"):
        simulate(scenario_of(LEG), control=lambda *_: {}, control_rate_Hz=rate)


def test_a_simulation_raises_it_too_and_keeps_what_was_reached() -> None:
    simulation = of("leg")
    with pytest.raises(ControllerError, match="lost its way"):
        simulation.run(lambda t, _: raising() if t > 0.0099 else {}, 100)
    assert simulation.ended is not None
    assert simulation.ended.code == "failed"
    assert simulation.results()["time_s"][-1] == pytest.approx(0.01)
    simulation.reset()
    assert simulation.run(lambda *_: {}, 100).status.code != "failed"


def test_controller_error_is_pickled_with_its_results() -> None:
    with pytest.raises(ControllerError) as caught:
        simulate(scenario_of(LEG), control=raising)
    unpickled = pickle.loads(pickle.dumps(caught.value))
    assert str(unpickled) == str(caught.value)
    np.testing.assert_array_equal(unpickled.results.table, caught.value.results.table)


def test_the_nearest_of_many_names_is_suggested() -> None:
    names = [f"leg_{i}_torque_Nm" for i in range(200)]
    assert unknown_name("control", "leg_17_torqe_Nm", names).startswith(
        "no control 'leg_17_torqe_Nm'; did you mean leg_17"
    )
    message = unknown_name("control", "hip", names)
    assert message.endswith("leg_11_torque_Nm, and 188 more")
    simulation = of("leg")
    for holder, name in ((simulation.observe(), "hip_angel_deg"), (simulation.results(), "hip_angel_deg")):
        with pytest.raises(KeyError, match=r"did you mean hip_angle_deg"):
            holder[name]


def test_wall_time_counts_what_the_controller_takes() -> None:
    scenario = scenario_of(LEG, "solver.max_wall_s=0.3")
    results = simulate(scenario, control=lambda *_: time.sleep(0.05), control_rate_Hz=1000)
    assert results.status.code == "time_limit"
    assert "solver.max_wall_s (0.3), was reached" in results.status.message
    assert 0.0 < results["time_s"][-1] < 0.01  # six or seven calls of 50 ms


def test_a_rate_of_control_beyond_all_steps_is_refused() -> None:
    with pytest.raises(ControlError, match=r"control_rate_Hz: got 1e\+12, allowed is at most"):
        simulate(scenario_of(LEG), control=lambda *_: {}, control_rate_Hz=1e12)


# ---- beginning anew ----


def drawn(simulation: Simulation, seed: int | None) -> list[float]:
    simulation.reset(seed=seed, **{"medium.eta_d": lambda random: random.uniform(4.0, 9.0), "solver.end_time_s": 0.02})
    return [float(simulation.scenario.medium.eta_d), simulation.step(None, 0.02)["depth_m"]]  # type: ignore[union-attr]


def test_seeds_reproduce() -> None:
    simulation = Simulation(scenario_of("pendulum", *SHORT))
    first, other, more = drawn(simulation, 3), drawn(simulation, 4), drawn(simulation, None)
    assert drawn(simulation, 3) == first
    assert len({first[1], other[1], more[1]}) == 3
    assert "eta_d" in simulation.scenario.medium.standing  # type: ignore[union-attr]  # says what was changed
    simulation.reset(seed=3)  # as it was given
    assert simulation.random.random() == np.random.default_rng(3).random()
    assert isinstance(simulation.scenario, Scenario)
    assert simulation.scenario == scenario_of("pendulum", *SHORT)


def test_a_closed_simulation_needs_a_reset() -> None:
    simulation = of("flexible")
    seen = simulation.step(None, 0.01)
    simulation.close()
    assert seen["depth_m"] > 0.0
    with pytest.raises(ControlError, match="closed: reset"):
        simulation.step(None, 0.01)
    simulation.reset()
    assert dict(simulation.step(None, 0.01)) == dict(seen)


def test_a_refused_change_leaves_the_run_unchanged() -> None:
    simulation = of("leg")
    simulation.step(None, 0.01)
    with pytest.raises(ConfigError, match=r"medium.eta_d: got the number -1"):
        simulation.reset(**{"medium.eta_d": -1})
    assert simulation.time == pytest.approx(0.01)
    simulation.step(None, 0.01)


FAULTS = {
    "knee={type: external, torque_Nm: 0, angle_deg: 3}": "exactly one is allowed",
    "knee={type: external}": "got none of",
    "knee={type: external, angle_deg: 3}": "the drive would do nothing",
    "knee={type: external, torque_Nm: 0, gain_Nm_per_rad: 3}": "torque_Nm is set: allowed is nothing",
    "knee={type: external, torque_Nm: 2, range: [-1, 1]}": "allowed is -1 to 1, its range",
    "knee={type: external, torque_Nm: 0, range: [1, -1]}": "allowed are two numbers that grow",
    "knee={type: external, force_N: 0}": "knee is a hinge",
}


@pytest.mark.parametrize("drive", FAULTS)
def test_faults_of_external_drives(drive: str) -> None:
    with pytest.raises(ConfigError, match=FAULTS[drive]):
        scenario_of(LEG, f"drives.{drive}")
