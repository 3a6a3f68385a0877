"""Every force element by itself: torque or force times rate is the rate of its energy or work, with a sign it may have.

The balance of all energies can't see an element that is wrong alike in the force and in the audit. Here each acts alone
on a body without weight, so that three things must agree: its force (from `joint_forces` or a column), the
momentum that the engine gives the body, and the column of its energy or work. What is lost is never gained.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from support_bar import INERTIA, MASS
from support_runs import scenario_of, simulate

from granular_contact.engines.exudyn.build import build as build_system
from granular_contact.engines.exudyn.solve import solve
from granular_contact.mechanics.joint_history import JointForces
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.mechanics.mechanism import joint_forces
from granular_contact.mechanics.observe import observe
from granular_contact.results import Results
from granular_contact.results.energy import accumulate, work
from granular_contact.scene import build

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
STEP = 5e-5

# One joint with one element, on a body that starts towards it; the unit of the coordinate in the text: deg or m.
BODY = """
model:
  name: one
  bodies: {{bar: {{type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 7700}}}}
  joints: {{it: {{type: {kind}, parent: ground, child: bar{element}}}}}
gravity_m_s2: 0
initial: {{joints: {{it: {{{place}: {s}, {speed}: {rate}}}}}}}
solver: {{end_time_s: 0.2, step_s: 5e-5, rest_time_s: null, tolerance: 1e-10}}
"""
HINGE = {"kind": "hinge", "place": "angle_deg", "speed": "rate_rad_s"}
SLIDER = {"kind": "slider", "place": "position_m", "speed": "speed_m_s"}
HINGE_STOPS = "{{lower_deg: -5, upper_deg: 5, stiffness_Nm_per_rad: 20, dissipation_s_per_rad: {}}}"
SLIDER_STOPS = "{{lower_m: -0.01, upper_m: 0.01, stiffness_N_per_m: 500, dissipation_s_per_m: {}}}"
ELEMENTS = {
    ("hinge", "spring"): (", spring: {stiffness_Nm_per_rad: 2, rest_deg: -4}", 10, 1.0),
    ("hinge", "damper"): (", damping_Nm_s_per_rad: 0.02", 10, 3.0),
    ("hinge", "damper", "back"): (", damping_Nm_s_per_rad: 0.02", 10, -3.0),
    ("hinge", "upper_stop"): (f", stops: {HINGE_STOPS.format(0.3)}", 0, 2.0),
    ("hinge", "lower_stop"): (f", stops: {HINGE_STOPS.format(0.3)}", 0, -2.0),
    ("hinge", "lower_stop", "elastic"): (f", stops: {HINGE_STOPS.format(0)}", 0, -2.0),
    ("hinge", "friction"): (", friction: {torque_Nm: 0.05}", 0, 2.0),
    ("hinge", "friction", "back"): (", friction: {torque_Nm: 0.05}", 0, -2.0),
    ("slider", "spring"): (", spring: {stiffness_N_per_m: 60, rest_m: 0.02}", 0.05, 0.2),
    ("slider", "damper"): (", damping_N_s_per_m: 1", 0, 0.5),
    ("slider", "upper_stop"): (f", stops: {SLIDER_STOPS.format(1.5)}", 0, 0.5),
    ("slider", "lower_stop"): (f", stops: {SLIDER_STOPS.format(1.5)}", 0, -0.5),
    ("slider", "friction"): (", friction: {force_N: 1}", 0, -0.5),
}


@cache
def observed(text: str) -> tuple[dict[str, JointForces], dict[str, Array]]:
    """Forces in the joints of a run, and its columns by their names."""
    system = build_system(build(scenario_of(text)))
    trajectory = solve(system)
    columns, table = observe(system, trajectory).columns()
    return joint_forces(Kinematics(system, trajectory)), {column.name: table[:, i] for i, column in enumerate(columns)}


def rate_of(kind: str, run: dict[str, Array] | Results) -> Array:
    return run["it_rate_rad_s" if kind == "hinge" else "it_speed_m_s"]


@pytest.mark.parametrize("case", ELEMENTS, ids=" ".join)
def test_an_element_alone(case: tuple[str, ...]) -> None:
    kind, name = case[:2]
    element, s, rate = ELEMENTS[case]
    text = BODY.format(**(HINGE if kind == "hinge" else SLIDER), element=element, s=s, rate=rate)
    joints, run = observed(text)
    forces, time, moved = joints["it"], run["time_s"], rate_of(kind, run)
    force, inertia = forces.force[name], INERTIA if kind == "hinge" else MASS
    others = [other for key, other in forces.force.items() if key != name]
    assert all(np.abs(other).max() == 0.0 for other in others) or name.endswith("_stop")
    total = force + np.sum(others, axis=0) if others else force
    # Newton's law with the engine's own motion: trapezoids against the integrator's rule, and jumps at a stop: a step
    # of the greatest force at each of its two ends.
    impulse = accumulate(time, total)
    np.testing.assert_allclose(inertia * (moved - moved[0]), impulse, atol=2.0 * STEP * np.abs(total).max())
    assert np.abs(impulse).max() > 20.0 * STEP * np.abs(total).max()
    # Its power is what its energies lose: the same trapezoids, of kinks at the ends of a stop as above.
    power, stored = accumulate(time, total * moved), sum(forces.stored.values(), np.zeros_like(time))
    work = sum(run[column] - run[column][0] for column in ("joint_damping_work_J", "friction_work_J") if column in run)
    atol = 2.0 * STEP * np.abs(total * moved).max()
    np.testing.assert_allclose(power, stored[0] - stored + work, atol=atol)
    assert np.abs(power).max() > 20.0 * atol / 2.0
    if "spring_J" in run:
        np.testing.assert_allclose(run["spring_J"], stored, atol=1e-15)
    # The sign: energy is stored, not owed; and what is lost, is lost at every instant.
    assert stored.min() >= 0.0
    scale = np.abs(total * moved).max()
    for key in forces.force:
        if key == "friction":  # but for its bristle, which gives back what it took over 0.01 deg or 0.01 mm
            assert np.diff(accumulate(time, forces.force[key] * moved)).max() <= 1e-3 * scale * STEP + 1e-7
            continue
        assert forces.lost(key, moved).max() <= 1e-12 * scale
    if name not in ("spring",) and case[-1] != "elastic":
        assert accumulate(time, forces.lost(name, moved))[-1] < -0.02 * 0.5 * inertia * moved[0] ** 2


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("kind", ["hinge", "slider"])
def test_a_stop_that_dissipates_lets_go_slower_than_it_was_met(kind: str, side: int) -> None:
    """Either end of the range, and both alike: a mirror image."""
    element, s, rate = ELEMENTS[kind, "upper_stop"]
    speeds = []
    for sign in (1, side):
        text = BODY.format(**(HINGE if kind == "hinge" else SLIDER), element=element, s=s, rate=sign * rate)
        _, run = observed(text)
        moved = rate_of(kind, run)
        met = int(np.flatnonzero(moved * sign < 0.0)[0])
        speeds.append(float(np.abs(moved[met:]).max()))
        assert 0.3 * rate < speeds[-1] < 0.95 * rate
    assert speeds[1] == pytest.approx(speeds[0], rel=1e-9)


DRIVES = {
    ("hinge", "torque"): "{type: torque, torque_Nm: {type: sine, amplitude: 0.2, frequency_Hz: 8, phase_deg: 40}}",
    ("hinge", "motion"): "{type: motion, angle_deg: {type: sine, amplitude: 20, frequency_Hz: 8}}",
    ("hinge", "control"): "{type: pd, angle_deg: 20, gain_Nm_per_rad: 2, rate_gain_Nm_s_per_rad: 0.01}",
    ("hinge", "brake"): "{type: pd, rate_rad_s: 0, rate_gain_Nm_s_per_rad: 0.05, limit_Nm: 0.1}",
    ("slider", "force"): "{type: force, force_N: {type: sine, amplitude: 3, frequency_Hz: 8, phase_deg: 200}}",
    ("slider", "motion"): "{type: motion, position_m: {type: sine, amplitude: 0.02, frequency_Hz: 8}}",
    ("slider", "brake"): "{type: pd_slider, speed_m_s: 0, speed_gain_N_s_per_m: 2}",
}


@pytest.mark.parametrize("case", DRIVES, ids=" ".join)
def test_a_drive_alone(case: tuple[str, str]) -> None:
    kind, name = case
    start = {"brake": 4.0 if kind == "hinge" else 0.5}.get(name, 0.0)
    form = dict(HINGE if kind == "hinge" else SLIDER)
    text = BODY.format(**form, element="", s=0, rate=start)
    if name == "motion":
        text = text.replace(f"it: {{{form['place']}: 0, {form['speed']}: 0.0}}", "")
    run = simulate(text + f"drives: {{it: {DRIVES[case]}}}\n")
    column = "it_torque_Nm" if kind == "hinge" else "it_force_N"
    force, moved, time = run[column], rate_of(kind, run), run["time_s"]
    inertia = INERTIA if kind == "hinge" else MASS
    # As above.
    atol = 2.0 * STEP * np.abs(force).max()
    np.testing.assert_allclose(inertia * (moved - moved[0]), accumulate(time, force), atol=atol)
    np.testing.assert_allclose(run["it_power_W"], force * moved, atol=1e-14)
    # Of a motion the mean force of a step is known better than by its ends: the work is that of the momentum it gave.
    done = np.concatenate([[0.0], np.cumsum(0.5 * inertia * np.diff(moved**2))])
    expected = done if name == "motion" else work(time, force, moved)
    np.testing.assert_allclose(run["drive_work_J"], expected, atol=1e-14 if name != "motion" else 1e-9)
    assert np.abs(run["drive_work_J"]).max() > 1e-3
    if name == "brake":
        assert (force * moved).max() <= 0.0


ROD = """
model:
  name: rod
  bodies: {rod: {type: link, length_m: 0.2, diameter_m: 0.01, density_kg_m3: 7700}}
  joints: {air: {type: free, parent: ground, child: rod, child_point_m: [0.1, 0]}}
