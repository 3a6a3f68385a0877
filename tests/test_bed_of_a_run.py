"""A run's bed: slopes, profiles, floor, container, layers, several media, and the warnings that go with them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support_models import ball
from support_refusals import CONFIG_OR_SCENE, faults_of
from support_runs import scenario_of, scene_of, simulate

from granular_contact.errors import ConfigError
from granular_contact.laws.validity import Validity
from granular_contact.mechanics.observe import depths_by_body
from granular_contact.mechanics.system import System, Trajectory
from granular_contact.results.limits import Reach, warnings
from granular_contact.run import run
from granular_contact.scene import build

HILL = "{from: hill_cylinders, density_kg_m3: 2500}"
ALBERT = "{law: albert, density_kg_m3: 2500, eta_h: 8}"

BALL = ball(
    "medium: {from: glass_beads_katsuragi_durian, stiffness_N_m: 80}",
    "initial: {joints: {flight: {vy_m_s: -1.0}}}",
    "solver: {step_s: 2e-5, end_time_s: 0.06}",
)

PLATE = """
model:
  name: plate
  bodies:
    plate:
      type: rigid
      density_kg_m3: 2700
      shapes: [{type: plate, start_m: [-0.03, 0], end_m: [0.03, 0], width_m: 0.05, thickness_m: 0.005}]
  joints:
    flight: {type: free, parent: ground, child: plate}
