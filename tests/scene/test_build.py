"""From scenario to scene: mass, places and motion by hand, and faults of parts that do not fit."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pytest
import support_refusals
from support_models import bent_arm
from support_runs import DENSITY, DIAMETER, GRAVITY_MOMENT, INERTIA, L_RB, LENGTH, scene_of

from granular_contact import load
from granular_contact.errors import SceneError
from granular_contact.scene import build
from granular_contact.scene.types import Scene

DOUBLE = """
model:
  name: double
  bodies:
    upper: {type: link, length_m: 0.3, diameter_m: 0.01, density_kg_m3: 7700}
    lower: {type: link, length_m: 0.2, diameter_m: 0.008, density_kg_m3: 2700}
  joints:
    shoulder: {type: hinge, parent: ground, child: upper, parent_point_m: [0.1, 0.2]}
    elbow: {type: hinge, parent: upper, child: lower, parent_point_m: [0.3, 0]}
initial: {impact_angle_deg: 30, impact_speed_rad_s: 2}
"""

BENT = bent_arm(0.01, 0.01, "medium: play_sand", "initial: {impact_angle_deg: 20}")


def about_pivot(scene: Scene) -> tuple[float, float]:
    """Inertia about the origin (kg m2) and moment of gravity with the mechanism level (N m), by hand from the parts."""
    inertia = sum(b.inertia + b.mass * float(np.sum(b.motion.position**2)) for b in scene.rigid)
    return inertia, 9.81 * sum(b.mass * float(np.hypot(*b.motion.position)) for b in scene.rigid)


faults_of = partial(support_refusals.faults_of, SceneError, scene_of)


def test_welded_bodies_are_one() -> None:
    scene = scene_of("pendulum_rigid")
    (body,) = scene.rigid
    assert body.name == "RB1+RB2+link"
    assert [(s.part, s.kind) for s in body.shapes] == [("RB1", "outline"), ("RB2", "round"), ("link", "round")]
    assert [c.name for c in scene.joints] == ["pivot"]
    assert not scene.links


def test_inertia_and_gravity_moment_of_the_rigid_pendulum() -> None:
    inertia, moment = about_pivot(scene_of("pendulum_rigid"))
    # Half a unit of the last digit that the numbers are given with, see support_runs.
    assert inertia == pytest.approx(INERTIA, abs=5e-8)
    assert moment == pytest.approx(GRAVITY_MOMENT, abs=5e-6)


def test_mass_of_the_rigid_pendulum_by_hand() -> None:
    parts = [0.019812 * 0.01905**2, 0.01524 * 0.01524**2, LENGTH * DIAMETER**2]
    # The same products: round-off.
    assert scene_of("pendulum_rigid").mass == pytest.approx(DENSITY * math.pi / 4 * sum(parts), rel=1e-14)
    assert scene_of("pendulum").mass == pytest.approx(DENSITY * math.pi / 4 * sum(parts), rel=1e-14)


@pytest.mark.parametrize("config", ["pendulum", "pendulum_rigid"])
@pytest.mark.parametrize("angle", [22.0, 61.5])
def test_surface_is_where_the_tip_touches(config: str, angle: float) -> None:
    scene = scene_of(config, f"initial.impact_angle_deg={angle}")
    reach, q1 = L_RB + LENGTH, math.radians(angle)
    # Round-off.
    assert scene.surface == pytest.approx(-reach * math.sin(q1), rel=1e-14)
    np.testing.assert_allclose(scene.tip_position, [reach * math.cos(q1), -reach * math.sin(q1)], rtol=1e-14)
    assert scene.tip[0] == ("link" if config == "pendulum" else "RB1+RB2+link")


@pytest.mark.parametrize("config", ["pendulum", "pendulum_rigid"])
def test_start_is_a_turn_about_the_pivot_into_the_sand(config: str) -> None:
    scene = scene_of(config)
    for body in (*scene.rigid, *scene.links):
        x, y = body.motion.position
        assert body.motion.rate == -6.24
        # omega x r; round-off.
        np.testing.assert_allclose(body.motion.velocity, [6.24 * y, -6.24 * x], atol=1e-15)
    assert scene.rigid[0].motion.velocity[1] < 0.0


def test_given_surface_below_the_tip_is_taken() -> None:
    assert scene_of("pendulum", "surface_height_m=-0.2").surface == -0.2


def test_vacuum_has_no_surface_and_no_medium() -> None:
    scene = scene_of("pendulum", "medium=null")
    assert scene.media == ()
    assert scene.surface is None


def test_hinge_chain() -> None:
    scene = scene_of(DOUBLE)
    upper, lower = scene.rigid
    axis = np.array([math.cos(math.radians(30)), -math.sin(math.radians(30))])
    start = np.array([0.1, 0.2])
    # Centres of two bars in one line from the shoulder; round-off.
    np.testing.assert_allclose(upper.motion.position, start + 0.15 * axis, atol=1e-15)
    np.testing.assert_allclose(lower.motion.position, start + 0.4 * axis, atol=1e-15)
    assert (scene.pivot.name, scene.pivot.parent) == ("shoulder", None)
    elbow = scene.joints[1]
    for name, point in ((elbow.parent, elbow.parent_point), (elbow.child, elbow.child_point)):
        np.testing.assert_allclose(scene.body(name).motion.world(point), start + 0.3 * axis, atol=1e-15)
    # Both turn about the shoulder at 2 rad/s, clockwise.
    np.testing.assert_allclose(lower.motion.velocity, 2 * 0.4 * np.array([axis[1], -axis[0]]), atol=1e-15)
    assert scene.tip[0] == "lower"
    np.testing.assert_allclose(scene.tip_position, start + 0.5 * axis, atol=1e-15)


def test_tether_reaches_as_far_as_the_stretched_chain() -> None:
    upper, lower = scene_of(DOUBLE).rigid
    # From the shoulder, wherever that is; round-off.
    for body, at, far in ((upper, 0.15, 0.3), (lower, 0.1, 0.5), (lower, -0.1, 0.3)):
        np.testing.assert_array_equal(body.workspace.root, (0.1, 0.2))
        assert body.workspace.radius(np.array([at, 0.0])) == pytest.approx(far, rel=1e-14)


def test_tether_of_the_flexible_link() -> None:
    (link,) = scene_of("pendulum").links
    # The way from the pivot over the joints: here one straight line; round-off.
    assert link.workspace.radius(np.array([LENGTH, 0.0])) == pytest.approx(L_RB + LENGTH, rel=1e-14)


def test_weld_at_an_angle() -> None:
    scene = scene_of(BENT)
    (body,) = scene.rigid
    angles = np.radians([20.0, 80.0])
    elbow = 0.2 * np.array([math.cos(angles[0]), -math.sin(angles[0])])
    end = elbow + 0.1 * np.array([math.cos(angles[1]), -math.sin(angles[1])])
    cylinder = next(s for s in body.shapes if s.part == "finger")
    # Round-off.
    np.testing.assert_allclose(body.motion.world(cylinder.points[0]), elbow, atol=1e-15)
    np.testing.assert_allclose(body.motion.world(cylinder.points[1]), end, atol=1e-15)
    assert scene.surface == pytest.approx(end[1], rel=1e-14)
    assert [s.free for s in body.shapes] == [False, True]
    # Parallel axes by hand, masses 2 : 1; round-off.
    mass = DENSITY * math.pi / 4 * 0.01**2 * np.array([0.2, 0.1])
    centers = np.array([0.5 * elbow, 0.5 * (elbow + end)])
    bars = mass * (np.array([0.2, 0.1]) ** 2 / 12 + 0.01**2 / 16)
    want = (bars + mass * np.sum(centers**2, axis=1)).sum()
    assert about_pivot(scene)[0] == pytest.approx(want, rel=1e-13)


@pytest.mark.parametrize(
    ("joint", "key"),
    [
        ("{type: hinge, parent: beam, child: hook, parent_point_m: [0.1, 0]}", "model.joints.hang.parent_point_m"),
        ("{type: hinge, parent: beam, child: hook, parent_point_m: [0.2, 0.01]}", "model.joints.hang.parent_point_m"),
    ],
)
def test_joints_sit_at_the_ends_of_a_flexible_link(joint: str, key: str) -> None:
    (fault,) = faults_of(with_beam("[0, 0]", joint))
    assert fault.key == key
    assert "[0, 0]" in fault.message
    assert "[0.2, 0]" in fault.message


def test_child_joint_inside_a_flexible_link_is_refused() -> None:
    (fault,) = faults_of(with_beam("[0.05, 0]", "{type: hinge, parent: beam, child: hook, parent_point_m: [0.2, 0]}"))
    assert fault.key == "model.joints.root.child_point_m"
    assert "0.05" in fault.message


def test_joints_at_both_ends_of_a_flexible_link_are_fine() -> None:
    scene = scene_of(with_beam("[0, 0]", "{type: hinge, parent: beam, child: hook, parent_point_m: [0.2, 0]}"))
    assert [(c.kind, c.parent, c.child) for c in scene.joints] == [
        ("hinge", None, "beam"),
        ("hinge", "beam", "hook"),
    ]
    assert not scene.links[0].free


def with_beam(root: str, joint: str) -> str:
    return f"""
