"""Initial states of mechanisms: given joints, closed loops, expanded chains, and contradictions."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
import support_refusals
from scipy.optimize import minimize_scalar
from support_runs import FOUR_BAR, scene_of

from granular_contact.cli import main
from granular_contact.config import load
from granular_contact.errors import SceneError
from granular_contact.scene import build
from granular_contact.scene.homes import HomeNote
from granular_contact.scene.types import Scene

BAR = "length_m: 0.1, diameter_m: 0.01, density_kg_m3: 7700"
LEG = f"""
model:
  name: leg
  bodies:
    cart: {{type: link, {BAR}}}
    thigh: {{type: link, {BAR}}}
    shank: {{type: link, {BAR}}}
  joints:
    rail: {{type: slider, parent: ground, child: cart, parent_point_m: [0.3, 0], axis: [0, 1], home_deg: 90}}
    hip: {{type: hinge, parent: cart, child: thigh, parent_point_m: [0.1, 0]}}
    knee: {{type: hinge, parent: thigh, child: shank, parent_point_m: [0.1, 0], home_deg: 30}}
initial:
  joints:
    rail: {{position_m: 0.2, speed_m_s: 1.5}}
    hip: {{angle_deg: 20, rate_rad_s: 3}}
"""


faults_of = partial(support_refusals.faults_of, SceneError, scene_of)


def turn(angle: float) -> np.ndarray:
    return np.array([math.cos(angle), math.sin(angle)])


def ends(scene: Scene, body: str) -> np.ndarray:
    """Start and end of a link, (2, 2) m."""
    bar = scene.body(body)
    half = 0.5 * (0.3 if body in ("coupler", "rocker") else 0.1)
    return np.array([bar.motion.world(np.array([x, 0.0])) for x in (-half, half)])


def test_places_and_velocities_follow_from_the_joints() -> None:
    scene = scene_of(LEG)
    # Counter-clockwise angles of the three bars: the cart hangs down, the hinges turn clockwise.
    angles = [math.radians(a) for a in (-90.0, -110.0, -140.0)]
    spins = [0.0, -3.0, -3.0]
    at, speed = np.array([0.3, 0.2]), np.array([0.0, 1.5])
    for name, angle, spin in zip(("cart", "thigh", "shank"), angles, spins, strict=True):
        motion, along = scene.body(name).motion, turn(angle)
        # Round-off of numbers of order one.
        np.testing.assert_allclose(motion.position, at + 0.05 * along, atol=1e-15)
        assert (motion.angle, motion.rate) == (pytest.approx(angle, abs=1e-15), pytest.approx(spin, abs=1e-15))
        across = np.array([-along[1], along[0]])
        np.testing.assert_allclose(motion.velocity, speed + 0.05 * spin * across, atol=1e-15)
        at, speed = at + 0.1 * along, speed + 0.1 * spin * across


def test_coordinates_of_joints_at_the_start() -> None:
    rail, hip, knee = scene_of(LEG).joints
    assert (rail.start, rail.rate) == (0.2, 1.5)
    assert (hip.start, hip.rate) == (pytest.approx(math.radians(20.0)), 3.0)
    assert (knee.start, knee.rate) == (pytest.approx(math.radians(30.0)), 0.0)
    np.testing.assert_allclose(rail.axis, [0.0, 1.0], atol=1e-15)
    np.testing.assert_allclose(rail.parent_point, [0.3, 0.0], atol=1e-15)


def test_numbers_of_a_joint_arrive_in_si_units() -> None:
    """Each key of a joint, with a value of its own; of a revolute joint degrees become radians."""
    hinge = """{type: hinge, parent: cart, child: thigh, damping_Nm_s_per_rad: 2,
      spring: {stiffness_Nm_per_rad: 3, rest_deg: 10}, friction: {torque_Nm: 4, slip_deg: 0.5, damping_time_s: 6},
      stops: {lower_deg: -70, upper_deg: 80, stiffness_Nm_per_rad: 9, dissipation_s_per_rad: 0.1}}"""
    slider = """{type: slider, parent: ground, child: cart, damping_N_s_per_m: 2,
      spring: {stiffness_N_per_m: 3, rest_m: 0.4}, friction: {force_N: 4, slip_m: 0.005, damping_time_s: 6},
      stops: {lower_m: -0.7, upper_m: 0.8, stiffness_N_per_m: 9, dissipation_s_per_m: 0.1}}"""
    names = ("damping", "stiffness", "rest", "friction", "slip", "damping_time")
    names += ("lower", "upper", "stop_stiffness", "dissipation")
    turning = (2, 3, math.radians(10), 4, math.radians(0.5), 6, math.radians(-70), math.radians(80), 9, 0.1)
    sliding = (2, 3, 0.4, 4, 0.005, 6, -0.7, 0.8, 9, 0.1)
    scene = scene_of(LEG, f"model.joints.hip={hinge}", f"model.joints.rail={slider}")
    laws = {joint.name: joint.law for joint in scene.joints}
    for joint, expected in {"hip": turning, "rail": sliding}.items():
        np.testing.assert_allclose([getattr(laws[joint], name) for name in names], expected, rtol=1e-14)
    assert not laws["knee"].stiffness
    assert laws["knee"].is_linear


@pytest.mark.parametrize("crank", [-200.0, -90.0, 60.0, 200.0, 400.0])
def test_the_joint_that_closes_a_loop_starts_with_its_bodies(crank: float) -> None:
    scene = scene_of(FOUR_BAR, f"initial.joints.a={{angle_deg: {crank}, rate_rad_s: 2}}")
    (closed,) = (joint for joint in scene.joints if joint.closes)
    parent, child = (scene.body(name).motion for name in ("coupler", "rocker"))
    assert closed.rate == pytest.approx(parent.rate - child.rate, rel=1e-12)
    assert abs(closed.rate) > 0.1
    assert math.remainder(closed.start - (parent.angle - child.angle), 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
    assert abs(closed.start) <= math.pi
    # Its coordinate is counted on from there.
    assert parent.angle - child.angle + closed.offset == pytest.approx(closed.start, abs=1e-12)


def test_closing_slider_of_a_crank_starts_at_place_and_speed_of_its_block() -> None:
    """x = r cos q + sqrt(l^2 - r^2 sin^2 q) of a crank r at the angle q, a rod l and a block on the level through a."""
    text = """
