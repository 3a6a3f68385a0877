"""Joints in the engine: springs, dampers, stops and friction against closed forms and in the energy balance; loops."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support_bar import BAR, INERTIA, MASS
from support_runs import DENSITY, FOUR_BAR, order, scene_of, simulate

from granular_contact.engines.exudyn.build import build
from granular_contact.engines.exudyn.build_in_space import build as build_in_space

NO_REST = "solver.rest_time_s=null"

RAIL = f"""
model:
  name: rail
  bodies: {{bar: {{{BAR}}}}}
  joints: {{rail: {{type: slider, parent: ground, child: bar, axis: [1.7320508075688772, 1]}}}}
gravity_m_s2: 0
initial: {{joints: {{rail: {{position_m: 0.1}}}}}}
solver: {{end_time_s: 0.5, rest_time_s: null, tolerance: 1e-9}}
"""
SWING = f"""
model:
  name: swing
  bodies: {{bar: {{{BAR}}}}}
  joints: {{pin: {{type: hinge, parent: ground, child: bar}}}}
gravity_m_s2: 0
initial: {{impact_angle_deg: 30}}
solver: {{end_time_s: 0.5, rest_time_s: null, tolerance: 1e-9}}
"""


def imbalance(run) -> float:
    return float(np.abs(run["energy_imbalance_J"]).max())


@pytest.mark.parametrize("text", [RAIL, SWING], ids=["slider", "hinge"])
def test_spring_oscillates_at_its_frequency(text: str) -> None:
    slider = text is RAIL
    spring = "rail.spring={stiffness_N_per_m: 60, rest_m: 0.02}" if slider else "pin.spring={stiffness_Nm_per_rad: 2}"
    run = simulate(text, f"model.joints.{spring}", "solver.step_s=2e-4")
    s, rest, inertia, stiffness = (
        (run["rail_position_m"], 0.02, MASS, 60.0) if slider else (np.radians(run["pin_angle_deg"]), 0.0, INERTIA, 2.0)
    )
    omega = np.sqrt(stiffness / inertia)
    exact = rest + (s[0] - rest) * np.cos(omega * run["time_s"])
    # The trapezoidal rule: (omega h)^2 / 12 of the phase, which is omega t; three times that for the algorithm's start.
    phase = omega * 0.5 * (omega * 2e-4) ** 2 / 12
    np.testing.assert_allclose(s, exact, atol=3 * phase * abs(s[0] - rest))
    assert np.ptp(s) > 100 * 3 * phase * abs(s[0] - rest)
    stored = 0.5 * stiffness * (s[0] - rest) ** 2
    assert run["spring_J"][0] == pytest.approx(stored, rel=1e-12)
    assert imbalance(run) < 1e-4 * stored


def test_a_spring_under_a_weight_stretches_by_weight_over_stiffness() -> None:
    spring = (
        "model.joints.rail={type: slider, parent: ground, child: bar, axis: [0, 1], spring: {stiffness_N_per_m: 60}}"
    )
    run = simulate(RAIL, spring, "gravity_m_s2=9.81", "initial={settle: true}", "solver.end_time_s=0.01")
    # Settled to a hundredth of 1 mm/s: less than 1e-6 m at this frequency of 22 rad/s.
    assert run["rail_position_m"][0] == pytest.approx(-MASS * 9.81 / 60, abs=1e-6)


def test_damper_takes_what_the_swing_loses() -> None:
    run = simulate(SWING, "model.joints.pin.damping_Nm_s_per_rad=0.01", "initial.impact_speed_rad_s=5")
    rate = 5.0 * np.exp(-0.01 / INERTIA * run["time_s"])
    # (c h / I)^2 / 12 = 1e-7 of it per time constant; the hinge holds velocities to (5 h)^2 / 2 = 5e-7.
    np.testing.assert_allclose(run["pin_rate_rad_s"], rate, atol=1e-5)
    lost = 0.5 * INERTIA * (25.0 - rate[-1] ** 2)
    assert run["joint_damping_work_J"][-1] == pytest.approx(-lost, rel=1e-4)
    assert imbalance(run) < 1e-4 * lost


STOPS = "model.joints.pin.stops={lower_deg: -20, upper_deg: 40, stiffness_Nm_per_rad: 200"


@pytest.mark.slow
def test_stops_without_dissipation_give_everything_back() -> None:
    run = simulate(SWING, STOPS + "}", "initial.impact_speed_rad_s=3", "solver.step_s=5e-5")
    kinetic = 0.5 * INERTIA * 9.0
    assert run["pin_angle_deg"].max() == pytest.approx(40.0 + np.degrees(3.0 * np.sqrt(INERTIA / 200)), abs=0.02)
    assert run["pin_angle_deg"].min() < -20.0  # there and back
    assert run["spring_J"].max() == pytest.approx(kinetic, rel=1e-3)
    # A quarter period of sqrt(I / k) pi / 2 = 6.3 ms has 125 steps: (omega h)^2 / 12 = 1e-5.
    assert imbalance(run) < 1e-3 * kinetic


@pytest.mark.slow
def test_stops_take_what_a_bounce_loses() -> None:
    run = simulate(SWING, STOPS + ", dissipation_s_per_rad: 0.2}", "initial.impact_speed_rad_s=3", "solver.step_s=1e-4")

    def rates(_: float, y: np.ndarray) -> list[float]:
        depth = max(y[0] - np.radians(40.0), 0.0)
        return [y[1], -200.0 * depth * max(1.0 + 0.2 * y[1], 0.0) / INERTIA]

    bounced = (run["pin_rate_rad_s"] < 0.0) & (run["pin_angle_deg"] < 40.0) & (run["pin_angle_deg"] > -20.0)
    end = run["time_s"][np.flatnonzero(bounced)[0]]
    exact = solve_ivp(rates, (0, end), [np.radians(30.0), 3.0], "DOP853", rtol=1e-10, atol=1e-12, max_step=1e-4).y[
        :, -1
    ]
    after = run["pin_rate_rad_s"][np.flatnonzero(bounced)[0]]
    assert after == pytest.approx(exact[1], rel=1e-3)
    assert after > -2.8  # of 3 rad/s: a loss of a fifth of the energy is what is looked at
    lost = 0.5 * INERTIA * (9.0 - run["pin_rate_rad_s"][-1] ** 2)
    assert run["joint_damping_work_J"][-1] == pytest.approx(-lost, rel=5e-3)
    assert imbalance(run) < 1e-3 * 0.5 * INERTIA * 9.0


def test_dry_friction_stops_the_swing_where_its_work_is_done() -> None:
    run = simulate(SWING, "model.joints.pin.friction={torque_Nm: 0.02}", "initial.impact_speed_rad_s=2", NO_REST)
    kinetic = 0.5 * INERTIA * 4.0
    # The bristle gives way by 0.01 deg before it slips, and holds the swing by as much when it has stopped.
    assert run["pin_angle_deg"][-1] - 30.0 == pytest.approx(np.degrees(kinetic / 0.02), abs=0.03)
    assert run["friction_work_J"][-1] == pytest.approx(-kinetic, rel=1e-3)
    assert imbalance(run) < 1e-3 * kinetic
    # It stands still: in the last tenth of a second less than a millionth of the way.
    late = run["pin_angle_deg"][run["time_s"] > 0.4]
    assert np.ptp(late) < 1e-6 * (run["pin_angle_deg"][-1] - 30.0)


def test_dry_friction_holds_a_weight_that_it_can_hold() -> None:
    moment = MASS * 9.81 * 0.1
    for share, holds in ((0.95, True), (1.05, False)):
        friction = f"model.joints.pin.friction={{torque_Nm: {moment / share}}}"
        run = simulate(SWING, friction, "gravity_m_s2=9.81", "initial.impact_angle_deg=0")
        late = run["pin_angle_deg"][run["time_s"] > 0.3]
        # Let go all at once the weight slips a little before it is held; with 5 % to spare it then stands still, with
        # 5 % too much it falls by 0.05 (3 g / 2 l) t^2 / 2.
        assert (np.ptp(late) < 1e-6) == holds
        assert (abs(late[-1]) < 0.1) == holds


def test_friction_on_a_slider_stops_it_where_its_work_is_done() -> None:
    rub = "model.joints.rail.friction={force_N: 0.5}"
    run = simulate(RAIL, rub, "initial.joints.rail.speed_m_s=0.8", NO_REST)
    way = 0.5 * MASS * 0.8**2 / 0.5
    assert run["rail_position_m"][-1] - 0.1 == pytest.approx(way, abs=2e-5)
    assert imbalance(run) < 1e-3 * 0.5 * MASS * 0.64


FLEXIBLE = f"""
model:
  name: held
  bodies:
    bar: {{{BAR}, flexible: {{youngs_modulus_Pa: 2.0e+11, elements: 4}}}}
    tip: {{type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 7700}}
  joints:
    root: {{type: hinge, parent: ground, child: bar}}
    knuckle: {{type: hinge, parent: bar, child: tip, parent_point_m: [0.2, 0], home_deg: 20}}