medium: play_sand
initial: {joints: {air: {x_m: 0.4, angle_deg: 50, vx_m_s: 0.4, vy_m_s: -1.0, rate_rad_s: 3}}}
load: {friction: {type: smooth}}
solver: {step_s: 5e-5, end_time_s: 0.06}
"""


def wrench_of(run: Results, term: str) -> Array:
    """Force x, y (N) and clockwise moment about the centre of mass (N m) of a term, (n, 3)."""
    columns = ("force_x_N", "force_y_N", "moment_about_center_of_mass_Nm")
    return np.column_stack([run[f"{term}_{column}"] for column in columns])


def twist_of(run: Results, body: str) -> Array:
    """Velocity x, y (m/s) of the centre of mass and clockwise spin (rad/s) of a body, (n, 3)."""
    return np.column_stack([run[f"{body}_{column}"] for column in ("vx_m_s", "vy_m_s", "spin_rad_s")])


def test_every_term_of_the_medium_alone() -> None:
    """Force and moment (about the centre of mass) of a term, times how the body moves: its power, never a gain.

    With friction that follows the velocity, as a bristle gives back what it took.
    """
    run = simulate(ROD)
    twist, total = twist_of(run, "rod"), 0.0
    for term in run.terms:
        wrench = wrench_of(run, term)
        power = np.sum(wrench * twist, axis=1)
        assert power.max() <= 1e-9 * np.abs(power).max(), term
        assert accumulate(run["time_s"], power)[-1] < -1e-3, term
        total = total + wrench
    # The same mean forces and mean rates of the same steps.
    integral = work(run["time_s"], total, twist)
    np.testing.assert_allclose(run["granular_work_J"], integral, atol=1e-6 * np.abs(integral).max())
    # And with the other sense of the moment the power would be another one.
    wrong = work(run["time_s"], total * [1.0, 1.0, -1.0], twist)
    assert np.abs(wrong - integral).max() > 1e-3


FLOOR = """
model:
  name: plank
  bodies: {plank: {type: link, length_m: 0.2, width_m: 0.02, thickness_m: 0.01, density_kg_m3: 2000}}
  joints: {air: {type: free, parent: ground, child: plank, child_point_m: [0.1, 0]}}