model:
  name: crank
  bodies: {crank: {type: link, length_m: 0.1, BAR}, rod: {type: link, length_m: 0.3, BAR}, block: {type: link, LINK}}
  joints:
    a: {type: hinge, parent: ground, child: crank, parent_point_m: [0.02, 0.01], home_deg: -30}
    b: {type: hinge, parent: crank, child: rod, parent_point_m: [0.1, 0], home_deg: 39.594}
    p: {type: hinge, parent: rod, child: block, parent_point_m: [0.3, 0], home_deg: -9.594}
  closures: {c: {type: slider, parent: ground, child: block, parent_point_m: [0, 0.01]}}
initial: {joints: {a: {angle_deg: -50, rate_rad_s: 2}}}
""".replace("LINK", BAR).replace("BAR", "diameter_m: 0.01, density_kg_m3: 7700")
    (closed,) = (joint for joint in scene_of(text).joints if joint.closes)
    r, rod, q, rate = 0.1, 0.3, math.radians(50.0), -2.0
    level = math.sqrt(rod**2 - (r * math.sin(q)) ** 2)
    assert closed.start == pytest.approx(0.02 + r * math.cos(q) + level, abs=1e-9)
    assert closed.rate == pytest.approx(-r * math.sin(q) * rate * (1.0 + r * math.cos(q) / level), abs=1e-9)


def test_closing_slider_on_a_turning_body_starts_at_the_speed_of_its_block() -> None:
    """A crank r drives a rocker by a block in its slot, which passes its pivot, c below that of the crank, at h.

    s = sqrt(r^2 + c^2 + 2 r c sin q - h^2) along the slot, whose own motion at the block is not across it.
    """
    text = """