initial: {{impact_angle_deg: 10}}
solver: {{end_time_s: 0.3, rest_time_s: null, step_s: 1e-4, tolerance: 1e-9}}
"""
HELD = (
    "model.joints.root.spring={stiffness_Nm_per_rad: 3, rest_deg: 5}",
    "model.joints.root.damping_Nm_s_per_rad=0.002",
    "model.joints.knuckle.spring={stiffness_Nm_per_rad: 0.5}",
    "model.joints.knuckle.damping_Nm_s_per_rad=0.001",
    "model.joints.knuckle.friction={torque_Nm: 0.002}",
)


@pytest.mark.slow
def test_joints_on_a_stiff_beam_act_as_on_a_rigid_one() -> None:
    bent, rigid = (simulate(FLEXIBLE, *HELD, *more) for more in ((), ("model.bodies.bar.flexible=null",)))
    # The root of the beam turns by about m g l^2 / (2 E I) = 0.014 deg against its chord, let go by twice that.
    np.testing.assert_allclose(bent["root_angle_deg"], rigid["root_angle_deg"], atol=0.03)
    np.testing.assert_allclose(bent["knuckle_angle_deg"], rigid["knuckle_angle_deg"], atol=0.06)
    assert np.ptp(rigid["root_angle_deg"]) > 5.0
    scale = np.abs(bent["spring_J"]).max()
    for run in (bent, rigid):
        assert imbalance(run) < 1e-3 * scale
        assert run["friction_work_J"][-1] < -1e-2 * scale
        assert run["joint_damping_work_J"][-1] < -1e-2 * scale


FOUR_BAR_IN_MOTION = f"""{FOUR_BAR}
initial: {{joints: {{a: {{rate_rad_s: 10}}}}}}
solver: {{end_time_s: 1, rest_time_s: null, tolerance: 1e-9}}
"""


def rocker_angle(crank: np.ndarray) -> np.ndarray:
    """Angle below the horizontal (rad) of the rocker by that of the crank: two circles about its two neighbours."""
    pin = 0.1 * np.column_stack([np.cos(crank), -np.sin(crank)])
    way = pin - [0.3, -0.2]
    distance = np.hypot(*way.T)
    # Isosceles: coupler and rocker are 0.3 long.
    opening = np.arccos(0.5 * distance / 0.3)
    return -(np.arctan2(way[:, 1], way[:, 0]) - opening)


def test_four_bar_loop_keeps_its_geometry_and_its_energy() -> None:
    steps, drifts = [2e-3, 1e-3, 5e-4], []
    for step in steps:
        run = simulate(FOUR_BAR_IN_MOTION, f"solver.step_s={step}")
        exact = rocker_angle(np.radians(run["a_angle_deg"]))
        # The constraints hold on the level of positions, to the tolerance of Newton's method.
        apart = np.radians(run["d_angle_deg"]) - exact
        np.testing.assert_allclose(apart - 2 * np.pi * np.round(apart / (2 * np.pi)), 0.0, atol=1e-7)
        drifts.append(imbalance(run))
    assert np.ptp(run["a_angle_deg"]) > 360.0
    assert np.ptp(run["d_angle_deg"]) > 20.0
    assert order(steps, drifts) == pytest.approx(2.0, abs=0.2)
    assert drifts[-1] < 1e-3 * np.ptp(run["kinetic_J"])


def test_a_loop_of_beams_sags_as_its_stiffness_says() -> None:
    """Two level beams from a wall, their tips welded to a bar that they keep upright."""
    beam = "type: link, length_m: 0.2, diameter_m: 0.004, density_kg_m3: 7700, flexible: {youngs_modulus_Pa: 2.0e+11}"
    text = f"""
