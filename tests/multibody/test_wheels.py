"""Wheels: their shape, their rig, their summary, and the surface behind them."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from support_runs import order, scenario_of, scene_of, simulate

from granular_contact.config.schema import shapes
from granular_contact.config.schema.shapes import Grousers
from granular_contact.errors import ConfigError
from granular_contact.geometry.polygon import crossing, doubled_area
from granular_contact.laws.drft import Drft
from granular_contact.laws.rft import GENERIC
from granular_contact.results import Results
from granular_contact.sand.contact_lines import Body, outline
from granular_contact.sand.kernels.wheels import ROUND
from granular_contact.sand.load import GranularLoad
from granular_contact.scene.shapes import build_shape

# Shapes, surfaces, scatter and numbers of the summary, which methods share; `test_a_wheel_begins_and_stays_steady` and
# those of drives run by both.
BY_ONE = (
    "test_a_smooth_wheel_is_a_disc",
    "test_grousers_are_teeth",
    "test_summary_of_a_wheel_holds_slip_load_and_sinkage",
    "test_a_rolling_disc_is_as_round_as_one_of_256_strips",
    "test_grousers_pull",
    "test_faults_of_a_wheel",
    "test_behind_a_turning_wheel_the_surface_is_lowered",
    "test_scatter_leaves_the_order_in_the_step_as_it_is",
    "test_slip_pull_load_and_sinkage_are_along_and_across_a_slope",
    "test_driven_wheel_without_shear_deformation_modulus_has_a_note",
    "test_run_starts_within_the_range_of_the_medium",
    "test_a_wheel_that_still_sinks_is_reported",
)
SURFACE = "initial.joints={post: {position_m: 0}}"  # from where a wheel sinks by its dynamics
QUICK = ("load.strips_per_rigid_part=12", "solver={step_s: 4e-3, end_time_s: 1.2}", "wheel.speed_m_s=0.05")


def test_a_smooth_wheel_is_a_disc() -> None:
    wheel = shapes.WheelShape(type="wheel", radius_m=0.05, width_m=0.04, center_m=(0.01, 0.0))
    disc = shapes.DiscShape(type="disc", diameter_m=0.1, thickness_m=0.04, center_m=(0.01, 0.0))
    (of_wheel, mass), (other, of_disc) = build_shape("part", wheel, 16), build_shape("part", disc, 16)
    np.testing.assert_allclose(of_wheel.points, other.points, atol=1e-15)
    np.testing.assert_allclose(of_wheel.turns, other.turns)
    assert (mass.mass, mass.inertia) == pytest.approx((of_disc.mass, of_disc.inertia))


def test_grousers_are_teeth() -> None:
    teeth = Grousers(count=9, height_m=0.012, thickness_m=0.004)
    shape, mass = build_shape("part", shapes.WheelShape(type="wheel", radius_m=0.05, width_m=0.04, grousers=teeth), 32)
    sides = [tuple(point) for point in shape.points[:-1]]
    assert crossing(sides) is None
    assert len(shape.turns) == len(shape.points) - 1
    assert sum(shape.turns) == pytest.approx(2 * math.pi - 9 * 2 * math.asin(0.002 / 0.05))
    far = np.hypot(*shape.points[:-1].T)
    assert (far > 0.0619).sum() == 18  # two corners each, 0.002 beside the middle of the tooth
    assert far.min() == pytest.approx(0.05)
    # Chords of arcs lose R^2 (w - sin w) / 2 each; the teeth stand on theirs.
    chords = [w for w in shape.turns if w > 0.0]
    lost = sum(0.5 * 0.05**2 * (w - math.sin(w)) for w in chords)
    foot = 0.5 * 0.05**2 * (2 * math.asin(0.04) - math.sin(2 * math.asin(0.04)))  # of the rim, that a tooth covers
    sunk = (0.05 - math.sqrt(0.05**2 - 0.002**2)) * 0.004
    area = 0.5 * abs(doubled_area(sides)) + lost
    assert mass.mass / 0.04 == pytest.approx(area + 9 * (foot - sunk), rel=1e-6)
    assert shape.wheel is not None
    assert shape.wheel.radius == pytest.approx(0.05 + 0.004)


@pytest.mark.slow
def test_the_run_of_a_wheel_is_that_of_its_drives() -> None:
    short = simulate("wheel", *QUICK, SURFACE)
    rate, speed = 0.05 / 0.8 / 0.058, 0.05
    table = "type: table, interpolation: linear, time_s: [0, 2.4], values"
    drives = (
        f"drives={{rail: {{type: motion, position_m: {{{table}: [0, {2.4 * speed!r}]}}}}, "
        f"axle: {{type: motion, angle_deg: {{{table}: [0, {math.degrees(2.4 * rate)!r}]}}}}, "
        f"post: {{type: force, force_N: {-(24 - 9.81 * 1.5)!r}}}}}"
    )
    long = simulate("wheel", *QUICK[:2], "wheel=null", drives)
    for name in ("post_position_m", "axle_torque_Nm", "wheel_slip"):
        np.testing.assert_allclose(short[name], long[name], rtol=1e-6, atol=1e-9)  # the steps of Newton's method


def test_summary_of_a_wheel_holds_slip_load_and_sinkage() -> None:
    for slip in (-1.0, 0.2, 0.6):
        run = simulate("wheel", *QUICK, f"wheel.slip={slip}")
        summary = run.summary["wheel"]
        assert summary["slip"] == pytest.approx(slip, abs=1e-9)
        np.testing.assert_allclose(run["wheel_slip"], slip, atol=1e-9)
        # The damper of the guide carries what it takes to sink.
        np.testing.assert_allclose(run["wheel_load_N"][50:], 24.0 + 130.0 * run["post_speed_m_s"][50:], atol=0.2)
        assert summary["sinkage_m"] == pytest.approx(run["depth_m"][150:].mean(), rel=5e-3)
        # Nothing is accelerated but the hub, slowly: pull and torque are those of the drives.
        np.testing.assert_allclose(run["wheel_drawbar_pull_N"][50:], -run["rail_force_N"][50:], atol=0.02)
        np.testing.assert_allclose(run["wheel_torque_Nm"][50:], run["axle_torque_Nm"][50:], atol=2e-3)
    locked, rolling, spinning = (
        simulate("wheel", *QUICK, f"wheel.slip={s}").summary["wheel"] for s in (-1.0, 0.2, 0.6)
    )
    assert locked["drawbar_pull_N"] < -10.0 < rolling["drawbar_pull_N"]
    assert locked["torque_Nm"] < 0.0 < rolling["torque_Nm"]
    assert locked["efficiency"] is None
    assert rolling["sinkage_m"] < min(locked["sinkage_m"], spinning["sinkage_m"])


ROLLING = """
model:
  name: rolling
  bodies:
    carriage: {type: rigid, mass_kg: 0.5, inertia_kg_m2: 1.0e-3}
    disc: {type: rigid, density_kg_m3: 2700, shapes: [{type: disc, diameter_m: 0.1, thickness_m: 0.04}]}
  joints:
    rail: {type: slider, parent: ground, child: carriage}
    axle: {type: hinge, parent: carriage, child: disc}