model:
  name: slotted rocker
  bodies: {crank: {type: link, length_m: 0.1, BAR}, block: {type: link, LINK}, rocker: {type: link, length_m: 0.3, BAR}}
  joints:
    a: {type: hinge, parent: ground, child: crank}
    p: {type: hinge, parent: crank, child: block, parent_point_m: [0.1, 0], home_deg: -58.303}
    d: {type: hinge, parent: ground, child: rocker, parent_point_m: [0, -0.2], home_deg: -58.303}
  closures: {c: {type: slider, parent: rocker, child: block, parent_point_m: [0, 0.02]}}
initial: {joints: {a: {angle_deg: -50, rate_rad_s: 2}}}
""".replace("LINK", BAR).replace("BAR", "diameter_m: 0.01, density_kg_m3: 7700")
    (closed,) = (joint for joint in scene_of(text).joints if joint.closes)
    r, c, h, q, rate = 0.1, 0.2, 0.02, math.radians(50.0), -2.0
    s = math.sqrt(r**2 + c**2 + 2.0 * r * c * math.sin(q) - h**2)
    assert closed.start == pytest.approx(s, abs=1e-9)
    assert closed.rate == pytest.approx(r * c * math.cos(q) * rate / s, abs=1e-9)
    assert closed.axis is not None
    np.testing.assert_allclose(closed.axis, [1.0, 0.0], atol=1e-12)  # along the rocker, in its frame


def test_joints_that_follow_a_weld_are_kept() -> None:
    scene = scene_of(
        f"""
model:
  name: bent
  bodies: {{foot: {{type: link, {BAR}}}, leg: {{type: link, {BAR}}}}}
  joints:
    ankle: {{type: weld, parent: leg, child: foot, parent_point_m: [0.1, 0]}}
    hip: {{type: hinge, parent: ground, child: leg}}
initial: {{joints: {{}}}}
"""
    )
    assert [joint.name for joint in scene.joints] == ["hip"]


def test_a_free_body_starts_as_said() -> None:
    scene = scene_of(
        f"""
model:
  name: rod
  bodies: {{rod: {{type: link, {BAR}}}}}
  joints: {{air: {{type: free, parent: ground, child: rod, parent_point_m: [1, 2], child_point_m: [0.1, 0]}}}}