model:
  name: parallel
  bodies:
    upper: {{{beam}}}
    lower: {{{beam}}}
    bar: {{type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 7700}}
  joints:
    a: {{type: weld, parent: ground, child: upper}}
    b: {{type: weld, parent: ground, child: lower, parent_point_m: [0, -0.1]}}
    c: {{type: weld, parent: upper, child: bar, parent_point_m: [0.2, 0], home_deg: 90}}
  closures:
    d: {{type: weld, parent: bar, child: lower, parent_point_m: [0.1, 0], child_point_m: [0.2, 0], home_deg: -90}}
initial: {{settle: true}}
solver: {{end_time_s: 0.01, tolerance: 1e-8}}
"""
    run = simulate(text)
    bending = 2e11 * np.pi / 64 * 0.004**4
    bar, line = DENSITY * np.pi / 4 * 0.01**2 * 0.1 * 9.81, DENSITY * np.pi / 4 * 0.004**2 * 9.81
    # Beams that are held level at both ends: P l^3 / 12 E I under an end force, w l^4 / 24 E I under their own weight.
    sag = 0.5 * bar * 0.2**3 / (12 * bending) + line * 0.2**4 / (24 * bending)
    # The bar turns a little, for the beams stretch: (d / 4)^2 / 0.05^2 = 4e-4 of a cantilever's slope; cubic elements
    # are exact at their nodes.
    assert -run["tip_y_m"][0] - 0.1 == pytest.approx(sag, rel=2e-3)


@pytest.mark.parametrize("space", [False, True], ids=["plane", "space"])
def test_forces_of_a_spring_do_not_depend_on_states_tried_before(space: bool) -> None:
    """Iterates that run away by more than half a turn are no turns of the hinge: its spring pulled by 360 deg more."""
    rod = "length_m: 0.2, diameter_m: 0.006, density_kg_m3: 1400, flexible: {bending_stiffness_N_m2: 0.1, elements: 4}"
    pin = "axis: [0, 1, 0], " if space else ""
    scene = scene_of(f"""