model:
  name: hooked
  bodies:
    beam:
      type: link
      length_m: 0.2
      diameter_m: 0.006
      density_kg_m3: 7700
      flexible: {{youngs_modulus_Pa: 2.0e+11}}
    hook: {{type: link, length_m: 0.1, diameter_m: 0.006, density_kg_m3: 7700}}
  joints:
    root: {{type: hinge, parent: ground, child: beam, child_point_m: {root}}}
    hang: {joint}
initial: {{impact_angle_deg: 10}}
"""


def test_stiffness_follows_from_young() -> None:
    (link,) = scene_of(with_beam("[0, 0]", "{type: weld, parent: beam, child: hook, parent_point_m: [0.2, 0]}")).links
    # E pi d^4 / 64 and E pi d^2 / 4; round-off.
    assert link.bending_stiffness == pytest.approx(2e11 * math.pi / 64 * 0.006**4, rel=1e-14)
    assert link.axial_stiffness == pytest.approx(2e11 * math.pi / 4 * 0.006**2, rel=1e-14)


def test_model_welded_to_the_ground_is_refused() -> None:
    (fault,) = faults_of(BENT.replace("hinge", "weld"), "medium=null")
    assert fault.key == "model.joints"
    assert "ground" in fault.message


def test_speed_without_a_hinge_is_refused() -> None:
    cantilever = with_beam("[0, 0]", "{type: weld, parent: beam, child: hook, parent_point_m: [0.2, 0]}")
    cantilever = cantilever.replace("root: {type: hinge", "root: {type: weld")
    (fault,) = faults_of(cantilever, "initial.impact_speed_rad_s=2.5")
    assert fault.key == "initial.impact_speed_rad_s"
    assert "2.5" in fault.message


def test_several_faults_come_together() -> None:
    text = with_beam("[0, 0]", "{type: hinge, parent: beam, child: hook, parent_point_m: [0.1, 0]}")
    keys = {f.key for f in faults_of(text, "medium=play_sand", "surface_height_m=0.5", "bed.depth_m=0.1")}
    assert keys == {"bed.depth_m", "model.joints.hang.parent_point_m"}


def test_coefficients_of_the_medium_arrive() -> None:
    (medium,) = scene_of("pendulum", "medium.withdrawing={eta_v: 0.5, lambda: 1.7}").media
    assert (medium.density, medium.eta_d, medium.eta_h) == (2500.0, 6.5, 8.0)
    assert (medium.plunging.eta_v, medium.plunging.lam) == (22.0, 1.1)
    assert (medium.withdrawing.eta_v, medium.withdrawing.lam) == (0.5, 1.7)
    (same,) = scene_of("pendulum").media
    assert same.withdrawing == same.plunging


@pytest.mark.parametrize("config", ["walker", "walker_in_space"])
def test_an_unknown_part_is_reported_with_similar_names(config: str) -> None:
    scene = build(load(config).scenario)
    assert scene.body("trunk").name == "trunk"
    for find in (scene.body, scene.joint):
        with pytest.raises(KeyError, match=r"no (body|joint) 'trnk'; did you mean trunk"):
            find("trnk")
    with pytest.raises(KeyError, match="no link that bends 'trunk'; there are: none"):
        scene.link_length("trunk")