initial: {{joints: {{air: {{x_m: 0.5, y_m: 0.25, angle_deg: 60, vx_m_s: 3, vy_m_s: -4, rate_rad_s: 5}}}}}}
"""
    )
    motion, along = scene.rigid[0].motion, turn(math.radians(-60.0))
    # The joint sits at the far end of the rod, half its length from the centre of mass.
    np.testing.assert_allclose(motion.position, np.array([1.5, 2.25]) - 0.05 * along, atol=1e-15)
    across = np.array([-along[1], along[0]])
    np.testing.assert_allclose(motion.velocity, np.array([3.0, -4.0]) + 0.05 * 5.0 * across, atol=1e-14)
    assert scene.floating is not None
    assert scene.pivot is None
    # The lowest end is what is followed.
    np.testing.assert_allclose(scene.tip_position, [1.5, 2.25], atol=1e-15)


def test_tip_speed_at_impact() -> None:
    scene = scene_of("pendulum", "initial.impact_speed_rad_s=0", "initial.impact_tip_speed_m_s=1.5")
    reach = 0.024765 + 0.23876
    assert scene.links[0].motion.rate == pytest.approx(-1.5 / reach, rel=1e-12)
    assert scene.speed == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize("crank", [-90.0, -30.0, 60.0, 200.0])
def test_a_loop_follows_its_crank(crank: float) -> None:
    scene = scene_of(FOUR_BAR, f"initial.joints.a={{angle_deg: {crank}, rate_rad_s: 2}}")
    coupler, rocker = ends(scene, "coupler"), ends(scene, "rocker")
    angle = math.radians(-crank)
    np.testing.assert_allclose(coupler[0], 0.1 * turn(angle), atol=1e-13)
    np.testing.assert_allclose(coupler[1], rocker[1], atol=1e-13)
    np.testing.assert_allclose(rocker[0], [0.3, -0.2], atol=1e-13)
    # Home has the coupler above the line from crank to rocker's pin; it stays on that side.
    way, to_pin = coupler[1] - coupler[0], rocker[0] - coupler[0]
    assert way[0] * to_pin[1] - way[1] * to_pin[0] < 0.0
    # Rates: both bodies move their common point alike.
    points = np.array([0.15, 0.0])
    moved = []
    for name in ("coupler", "rocker"):
        motion = scene.body(name).motion
        arm = motion.world(points) - motion.position
        moved.append(motion.velocity + motion.rate * np.array([-arm[1], arm[0]]))
    np.testing.assert_allclose(*moved, atol=1e-12)


HOMES = [("a", -90.0), ("b", 90.0), ("d", -90.0)]


def test_a_gaping_loop_is_closed_with_the_least_change_and_told() -> None:
    """Against the sum of squares over the one freedom of a four-bar, searched through by the angle of its crank."""
    scene = scene_of(FOUR_BAR, "model.joints.d.parent_point_m=[0.31, -0.2]")
    homes = {note.key.split(".")[2]: note.home for note in scene.notes if isinstance(note, HomeNote)}

    def others(crank: float) -> tuple[float, float]:
        """Of coupler and rocker the angles of their joints (deg), from the triangle of the pins."""
        pin = 0.1 * turn(-math.radians(crank))
        apart = np.array([0.31, -0.2]) - pin
        half = math.acos(0.5 * math.hypot(*apart) / 0.3)
        along = math.atan2(apart[1], apart[0])
        coupler, rocker = -(along + half), -(math.atan2(-apart[1], -apart[0]) - half)
        return math.degrees(math.remainder(coupler - math.radians(crank), 2 * math.pi)), math.degrees(rocker)

    def change(crank: float) -> float:
        return sum((angle - was) ** 2 for angle, (_, was) in zip((crank, *others(crank)), HOMES, strict=True))

    least = minimize_scalar(change, bounds=(-100.0, -80.0), method="bounded", options={"xatol": 1e-8})
    # Homes are rounded to 1e-6 degrees; of a flat minimum the place is known to the root of round-off.
    np.testing.assert_allclose([homes[name] for name, _ in HOMES], [least.x, *others(least.x)], atol=1e-4)


def test_a_loop_is_closed_from_angles_that_are_far_off() -> None:
    scene = scene_of(FOUR_BAR, *(f"model.joints.{name}.home_deg=0" for name, _ in HOMES))
    gap = ends(scene, "coupler")[1] - ends(scene, "rocker")[1]
    np.testing.assert_allclose(gap, 0.0, atol=1e-12)


@pytest.mark.slow
def test_a_loop_that_no_configuration_closes_is_refused_with_the_least_gap() -> None:
    (fault,) = faults_of(FOUR_BAR, "model.joints.d.parent_point_m=[0.9, -0.2]")
    assert fault.key == "model.closures.c"
    gap = math.hypot(0.9, 0.2) - 0.1 - 0.3 - 0.3  # with all links in a line
    assert f"whatever its joints; at best coupler and rocker are {gap:.3g} m apart" in fault.message


def test_homes_that_were_found_are_written_where_they_stand(tmp_path) -> None:
    """In a block, in braces, and where the key is missing; the rest of the files stays, and then nothing is told."""
    before = FOUR_BAR.replace("name: four_bar", "name: four_bar # kept").replace(", home_deg: -90}", "}")
    before = before.replace("home_deg: 90}", "home_deg: 80}  # rough")
    file = tmp_path / "bar.yaml"
    file.write_text(before, encoding="utf-8")
    assert main(["check", "--write-homes", str(file)]) == 0
    after = file.read_text(encoding="utf-8")
    assert "# kept" in after
    assert "}  # rough" in after
    assert after.count("home_deg") == 3
    assert not build(load(file)).notes


def test_homes_of_chain_joints_are_printed_and_not_written(tmp_path, capsys) -> None:
    text = """