model:
  name: tried
  in_space: {str(space).lower()}
  bodies: {{rod: {{type: link, {rod}}}}}
  joints:
    pin: {{type: hinge, parent: ground, child: rod, {pin}home_deg: 30, spring: {{stiffness_Nm_per_rad: 1}}}}
""")
    system = (build_in_space if space else build)(scene)
    joints, size = system.joints, system.mbs.systemData.ODE2Size()
    assert joints is not None

    def forces(angle: float) -> np.ndarray:
        """Generalised forces where the first node is turned by an angle (rad) from the start."""
        q, out = np.zeros(size), np.zeros(size)
        if space:  # Euler parameters about y; the start is turned by 30 deg
            half = 0.5 * np.radians(30.0)
            q[3:7] = np.cos(half + 0.5 * angle) - np.cos(half), 0.0, np.sin(half + 0.5 * angle) - np.sin(half), 0.0
        else:
            home = -np.radians(30.0)
            q[2:4] = np.cos(home + angle) - np.cos(home), np.sin(home + angle) - np.sin(home)
        joints.add_forces(q, np.zeros(size), out)
        return out

    at_start = forces(0.0)
    assert np.abs(at_start).max() > 0.1
    for angle in (2.0, 4.0):
        assert np.abs(forces(angle) - at_start).max() > 0.1
    np.testing.assert_allclose(forces(0.0), at_start, rtol=1e-12, atol=1e-12)