medium: {from: rft_generic, zeta: 1e-6}
bed: {height_m: 0, depth_m: 0.01, floor: {stiffness_N_m2: 2e5, damping_s_m: 0.3}}
initial: {joints: {air: {x_m: 0.4, y_m: 0.06, angle_deg: 20, vx_m_s: 0.4, vy_m_s: -1.0}}}
solver: {step_s: 2e-5, end_time_s: 0.08}
"""


def test_the_floor_alone() -> None:
    """It takes no more than it gave, at any time: what a spring stores is owed by it, and the rest is lost."""
    run = simulate(FLOOR)
    term = next(name for name in run.terms if "floor" in name)
    done = run["floor_work_J"]
    integral = work(run["time_s"], wrench_of(run, term), twist_of(run, "plank"))
    np.testing.assert_allclose(done, integral, atol=1e-4 * np.abs(done).max())
    assert done.max() <= 1e-9
    assert done.min() < -1e-2
    assert done[-1] < -1e-3
    assert run[f"{term}_force_y_N"].min() >= 0.0


# ---- rates that powers are made of ----

MERRY_GO_ROUND = """
model:
  name: arm
  bodies:
    arm: {type: link, length_m: 0.3, diameter_m: 0.01, density_kg_m3: 7700}
    bob: {type: link, length_m: 0.05, diameter_m: 0.01, density_kg_m3: 7700}
  joints:
    pin: {type: hinge, parent: ground, child: arm}
    rail: {type: slider, parent: arm, child: bob, parent_point_m: [0.1, 0.02], child_point_m: [0, 0.03], axis: [1, 2]}