model:
  name: chain
  chain: {count: 3, link: {length_m: 0.1, BAR}}
  closures: {end: {type: hinge, parent: ground, child: link_3, parent_point_m: [0.2, 0], child_point_m: [0.1, 0]}}
""".replace("BAR", BAR.split(", ", 1)[1])
    file = tmp_path / "chain.yaml"
    file.write_text(text, encoding="utf-8")
    assert main(["check", "--write-homes", str(file)]) == 2
    assert "is not written; give the start in initial.joints" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8") == text


def test_a_start_in_which_a_loop_does_not_close_is_refused_with_the_gap() -> None:
    (fault,) = faults_of(FOUR_BAR, "initial.joints={a: {angle_deg: 0}, b: {angle_deg: 0}}")
    assert fault.key == "model.closures.c"
    # The coupler ends at (0.4, 0), the rocker reaches 0.3 from (0.3, -0.2).
    gap = 0.3 - math.hypot(0.1, 0.2)
    assert f"the loop does not close at the start: coupler and rocker are {gap:.4g} m apart" in fault.message


def test_a_loop_welded_at_another_angle_is_turned_there() -> None:
    """The weld holds the rocker 80 degrees counter-clockwise of the coupler."""
    scene = scene_of(FOUR_BAR, "model.closures.c.type=weld", "model.closures.c.home_deg=-80")
    apart = scene.body("rocker").motion.angle - scene.body("coupler").motion.angle
    assert math.degrees(math.remainder(apart, 2.0 * math.pi)) == pytest.approx(80.0, abs=1e-9)
    assert len(scene.notes) == 3


def test_redundant_closures_are_named() -> None:
    second_closure = "{type: hinge, parent: coupler, child: rocker, parent_point_m: [0.3, 0], child_point_m: [0.3, 0]}"
    (fault,) = faults_of(FOUR_BAR, f"model.closures.again={second_closure}")
    assert fault.key == "model.closures.again"
    assert fault.message.startswith("2 of the 2 constraints of again are redundant with the other joints")


def test_a_weld_that_stops_a_loop_is_partly_redundant() -> None:
    # The four-bar has one freedom; a third weld constraint would leave minus one.
    weld = (
        "{type: weld, parent: coupler, child: rocker, parent_point_m: [0.3, 0], child_point_m: [0.3, 0], home_deg: -90}"
    )
    (fault,) = faults_of(FOUR_BAR, f"model.closures={{c: {weld}, d2: {weld}}}")
    assert fault.key == "model.closures.d2"
    assert fault.message.startswith("3 of the 3 constraints")


def test_two_prescribed_motions_of_one_freedom_are_refused() -> None:
    drives = "drives={a: {type: motion, angle_deg: -90}, d: {type: motion, angle_deg: -90}}"
    (fault,) = faults_of(FOUR_BAR, drives)
    assert fault.key == "drives.d"
    assert fault.message.startswith("1 of the 1 constraint of d is redundant with")


def test_rates_that_tear_a_loop_are_refused() -> None:
    (fault,) = faults_of(FOUR_BAR, "initial.joints={a: {rate_rad_s: 1}, b: {rate_rad_s: 0}, d: {rate_rad_s: 0}}")
    assert fault.key == "initial.joints"
    assert "m/s" in fault.message


def test_motion_sets_the_start_of_its_joint() -> None:
    sine = "{type: motion, angle_deg: {type: sine, amplitude: 10, frequency_Hz: 2, offset: 5}}"
    _, hip, knee = scene_of(LEG, f"drives.knee={sine}").joints
    assert (knee.start, knee.rate) == (
        pytest.approx(math.radians(5.0), rel=1e-14),
        pytest.approx(math.radians(10.0) * 4 * math.pi, rel=1e-14),
    )
    assert hip.rate == 3.0


def test_a_start_that_misses_the_motion_is_refused_with_the_gap() -> None:
    sine = "{type: motion, angle_deg: {type: sine, amplitude: 10, frequency_Hz: 2, offset: 5}}"
    (place_fault, rate_fault) = faults_of(LEG, f"drives.hip={sine}")
    assert (place_fault.key, rate_fault.key) == ("initial.joints.hip.angle_deg", "initial.joints.hip.rate_rad_s")
    assert place_fault.message.startswith("got 20, but the drive of hip starts at 5, 15 away")
    (fault,) = faults_of(LEG, f"drives.knee={sine}", "initial={settle: true}")
    assert fault.key == "drives.knee"


def test_a_joint_without_a_start_starts_at_the_target_of_its_control() -> None:
    drive = "{type: pd, angle_deg: {type: constant, value: 50}, gain_Nm_per_rad: 1}"
    _, hip, knee = scene_of(LEG, f"drives={{knee: {drive}, hip: {drive}}}").joints
    assert math.degrees(knee.start) == pytest.approx(50.0)
    assert math.degrees(hip.start) == pytest.approx(20.0)


CHAIN = f"""
model:
  name: rope
  chain:
    count: 5
    link: {{{BAR}}}
    hinge: {{home_deg: 10, damping_Nm_s_per_rad: 0.01}}
    parent: hook
    parent_point_m: [0.1, 0]
    root_home_deg: 40
  bodies: {{hook: {{type: link, {BAR}}}}}
  joints: {{base: {{type: hinge, parent: ground, child: hook}}}}
