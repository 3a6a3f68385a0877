"""Estimated errors by strips: degrees of freedom of mechanisms, and agreement of both methods."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import FOUR_BAR, scene_of

from granular_contact.mechanics import strip_error as module
from granular_contact.mechanics.freedoms import freedoms
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.run import begin, run

FOUR_BAR_FALLS = FOUR_BAR + "medium: play_sand\nsurface_height_m: -0.3\nsolver: {end_time_s: 0.1}\n"


def motion(config: str, *sets: str) -> Kinematics:
    begun = begin(scene_of(FOUR_BAR_FALLS if config == "four_bar" else config, *sets))
    begun.solving.advance()
    assert begun.system is not None
    return Kinematics(begun.system, begun.solving.trajectory())


# Config, and how many freedoms it has: joints that nothing prescribes, three of what flies free, two of each link that
# bends, which are four in the chain.
MECHANISMS = {"double_pendulum": 2, "stepping_leg": 4, "free_link": 3, "chain_flexible": 12, "four_bar": 1}


@pytest.mark.parametrize("config", MECHANISMS)
def test_degrees_of_freedom_obey_all_joints(config: str) -> None:
    moved = motion(config, "solver.end_time_s=0.05")
    free = freedoms(moved)
    assert free.W.shape[2] == MECHANISMS[config]
    for joint in moved.scene.joints:
        assert np.abs(moved.constraints.held(joint).J @ free.W).max(initial=0.0) < 1e-9


@pytest.mark.parametrize("config", ["double_pendulum", "free_link"])
def test_rigid_motion_lies_in_the_degrees_of_freedom(config: str) -> None:
    moved = motion(config, "solver.end_time_s=0.3")
    W, v, mass = freedoms(moved).W, moved.trajectory.v, moved.trajectory.mass
    momenta = W.transpose(0, 2, 1) @ mass
    rates = np.linalg.solve(momenta @ W, (momenta @ v[:, :, None]))
    # Joints are held to the tolerance of Newton's method.
    np.testing.assert_allclose((W @ rates)[:, :, 0], v, atol=1e-6 * np.abs(v).max())


REED = """
model:
  name: reed
  bodies:
    reed: {type: link, length_m: 0.2, width_m: 0.02, thickness_m: 0.002, density_kg_m3: 1000.0,
      flexible: {youngs_modulus_Pa: 2.0e+8, elements: 4}}
  joints: {clamp: {type: hinge, parent: ground, child: reed}}
drives: {clamp: {type: motion, angle_deg: {type: ramp, from: 0.0, to: 30.0, duration_s: 0.1}}}
medium: quikrete_play_sand_rft
surface_height_m: -0.03
solver: {end_time_s: 0.1, step_s: 1.0e-4}
"""


@pytest.mark.parametrize("hinged_at", [0.0, 0.2])
def test_links_bend_with_their_first_natural_frequency(hinged_at: float) -> None:
    """Held at either end; the first root of the clamped beam's equation is 1.8751."""
    at = f"model.joints.clamp.child_point_m=[{hinged_at}, 0.0]"
    moved = motion(REED, at, "medium=null", "surface_height_m=null", "solver.end_time_s=1e-3")
    free, link = freedoms(moved), moved.system.links["reed"].link
    mass = free.W[0].T @ moved.trajectory.mass @ free.W[0]
    squares = np.linalg.eigvals(np.linalg.solve(mass, free.K[0])).real
    scale = link.bending_stiffness / (link.mass_per_length * link.length**4)
    assert np.sqrt(squares.min() / scale) == pytest.approx(1.8751**2, rel=0.03)  # Ritz, and four elements


def test_errors_of_a_link_that_only_bends_are_reported() -> None:
    """A reed that a prescribed motion swings into the sand, where it bends by a third of its length."""
    few, many = (motion(REED, f"load.strips_per_element={n}") for n in (2, 16))
    off = np.abs((few.trajectory.q - many.trajectory.q) * many.lever).max() / many.path_length
    assert off > 5e-3
    assert 0.25 < module.strip_error(few, 1e-3) / off < 4.0


def test_both_methods_find_the_same_error() -> None:
    """Of a rod with 8 strips that topples over."""
    sets = "load.strips_per_rigid_part=8", "solver.step_s=2e-4", "solver.accuracy=null", "medium=rft3d_sand"
    errors = [module.strip_error(motion("free_link", *sets, f"method={by}"), 1e-5) for by in ("minimal", "engine")]
    # The two motions differ by what Newton's method leaves.
    assert errors[0] == pytest.approx(errors[1], rel=0.2)
    assert errors[0] > 2e-4


def test_a_bending_link_out_of_reach_is_left_out_of_the_strip_estimate() -> None:
    """It has a shape on which this medium does not act, as it need not."""
    text = """
model:
  name: ball with a tail
  bodies:
    hub: {type: rigid, density_kg_m3: 7700, shapes: [{type: sphere, diameter_m: 0.15, center_m: [0.075, -0.065]}]}
    tail: {type: link, length_m: 0.04, diameter_m: 0.03, density_kg_m3: 200,
      flexible: {bending_stiffness_N_m2: 0.1, elements: 4}}
  joints: {pivot: {type: hinge, parent: ground, child: hub}, clamp: {type: weld, parent: hub, child: tail}}
initial: {impact_angle_deg: 80}
medium: {law: katsuragi_durian, stiffness_N_m: 3700, drag_length_m: 0.54}
surface_height_m: -0.12
solver: {end_time_s: 0.02, step_s: 1.0e-4}
"""
    assert run(scene_of(text)).status.code == "end_time"


@pytest.mark.parametrize("method", ["minimal", "engine"])
def test_strip_estimate_survives_a_numerically_singular_mass_matrix(method: str) -> None:
    """Its matrix of masses is singular to round-off."""
    text = """
model:
  name: heavy on light
  bodies:
    light: {type: link, length_m: 0.05, diameter_m: 0.02, density_kg_m3: 1.0e-9}
    heavy: {type: link, length_m: 0.1, width_m: 1.0e+9, thickness_m: 0.007, density_kg_m3: 1200}
  joints: {a: {type: hinge, parent: ground, child: light}, b: {type: hinge, parent: light, child: heavy}}
initial: {joints: {a: {angle_deg: -120, rate_rad_s: -0.4}, b: {angle_deg: 100, rate_rad_s: -5}}}
medium: {law: drft, zeta: 2.0, density_kg_m3: 600, lambda: 0, surface_drop_m: 0.01}
solver: {end_time_s: 0.012, step_s: 6.0e-4}
"""
    assert run(scene_of(text, f"method={method}")).status.code == "end_time"