bed: {height_m: -0.04}
drives:
  rail: {type: motion, position_m: {type: table, interpolation: linear, time_s: [0, 10], values: [0, 0.4]}}
  axle: {type: motion, angle_deg: {type: table, interpolation: linear, time_s: [0, 10], values: [0, 572.9578]}}
output: {bodies: all}
solver: {end_time_s: 1.5, step_s: 5.0e-3}
"""


@pytest.mark.slow
@pytest.mark.parametrize("medium", ["rft_generic", "poppy_seeds_close", "rft3d_sand"])
def test_a_rolling_disc_is_as_round_as_one_of_256_strips(medium: str) -> None:
    """At 20 % slip push and pull all but cancel; the mean of the rest was 20 % off, and its ripple four times that."""
    default, fine = (simulate(ROLLING, f"medium={medium}", *more) for more in ((), ("load.strips_per_rigid_part=256",)))
    pull, fine_pull = default["disc_granular_x_N"][100:], fine["disc_granular_x_N"][100:]
    load = float(fine["disc_granular_y_N"][100:].mean())
    assert pull.mean() == pytest.approx(fine_pull.mean(), rel=0.02)  # 1.3 % of a force that is a thousandth of the load
    assert abs(pull.mean() - fine_pull.mean()) < 1e-4 * load
    assert np.ptp(pull) < 1e-3 * load
    assert np.ptp(pull) < abs(pull.mean())


def test_grousers_pull() -> None:
    grousers = "model.bodies.wheel.shapes.0.grousers={count: 12, height_m: 0.01, thickness_m: 0.003}"
    smooth = simulate("wheel", *QUICK).summary["wheel"]
    toothed = simulate("wheel", *QUICK, grousers)
    summary = toothed.summary["wheel"]
    assert summary["slip"] == pytest.approx(0.2, abs=1e-9)  # by the radius with a third of the grousers
    assert summary["drawbar_pull_N"] > smooth["drawbar_pull_N"] + 1.0
    assert 0.0 < summary["efficiency"] < 1.0
    assert np.ptp(toothed["wheel_drawbar_pull_N"][150:]) > 0.2  # one after the other


@pytest.mark.slow
def test_a_torque_drives_and_a_pull_holds_back() -> None:
    wheel = "wheel={torque_Nm: 0.3, pull_N: 2, load_N: 30}"
    run = simulate("wheel", QUICK[0], "solver={step_s: 2e-3, end_time_s: 1}", wheel)
    time, speed, rate = run["time_s"], run["rail_speed_m_s"], run["axle_rate_rad_s"]
    np.testing.assert_array_equal(run["axle_torque_Nm"], 0.3)
    assert np.ptp(speed) > 0.01
    # Momentum of 2 kg along the rail and of 2e-3 kg m2 about the axle; trapezia of what jumps with the first contact.
    push = np.trapezoid(run["wheel_granular_x_N"] - 2.0, time)
    assert 2.0 * speed[-1] == pytest.approx(push, abs=0.02)
    assert 2e-3 * rate[-1] == pytest.approx(np.trapezoid(0.3 - run["wheel_torque_Nm"], time), abs=2e-3)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("wheel.torque_Nm=1", "wheel: got both of slip and torque_Nm; exactly one is allowed"),
        ("wheel.slip=1", "wheel.slip: got the number 1; allowed is a finite number from -1 to below 1"),
        ("wheel.speed_m_s=null", "wheel.speed_m_s: is missing; a given slip needs the speed of the axle"),
        ("wheel.pull_N=3", "wheel.pull_N: got 3, but the slip is given: allowed is 0"),
        ("model=dragged_plate", "wheel: stands beside the model dragged_plate, which has no shape of the type wheel"),
        ("drives={rail: {type: force, force_N: 1}}", "drives.rail: stands beside wheel, which drives this joint"),
        (
            "model.bodies.wheel.shapes.0.grousers={count: 100, height_m: 0.01, thickness_m: 0.01}",
            "grousers.thickness_m: got 0.01; allowed is at most 0.00328",
        ),
        ("medium.scatter={relative: 0.6, length_m: 0.003}", "medium.scatter.relative: got the number 0.6"),
    ],
)
def test_faults_of_a_wheel(override: str, message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        scenario_of("wheel", override)
    assert any(message in str(fault) for fault in caught.value.faults), caught.value


def test_behind_a_turning_wheel_the_surface_is_lowered() -> None:
    radius, omega, place = 0.06, -9.0, np.array([0.3, 0.035, 0.4])
    drop = (radius * omega) ** 2 / 9.81
    circle = radius * np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0.0, 2 * math.pi, 65)])
    circle[-1] = circle[0]
    speed = np.array([0.25, -0.02, omega])

    def force(medium: Drft, surface: object, spin: float, wheel: bool) -> np.ndarray:
        load = GranularLoad(medium, surface)  # type: ignore[arg-type]
        load.add(outline(Body("wheel", [0, 1, 2]), circle, 0.04, wheel=(np.zeros(2), radius) if wheel else None))
        load.start(place)
        return load.force(place, speed * (1.0, 1.0, spin), np.zeros(3))

    dynamic, half = Drft(GENERIC, 900.0, 1.1), 0.5 * ROUND * radius
    for spin in (1.0, -1.0):  # rolls to the right, then to the left
        ends = (place[0] - half, place[0] + half)
        heights = (-drop, 0.0) if spin > 0 else (0.0, -drop)
        lowered = [*zip(ends, heights, strict=True)]
        lowered = [(-9.0, heights[0]), *lowered, (9.0, heights[1])]
        got = force(dynamic, 0.0, spin, wheel=True)
        want = force(Drft(GENERIC, 900.0, 1.1, wheel_drop=0.0), np.array(lowered), spin, wheel=True)
        np.testing.assert_allclose(got, want, rtol=1e-10)
        flat = force(dynamic, 0.0, spin, wheel=False)
        assert np.abs(got - flat).max() > 0.05 * np.abs(flat).max()


def test_scatter_leaves_the_order_in_the_step_as_it_is() -> None:
    steps, orders = [8e-4, 4e-4, 2e-4, 1e-4], []
    for scatter in ("null", "{relative: 0.4, length_m: 0.003, seed: 7}"):
        angles = []
        for step in (*steps, 6.25e-6):
            run = simulate(
                "pendulum_rigid", f"medium.scatter={scatter}", f"solver={{step_s: {step}, end_time_s: 0.02}}"
            )
            angles.append(run["pivot_angle_deg"][-1])
        orders.append(order(steps, list(np.abs(np.array(angles[:-1]) - angles[-1]))))
    assert orders[1] > 1.6  # entry of the strips and the first motion of bristles take it below 2
    assert abs(orders[0] - orders[1]) < 0.2


def test_zero_scatter_changes_no_bit() -> None:
    plain = simulate("pendulum")
    zero = simulate("pendulum", "medium.scatter={relative: 0, length_m: 0.003}")
    np.testing.assert_array_equal(plain.table, zero.table)
    scattered = simulate("pendulum", "medium.scatter={relative: 0.2, length_m: 0.003}")
    assert scattered.summary["energy"]["imbalance_relative"] < 1e-4
    assert abs(scattered.summary["stopping_time_s"] - plain.summary["stopping_time_s"]) > 1e-5


UPHILL = """
model:
  name: uphill
  bodies:
    carriage: {{type: rigid, mass_kg: 0.5, inertia_kg_m2: 1.0e-3}}
    hub: {{type: rigid, mass_kg: 0.5, inertia_kg_m2: 1.0e-3}}
    disc: {{type: rigid, mass_kg: 1, inertia_kg_m2: 2.0e-3, shapes: [{{type: wheel, radius_m: 0.06, width_m: 0.05}}]}}
  joints:
    rail: {{type: slider, parent: ground, child: carriage, axis: [{c}, {s}]}}
    post: {{type: slider, parent: carriage, child: hub, axis: [{minus_s}, {c}]}}
    axle: {{type: hinge, parent: hub, child: disc}}