gravity_m_s2: 0
initial: {joints: {pin: {rate_rad_s: 6}, rail: {position_m: 0.05, speed_m_s: 0.3}}}
solver: {end_time_s: 0.2, step_s: 1e-4, rest_time_s: null, tolerance: 1e-10}
"""


def test_rates_of_joints_on_a_turning_body_are_those_of_coordinates() -> None:
    run = simulate(MERRY_GO_ROUND)
    for coordinate, rate in (
        (run["rail_position_m"], run["rail_speed_m_s"]),
        (np.radians(run["pin_angle_deg"]), run["pin_rate_rad_s"]),
    ):
        # Differences over two steps: (6 rad/s x 1e-4 s)^2 of the rate, and the start of the integrator.
        slope = np.gradient(coordinate, run["time_s"])[2:-2]
        np.testing.assert_allclose(rate[2:-2], slope, atol=1e-4 * np.abs(slope).max())


def test_work_put_in_counts_what_a_drive_gives_and_not_what_it_takes_back() -> None:
    """A force F sin(w t) on a mass moves it at F (1 - cos w t) / (m w): in a period it gives 2 F^2 / (m w^2), and takes
    as much back.
    """
    text = BODY.format(**SLIDER, element="", s=0, rate=0).replace("gravity_m_s2: 0", "gravity_m_s2: 5")
    text = text.replace("type: slider,", "type: slider, ").replace("end_time_s: 0.2", "end_time_s: 0.1")
    run = simulate(text + "drives: {it: {type: force, force_N: {type: sine, amplitude: 3, frequency_Hz: 10}}}\n")
    summary, omega = run.summary, 2.0 * np.pi * 10.0
    given = 2.0 * 3.0**2 / (MASS * omega**2)
    # Trapezoids of 5e-5 s: (w h)^2 / 12.
    assert summary["drive_work_put_in_J"] == pytest.approx(given, rel=1e-4)
    assert abs(run["drive_work_J"][-1]) < 1e-4 * given
    way = 3.0 / (MASS * omega) * 0.1
    assert summary["distance_m"] == pytest.approx(way, rel=1e-4)
    assert summary["cost_of_transport"] == pytest.approx(given / (MASS * 5.0 * way), rel=2e-4)


FAR_STOPS = "stops: {lower_m: -5, upper_m: 5, stiffness_N_per_m: 500}"  # stiff where they are met alone


@pytest.mark.parametrize("element", ["spring: {stiffness_N_per_m: 60}", "damping_N_s_per_m: 2", FAR_STOPS])
def test_tangent_of_what_acts_in_a_joint_is_the_derivative_of_its_force(element: str) -> None:
    """Central differences at a place off the start; a slider on what turns has a curved coordinate."""
    scene = build(scenario_of(MERRY_GO_ROUND.replace("axis: [1, 2]", f"axis: [1, 2], {element}")))
    system = build_system(scene)
    system.mbs.Assemble()
    assert system.joints is not None
    acting, size = system.joints, system.mbs.systemData.ODE2Size()
    acting.places[0, :6, 1] = acting.places[0, 5::-1, 1].copy()  # whoever takes the forces may have another order
    where, over = acting.places[0, :6].T
    assert (where != over).all()
    draw = np.random.default_rng(3)
    q, v = 0.1 * draw.standard_normal(size), draw.standard_normal(size)

    def force(q: Array, v: Array) -> Array:
        out = np.zeros(size)
        acting.add_forces(q, v, out)
        return out[over]

    step, moved = 1e-6, 1e-6 * np.eye(size)[where]
    by_q = np.column_stack([(force(q + offset, v) - force(q - offset, v)) / (2.0 * step) for offset in moved])
    by_v = np.column_stack([(force(q, v + offset) - force(q, v - offset)) / (2.0 * step) for offset in moved])
    for place, speed, exact in ((1.0, 0.0, by_q), (0.0, 1.0, by_v)):
        rows, columns, values = acting.tangent(q, v, place, speed).T
        got = np.zeros((size, size))
        np.add.at(got, (rows.astype(int), columns.astype(int)), values)
        # Round-off of differences: 1e-16 / 1e-6 of the force, and the square of the step.
        np.testing.assert_allclose(got[np.ix_(over, over)], exact, atol=1e-7 * max(np.abs(by_q).max(), 1.0))


@pytest.mark.parametrize(("kind", "friction", "moved"), [(HINGE, "{torque_Nm: 0.05}", 2), (SLIDER, "{force_N: 1}", 0)])
def test_dry_friction_grows_to_its_bound_and_never_beyond(kind: dict[str, str], friction: str, moved: int) -> None:
    """Within the slip by the stiffness of a bristle, beyond it by no more than was given; moved: x or the angle."""
    scene = build(scenario_of(BODY.format(**kind, element=f", friction: {friction}", s=0, rate=0)))
    system = build_system(scene)
    system.mbs.Assemble()
    assert system.joints is not None
    law, size = scene.joints[0].law, system.mbs.systemData.ODE2Size()
    for strain in (-3.0, -1.5, -1.01, -0.5, 0.5, 1.01, 1.5, 3.0):
        q, out = np.zeros(size), np.zeros(size)
        q[moved] = strain * law.slip
        system.joints.add_forces(q, np.zeros(size), out)
        assert out[moved] == pytest.approx(-law.friction * np.clip(strain, -1.0, 1.0), rel=1e-9)