initial: {{impact_angle_deg: 20, joints: {{hinge_3: {{angle_deg: -15}}}}}}
"""


def test_a_chain_is_bodies_and_hinges() -> None:
    scene = scene_of(CHAIN)
    assert [body.name for body in scene.rigid] == ["hook", *(f"link_{i}" for i in range(1, 6))]
    hinges = scene.joints[1:]
    assert [(c.name, c.parent, c.child) for c in hinges] == [
        (f"hinge_{i}", "hook" if i == 1 else f"link_{i - 1}", f"link_{i}") for i in range(1, 6)
    ]
    assert [math.degrees(c.start) for c in hinges] == pytest.approx([40, 10, -15, 10, 10])
    assert {c.law.damping for c in hinges} == {0.01}
    angle, at = -20.0, 0.1 * turn(math.radians(-20.0))
    for body, bend in zip(scene.rigid[1:], (40, 10, -15, 10, 10), strict=True):
        angle -= bend
        np.testing.assert_allclose(body.motion.position, at + 0.05 * turn(math.radians(angle)), atol=1e-14)
        at = at + 0.1 * turn(math.radians(angle))


def test_workspace_of_sliders_and_free_bodies_is_unbounded() -> None:
    assert all(body.workspace.length == math.inf for body in scene_of(LEG).rigid)
    assert all(body.workspace.length < 1.0 for body in scene_of(CHAIN).rigid)


def test_reduced_models_refuse_unsupported_parts() -> None:
    for change, message in (
        ("model.joints.pivot.damping_Nm_s_per_rad=0.1", "pivot has a spring, damper, stops or friction"),
        ("drives.pivot={type: torque, torque_Nm: 1}", "pivot is driven"),
        ("initial.settle=true", "initial.settle is true"),
    ):
        (fault,) = faults_of("pendulum", "method=reduced", "initial.impact_speed_rad_s=0", change)
        assert fault.key == "method"
        assert message in fault.message


def test_a_slider_on_a_flexible_link_is_refused() -> None:
    flexible = "model.bodies.thigh.flexible={youngs_modulus_Pa: 2e11}"
    knee = "model.joints.knee={type: slider, parent: thigh, child: shank, parent_point_m: [0.1, 0]}"
    (fault,) = faults_of(LEG, flexible, knee)
    assert fault.key == "model.joints.knee.parent"


def test_a_body_whose_mass_is_too_small_for_a_number_is_refused() -> None:
    text = LEG.replace(
        f"shank: {{type: link, {BAR}}}", "shank: {type: link, length_m: 1.0e-308, diameter_m: 0.003, density_kg_m3: 1}"
    )
    (fault,) = faults_of(text)
    assert (fault.key, fault.message) == ("model.bodies.shank", "got a mass of 0 kg by its shapes; allowed is more")