medium: cmu_dry_sand
bed: {{slope_deg: {slope}, height_m: {height}}}
drives:
  rail: {{type: motion, position_m: {{type: table, interpolation: linear, time_s: [0, 10], values: [0, {way}]}}}}
  post: {{type: motion, position_m: {{type: constant, value: 0}}}}
  axle: {{type: motion, angle_deg: {{type: table, interpolation: linear, time_s: [0, 10], values: [0, 572.9578]}}}}
solver: {{end_time_s: 0.2, step_s: 5.0e-3}}
"""


@pytest.mark.slow
@pytest.mark.parametrize(("slope", "slip"), [(25.0, 0.2), (-18.0, 0.6), (25.0, -0.4)])
def test_slip_pull_load_and_sinkage_are_along_and_across_a_slope(slope: float, slip: float) -> None:
    c, s = math.cos(math.radians(slope)), math.sin(math.radians(slope))
    way = 0.6 * (1.0 - slip) if slip >= 0.0 else 0.6 / (1.0 + slip)  # in the time in which the rim goes 0.6 m
    sunk = 0.015
    run = simulate(UPHILL.format(c=c, s=s, minus_s=-s, slope=slope, way=way, height=(sunk - 0.06) / c))
    summary = run.summary["wheel"]
    assert summary["slip"] == pytest.approx(slip, abs=1e-6)  # the digits of its angle
    assert summary["sinkage_m"] == pytest.approx(sunk, abs=1e-9)
    # What holds it bears the rest of its weight: 2 kg along the slope, 1.5 kg across. Nothing is accelerated.
    weight = 9.81
    np.testing.assert_allclose(run["disc_drawbar_pull_N"][10:], -run["rail_force_N"][10:] + 2.0 * weight * s, atol=1e-3)
    np.testing.assert_allclose(run["disc_load_N"][10:], -run["post_force_N"][10:] + 1.5 * weight * c, atol=1e-3)


def test_driven_wheel_without_shear_deformation_modulus_has_a_note() -> None:
    def warned(*overrides: str) -> bool:
        return any("shear_deformation_modulus_m: is 0" in str(note) for note in scene_of(*overrides).notes)

    assert warned("wheel", "medium=cmu_dry_sand_plate")
    assert warned("wheel", "medium=cmu_dry_sand_plate", "wheel={torque_Nm: 0.2, load_N: 24}")
    assert not warned("wheel", "medium=cmu_dry_sand_plate", "wheel.slip=-0.2")
    assert not warned("wheel", "medium=cmu_dry_sand_bekker")
    assert not warned("wheel")
    uphill = UPHILL.format(c=1.0, s=0.0, minus_s=0.0, slope=0.0, way=0.1, height=0.0)
    assert warned(uphill, "medium=cmu_dry_sand_plate")


STEADY = ("load.strips_per_rigid_part=24", "solver={accuracy: 1.0e-2, end_time_s: 1.5}")
GROUSERS = "model.bodies.wheel.shapes.0.grousers={count: 16, height_m: 0.008, thickness_m: 0.003}"


@cache
def sunk_from_the_surface(*overrides: str) -> Results:
    """After 40 s of sinking, in which the damper of the guide came to rest."""
    return simulate("wheel", *STEADY, *overrides, SURFACE, "solver.end_time_s=40", "method=minimal")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("slip", "more"),
    [
        (-0.5, ()),
        (0.0, ("load.strips_per_rigid_part=128",)),  # as short as they get: of the short run they are chosen shorter
        (0.9, ()),
        (-0.2, ("medium=cmu_dry_sand_bekker",)),
        (0.5, (GROUSERS, "wheel.speed_m_s=0.05")),
    ],
)
def test_a_wheel_begins_and_stays_steady(slip: float, more: tuple[str, ...], request: pytest.FixtureRequest) -> None:
    if "engine" in request.node.name and slip not in (-0.5, 0.5):
        pytest.skip("by the engine two of them are enough: how it begins is found before either method starts")
    given = (f"wheel.slip={slip}", *more)
    short, long = simulate("wheel", *STEADY, *given), sunk_from_the_surface(*given)
    summary, expected = short.summary["wheel"], long.summary["wheel"]
    assert summary["sinkage_m"] == pytest.approx(expected["sinkage_m"], rel=0.01)  # what is asked for
    assert summary["drawbar_pull_N"] == pytest.approx(expected["drawbar_pull_N"], abs=0.01 * 24.0)
    assert abs(summary["sinkage_change"]) < 5e-3
    assert abs(summary["pull_change_over_load"]) < 5e-3
    assert not [warning for warning in short.warnings if "steady" in warning or "mechanism starts" in warning]
    # All is there from the start: bristles are stretched, the medium is sheared. Grousers come one after the other, and
    # where the lowest point rests strips do (15 degrees each).
    ripple = 0.1 if GROUSERS in more else 0.05 if slip == 0.0 else 0.015
    assert short["wheel_load_N"][0] == pytest.approx(24.0, rel=ripple)
    assert short["wheel_drawbar_pull_N"][0] == pytest.approx(expected["drawbar_pull_N"], abs=24.0 * ripple)


def test_run_starts_within_the_range_of_the_medium() -> None:
    """From the surface it dropped at 0.16 m/s, with which every run was warned of."""
    assert not any("outside the range" in warning for warning in simulate("wheel", *STEADY).warnings)
    assert any("outside the range" in warning for warning in simulate("wheel", *STEADY, SURFACE).warnings)


def test_a_wheel_that_still_sinks_is_reported() -> None:
    run = simulate("wheel", *STEADY, "wheel.slip=0.75", SURFACE)
    summary = run.summary["wheel"]
    (warning,) = [warning for warning in run.warnings if "not steady" in warning]
    assert f"sinkage changed by {100 * summary['sinkage_change']:.1f}%" in warning
    # By the columns themselves; the path is the time, as the axle goes at one speed.
    early, late = ((a < run["time_s"]) & (run["time_s"] < b) for a, b in ((0.75, 1.125), (1.125, 1.5)))
    time = run["time_s"]
    means = [np.trapezoid(run["wheel_sinkage_m"][k], time[k]) / np.ptp(time[k]) for k in (early, late)]
    assert summary["sinkage_change"] == pytest.approx((means[1] - means[0]) / np.mean(means), rel=0.05)
    heavy = simulate("wheel", *STEADY, "wheel.load_N=1e5", "solver.end_time_s=0.01")
    assert any("are borne at no depth" in warning for warning in heavy.warnings)


def test_a_wheel_that_a_torque_drives_begins_in_static_balance() -> None:
    run = simulate("wheel", *STEADY, "wheel={torque_Nm: 0.0, load_N: 24}", "solver.end_time_s=0.2")
    assert run["wheel_load_N"][0] == pytest.approx(24.0, rel=1e-3)
    assert np.ptp(run["wheel_sinkage_m"]) < 2e-5  # two yield displacements
    assert run["wheel_sinkage_m"][0] > 5e-3