medium: poppy_seeds_loose
initial: {joints: {flight: {vy_m_s: -1.0}}}
solver: {step_s: 1e-4, end_time_s: 0.04}
"""


PLATE_END = "end_m: [0.03, 0], width_m: 0.05, thickness_m: 0.005"


def faults_in(text_or_name: str, *overrides: str) -> list[tuple[str, str]]:
    return [(fault.key, fault.message) for fault in faults_of(CONFIG_OR_SCENE, scene_of, text_or_name, *overrides)]


def test_a_sloped_surface_is_touched_at_the_start() -> None:
    scene = scene_of("pendulum", "bed.slope_deg=10")
    x, y = scene.tip_position
    # Round-off of a height at 1 km times the slope.
    assert float(scene.bed.height(np.array([x]))[0]) == pytest.approx(y, abs=1e-12)
    rise = scene.bed.height(np.array([0.0, 0.1]))
    assert rise[1] - rise[0] == pytest.approx(0.1 * math.tan(math.radians(10)), abs=1e-12)


def test_a_level_profile_is_a_level_bed() -> None:
    level = simulate("pendulum_rigid", "surface_height_m=-0.14")
    profile = simulate("pendulum_rigid", "bed.profile_m=[[-1, -0.14], [0.1, -0.14], [2, -0.14]]")
    for key in ("stopping_time_s", "angle_at_stop_deg", "max_depth_m"):
        # The same operations but for the interpolation of a height.
        assert profile.summary[key] == pytest.approx(level.summary[key], rel=1e-9)


def test_rising_ground_stops_the_link_later_and_shallower_in_angle() -> None:
    up, level = simulate("pendulum_rigid", "bed.slope_deg=10"), simulate("pendulum_rigid")
    # The tip moves down and back: where the ground falls away behind it, it meets less sand on its way.
    assert up.summary["angle_at_stop_deg"] > level.summary["angle_at_stop_deg"] + 0.5
    assert up.summary["energy"]["imbalance_relative"] < 1e-3


def test_layers_of_one_medium_are_one_bed() -> None:
    whole = simulate("pendulum_rigid")
    layered = simulate(
        "pendulum_rigid", "bed.layers=[{top_m: 0.004, medium: play_sand}, {top_m: 0.011, medium: play_sand}]"
    )
    # Each strip is integrated exactly, cut or whole, and the bristles of all layers follow alike: what is left is where
    # Newton's iterations end.
    assert layered.summary["stopping_time_s"] == pytest.approx(whole.summary["stopping_time_s"], rel=1e-5)
    assert layered.summary["angle_at_stop_deg"] == pytest.approx(whole.summary["angle_at_stop_deg"], abs=1e-4)
    assert layered.terms[:3] == ("play_sand_1_drag", "play_sand_1_horizontal_static", "play_sand_1_vertical_static")


def test_a_hard_layer_below_a_soft_one_stops_in_between() -> None:
    soft, hard = (simulate("pendulum_rigid", f"medium=poppy_seeds_{name}") for name in ("loose", "close"))
    both = simulate(
        "pendulum_rigid", "medium=poppy_seeds_loose", "bed.layers=[{top_m: 0.02, medium: poppy_seeds_close}]"
    )
    depths = [run.summary["max_depth_m"] for run in (hard, both, soft)]
    assert depths[0] + 1e-3 < depths[1] < depths[2] - 1e-3
    assert both["poppy_seeds_close_static_force_y_N"].max() > 0.1
    assert both.summary["energy"]["imbalance_relative"] < 1e-3


def test_media_add_up() -> None:
    pair = simulate("pendulum_rigid", f"medium=[{ALBERT}, {HILL}]")
    assert pair.terms == ("albert_horizontal_static", "hill_cylinders_vertical_static")
    whole = simulate(
        "pendulum_rigid",
        "medium={law: lee_marghitu, density_kg_m3: 2500, eta_d: 0, eta_h: 8, plunging: {eta_v: 10, lambda: 1.4}, "
        "withdrawing: {eta_v: 0.5, lambda: 1.7}}",
    )
    # The same forces in another order of sums.
    assert pair.summary["stopping_time_s"] == pytest.approx(whole.summary["stopping_time_s"], rel=1e-6)


@pytest.mark.parametrize("medium", ["rft_generic", "rft3d_sand", "{law: drft, lambda: 1.1, density_kg_m3: 1617}"])
def test_resistive_force_theories_stop_the_link_and_hold_it(medium: str) -> None:
    results = simulate("pendulum_rigid", f"medium={medium}")
    assert results.status.code == "rest"
    # Of the trapezoidal work of a force that drops within a step at the stop: of first order in 0.2 ms of 25 ms.
    assert results.summary["energy"]["imbalance_relative"] < 2e-3
    # In the step in which it turns round it gets back what the bristles hold: force times yield displacement at most.
    held = 1e-5 * np.hypot(results["static_force_x_N"], results["static_force_y_N"]).max()
    assert held < 1e-2 * np.ptp(results["granular_work_J"])
    assert (np.diff(results["granular_work_J"]) < held).all()


def test_a_floor_reports_and_carries() -> None:
    free = simulate("pendulum_rigid", "bed.depth_m=0.01")
    assert any("floor was reached" in w and "exerts no force" in w for w in free.warnings)
    floor = "bed={depth_m: 0.01, floor: {stiffness_N_m2: 1e6, damping_s_m: 0.5}}"
    held = simulate("pendulum_rigid", floor, "solver.step_s=5e-5")
    assert held.summary["max_depth_m"] < free.summary["max_depth_m"] - 1e-3
    assert held["floor_force_y_N"].max() > 5.0
    # The spring of the floor is in its work, which the balance counts by itself.
    assert held.summary["energy"]["imbalance_relative"] < 1e-3
    assert held["floor_work_J"].min() < -1e-4
    assert any("its contact carried" in w for w in held.warnings)


def test_a_container_reports_its_walls() -> None:
    results = simulate("pendulum_rigid", "bed.container_x_m=[0.0, 0.2]")
    (warning,) = [w for w in results.warnings if "container" in w]
    assert "right wall of the container was passed by" in warning


def test_walls_are_met_by_the_sides_of_balls_and_round_bars() -> None:
    ball = simulate(BALL, "bed.container_x_m=[-0.01, 0.0127]")
    (warning,) = [w for w in ball.warnings if "container" in w]
    # Its radius beyond the left wall, and no more than round-off beyond the right one.
    assert "left wall of the container was passed by 0.0027 m" in warning
    round_bar = "end_m: [0.03, 0], diameter_m: 0.01"
    bar = PLATE.replace("type: plate", "type: cylinder").replace(PLATE_END, round_bar)
    walls = "bed={height_m: 0.01, container_x_m: [-0.03, 0.03]}"
    assert not [w for w in simulate(bar, walls, "solver.end_time_s=0.001").warnings if "container" in w]
    upright = bar.replace("[-0.03, 0]", "[0, -0.03]").replace("[0.03, 0]", "[0, 0.03]")
    hit = simulate(upright, "bed={height_m: 0.01, container_x_m: [-0.004, 0.006]}", "solver.end_time_s=0.001")
    (warning,) = [w for w in hit.warnings if "container" in w]
    assert "left wall of the container was passed by 0.001 m" in warning


@pytest.mark.parametrize("method", ["engine: {}", "reduced: {modes: 0}", "minimal: {}"])
def test_walls_are_the_same_for_every_method(method: str) -> None:
    wall = "bed.container_x_m=[0.0, 0.2]"
    results = simulate("pendulum_rigid", wall, *([] if method.startswith("engine") else [f"method={{{method}}}"]))
    (warning,) = [w for w in results.warnings if "container" in w]
    immersed = results["depth_m"] > 0
    # The tip is the farthest right; the bar, whose axis runs through the pivot, is 6.35 mm thick. Four digits are told.
    x, y = (results[f"tip_{axis}_m"][immersed] for axis in "xy")
    beyond = float((x + 0.5 * 0.00635 * np.abs(y) / np.hypot(x, y)).max()) - 0.2
    assert float(warning.split("passed by ")[1].split(" m")[0]) == pytest.approx(beyond, rel=5e-4)


def test_leaving_the_range_says_by_how_much() -> None:
    fast = simulate("pendulum_rigid", "initial.impact_speed_rad_s=11")
    (warning,) = fast.warnings
    speed = 11 * 0.263525  # from the pivot to the tip, at the touch
    assert "play_sand" in warning
    assert f"is {speed / 2.51:.2f} times the greatest stated, 2.51 m/s" in warning
    assert not simulate("pendulum_rigid").warnings
    reduced = simulate("pendulum_rigid", "initial.impact_speed_rad_s=11", "method={reduced: {modes: 0}}")
    (same,) = reduced.warnings
    assert f"is {speed / 2.51:.2f} times the greatest stated" in same


def test_validity_counts_both_ends_of_sizes() -> None:
    validity = Validity(speed=(0.5, 1.0), size=(0.01, 0.02))
    assert list(validity.departures(0.9, 5.0, (0.01, 0.02))) == []
    small, large = validity.departures(0.9, 0.0, (0.005, 0.03))
    assert "0.005 m below the least stated, 0.01 m" in small
    assert "1.50 times the greatest stated, 0.02 m" in large


def test_a_run_that_never_came_up_to_the_range_is_reported() -> None:
    slow = Validity(speed=(0.5, 1.0), depth=(0.02, 0.05))
    speed, depth = slow.departures(0.1, 0.005, ())
    assert speed == "speed 0.1 m/s is 0.4 m/s below the least stated, 0.5 m/s"
    assert depth == "depth 0.005 m is 0.015 m below the least stated, 0.02 m"
    assert list(slow.departures(0.5, 0.02, ())) == []


def test_bodies_within_the_bed_give_no_warning() -> None:
    scene = scene_of("pendulum", "bed={depth_m: 0.05, container_x_m: [-1, 1]}")
    reach = Reach(1.0, 0.01, -0.15, (0.1,), (0.3,), (("round", 0.00635),))
    assert list(warnings(scene, reach, None, None)) == []


def test_a_ball_falls_as_the_closed_form_says() -> None:
    results = simulate(BALL)
    d = 0.0254
    mass, k, d1, g = 7700 * math.pi / 6 * d**3, 80.0, 3.4 * d, 9.81
    # m v v' = m g - k z - (m / d1) v^2 is linear in v^2; the depth where it comes to zero, by bisection.
    a = 2 / d1
    slope = -2 * k / mass / a
    level = (2 * g - slope) / a
    low, high = 0.0, 0.1
    for _ in range(60):
        z = 0.5 * (low + high)
        low, high = (z, high) if level + slope * z + (1.0 - level) * math.exp(-a * z) > 0 else (low, z)
    # The drag sets in over 25 um and the bristle over 10 um: some 20 um of 31 mm.
    assert results.summary["max_depth_m"] == pytest.approx(low, abs=3e-5)
    assert low > 0.03
    assert results.terms == ("static", "inertial")


def test_faulty_beds_are_refused() -> None:
    ((key, message),) = faults_in("pendulum", "medium={law: bingham, yield_force_N: 1, viscosity_N_s_m: 1}")
    assert key == "model.bodies.link"
    assert "lee_marghitu, albert, hill, rft, drft, rft3d" in message
    assert faults_in("pendulum", "medium=hill_cylinders")[0][0] == "medium.density_kg_m3"
    assert faults_in("pendulum", "medium=[play_sand, {from: hill_cylinders}]")[0][0] == "medium.1.density_kg_m3"
    assert faults_in("pendulum", "bed={depth_m: 0.01, slope_deg: -20}")[0][0] == "bed.depth_m"
    assert (
        faults_in("pendulum", "bed.layers=[{top_m: 0.01, medium: play_sand}]", "load.form=resultant")[0][0]
        == "load.form"
    )
    assert faults_in("pendulum", "bed.slope_deg=5", "method=reduced")[0][0] == "method"
    assert faults_in(BALL, "bed.layers=[{top_m: 0.01, medium: rft_generic}]")[0][0] == "bed.layers"


def test_every_depth_needs_a_law_for_the_bodies_that_reach_it() -> None:
    ((key, message),) = faults_in(PLATE, "bed.layers=[{top_m: 0.005, medium: play_sand}]")
    assert key == "bed.layers.0.medium"
    assert "plate can get that deep, but play_sand takes round bars" in message
    assert "laws for plates (plate, arc or polyline with a width) are rft, drft, rft3d" in message
    # What can't get to a layer need not fit it: this link hangs 0.28 m down at the most, 0.14 m below the surface.
    law = "{law: linear_depth, stiffness_N_m: 1}"
    for config in ("pendulum_rigid", "pendulum"):
        scene_of(config, "surface_height_m=-0.14", f"bed.layers=[{{top_m: 0.145, medium: {law}}}]")
        assert faults_in(config, "surface_height_m=-0.14", f"bed.layers=[{{top_m: 0.1, medium: {law}}}]")


def test_a_medium_that_takes_nothing_of_the_mechanism_is_refused() -> None:
    ((key, message),) = faults_in(PLATE, "medium=[poppy_seeds_loose, play_sand]")
    assert key == "medium.1"
    assert "play_sand takes round bars" in message
    assert "laws for plates (plate, arc or polyline with a width) are rft, drft, rft3d" in message
    # One for each kind of shape is what lists of media are for.
    ball = "{type: sphere, center_m: [0, -0.02], diameter_m: 0.01}"
    both = PLATE.replace("shapes: [", f"shapes: [{ball}, ")
    scene_of(both, "medium=[poppy_seeds_loose, {law: linear_depth, stiffness_N_m: 1}]")


def test_a_medium_is_judged_by_what_it_met() -> None:
    bar = "{type: cylinder, start_m: [0, 0], end_m: [0, 0.01], diameter_m: 0.00635}"
    scene = scene_of(PLATE.replace("shapes: [", f"shapes: [{bar}, "), "medium=[poppy_seeds_loose, play_sand]")
    reach = Reach(1.0, 0.01, -0.15, (0.1,), (0.3,), (("flat", 0.05), ("round", 0.00635)))
    assert list(warnings(scene, reach, None, None)) == []
    (warning,) = warnings(scene, replace(reach, sizes=(*reach.sizes, ("round", 0.0127))), None, None)
    assert "size 0.0127 m is 2.00 times the greatest stated" in warning
    fast = replace(reach, speed=5.0)
    assert len(list(warnings(scene, fast, None, None))) == 1
    assert list(warnings(scene, replace(fast, sizes=(("flat", 0.05),)), None, None)) == []
    deep = scene_of("pendulum_rigid", "medium=rft_generic", "bed.layers=[{top_m: 0.02, medium: play_sand}]")
    assert list(warnings(deep, fast, None, None)) == []


def test_only_laws_that_have_a_resultant_take_its_form() -> None:
    for medium in ("rft_generic", "rft3d_sand", "[play_sand, rft_generic]"):
        ((key, message),) = faults_in("pendulum_rigid", f"medium={medium}", "load.form=resultant")
        assert key == "load.form"
        assert "laws with one are lee_marghitu, albert, hill" in message
    scene = scene_of("pendulum_rigid", f"medium=[play_sand, {ALBERT}, {HILL}]", "load.form=resultant")
    assert scene.load.form == "resultant"


FLOOR = "bed={depth_m: 0.05, floor: {stiffness_N_m2: 1e6, damping_s_m: 1}}"


def test_a_floor_without_a_medium_is_refused() -> None:
    ((key, message),) = faults_in(PLATE, "medium=null", FLOOR)
    assert key == "bed.depth_m"
    assert "a bed needs one" in message
    assert faults_in(PLATE, "medium=null", "bed.container_x_m=[-1, 1]")[0][0] == "bed.container_x_m"
    # What the message names in its place: the plate falls freely to the floor, which carries.
    bare = simulate(PLATE, "medium={from: rft_generic, zeta: 1e-9}", FLOOR, "solver.end_time_s=0.06")
    # m v^2 = k delta^2 with 40.5 g at 1.41 m/s and 60 kN/m: 1.16 mm, less by the damping.
    assert 0.05 < bare.summary["max_depth_m"] < 0.0512
    assert any("floor was reached" in warning for warning in bare.warnings)


def test_a_floor_lies_below_all_of_a_profile() -> None:
    profile = "bed={profile_m: [[-0.1, 0], [0.1, 0], [0.2, -0.06]], depth_m: 0.05}"
    ((key, message),) = faults_in(PLATE, profile)
    assert key == "bed.depth_m"
    assert "the corner [0.2, -0.06]" in message
    assert scene_of(PLATE, profile.replace("0.05}", "0.07}")).bed.floor.height == -0.07


def test_a_plate_meets_a_peak_between_its_corners() -> None:
    peak = "bed.profile_m=[[-0.02, -0.03], [0, 0], [0.02, -0.03]]"
    run = simulate(PLATE, peak, "initial={joints: {flight: {y_m: 0.01, vy_m_s: -1.0}}}", "solver.end_time_s=0.02")
    # Its middle, a station, falls 10 mm at 1 m/s and a little more; its corners stay above the ground beside.
    fall = (math.sqrt(1.0 + 2 * 9.81 * 0.01) - 1.0) / 9.81
    # Between the depths of two steps, 0.1 ms apart, the touch is on their chord: g h^2 / 8 of 1 m/s, 12 ns.
    assert run.summary["touch_time_s"] == pytest.approx(fall, abs=2e-8)
    assert 0.001 < run.summary["max_depth_m"] < 0.03
    laid = simulate(PLATE, peak, "initial={joints: {flight: {y_m: -0.01}}}", "solver.end_time_s=0.001")
    assert any("the mechanism starts 0.01 m below the surface" in warning for warning in laid.warnings)


def test_an_arc_on_a_slope_has_few_points_whose_depth_is_kept() -> None:
    """Its sides are short, so there are no points between its corners: a run of many steps keeps a row for each."""
    arc = "{type: arc, radius_m: 0.05, from_deg: 0, to_deg: 180, width_m: 0.05, thickness_m: 0.005}"
    plate = "{type: plate, start_m: [-0.03, 0], end_m: [0.03, 0], width_m: 0.05, thickness_m: 0.005}"
    counts = {}

    def count(system: System, trajectory: Trajectory) -> None:
        shape = system.scene.rigid[0].shapes[0]
        (counts[len(shape.points)],) = map(len, depths_by_body(system.kinematics(trajectory)).values())

    for text in (PLATE, PLATE.replace(plate, arc)):
        sloped = ["bed={slope_deg: 5, height_m: -0.1}", "solver={step_s: 1e-3, end_time_s: 0.01}"]
        run(build(scenario_of(text, *sloped)), inspect=count)
    straight, curved = sorted(counts)
    assert (straight, counts[straight]) == (2, 17)
    assert counts[curved] <= curved + 17


def test_a_slope_that_ran_into_its_floor_is_reported() -> None:
    scene = scene_of(PLATE, "bed={slope_deg: 10, height_m: 0, depth_m: 0.05}")
    # The slope comes to the floor at 0.05 m / tan 10 deg to the left.
    end = -0.05 / math.tan(math.radians(10))
    reach = Reach(1.0, 0.01, -0.01, (end + 0.001,), (0.1,), (("flat", 0.05),))
    assert list(warnings(scene, reach, None, None)) == []
    (warning,) = warnings(scene, replace(reach, least=(end - 0.1,)), None, None)
    assert f"{0.1 * math.tan(math.radians(10)):.4g} m below the floor" in warning


@pytest.mark.parametrize(
    ("override", "key", "message"),
    [
        (
            "bed={depth_m: 0.01, layers: [{top_m: 0.02, medium: play_sand}]}",
            "bed.layers.0.top_m",
            "got 0.02, but the floor is at 0.01",
        ),
        ("bed={profile_m: [[0, 0], [0, 1]]}", "bed.profile_m.1.0", "must rise"),
        ("bed={profile_m: [[0, 0]]}", "bed.profile_m", "got a list of 1 item; allowed is a list of 2 items or more"),
        ("bed={profile_m: [[0, .nan], [1, 0]]}", "bed.profile_m.0.1", "allowed is a finite number"),
        ("bed={profile_m: [[0, 0], [1, 0], [2, -2]]}", "bed.profile_m.2", "got -63.43 deg up to this corner"),
        ("bed={profile_m: [[0, 0], [1, 1]], slope_deg: 3}", "bed.profile_m", "one of the two"),
        ("bed={floor: {stiffness_N_m2: 1e5}}", "bed.floor", "needs depth_m"),
        ("bed={container_x_m: [1, 0]}", "bed.container_x_m", "left of"),
        (
            "bed={layers: [{top_m: 0.02, medium: play_sand}, {top_m: 0.01, medium: play_sand}]}",
            "bed.layers.1.top_m",
            "not below the layer above",
        ),
        ("bed={layers: [{top_m: 0.02, medium: play_sandd}]}", "medium", "did you mean play_sand?"),
        ("medium=[play_sand, {law: rft, zeta: -1}]", "medium.1.zeta", "above 0"),
        ("medium={law: katsuragi_durian, stiffness_N_m: 1}", "medium", "neither of drag_length_m"),
        ("medium={from: play_sand, range: {speed_m_s: [2, 1]}}", "medium.range.speed_m_s", "must not exceed"),
        ("medium=[]", "medium", "a list of one item or more"),
    ],
)
def test_faults_of_beds_and_media_stand_at_their_keys(override: str, key: str, message: str) -> None:
    (fault,) = faults_of(ConfigError, scenario_of, "pendulum", override)
    assert fault.key == key
    assert message in fault.message


def test_two_heights_of_one_surface_are_refused() -> None:
    with pytest.raises(ConfigError, match="one height of the surface is allowed"):
        scenario_of("pendulum", "surface_height_m=-0.2", "bed.height_m=-0.2")


def test_work_of_a_settled_run_starts_at_zero() -> None:
    floor = "bed={depth_m: 0.002, floor: {stiffness_N_m2: 1e5, damping_s_m: 5}}"
    settled = simulate(BALL, "initial={settle: true, joints: {flight: {y_m: 0.0}}}", floor, "solver.end_time_s=0.001")
    work = settled["floor_work_J"]
    assert len(work) == len(settled["time_s"])
    # It rests: a force of the weight, 0.66 N, over less than a micrometre.
    assert work[0] == 0.0
    assert np.abs(work).max() < 1e-6
