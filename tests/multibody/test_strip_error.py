"""What a departure of a motion is made of: the freedoms of mechanisms, and that both methods find the same."""

from __future__ import annotations

import numpy as np
import pytest
from support_runs import FOUR_BAR, scene_of

from granular_contact.mechanics import strip_error as module
from granular_contact.mechanics.freedoms import freedoms
from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.run import begin

FOUR_BAR_FALLS = FOUR_BAR + "medium: play_sand\nsurface_height_m: -0.3\nsolver: {end_time_s: 0.1}\n"


def motion(config: str, *sets: str) -> Kinematics:
    begun = begin(scene_of(FOUR_BAR_FALLS if config == "four_bar" else config, *sets), None, None)
    begun.solving.advance()
    assert begun.system is not None
    return Kinematics(begun.system, begun.solving.trajectory())


# Config, and how many freedoms it has: joints that nothing prescribes, three of what flies free.
MECHANISMS = {"double_pendulum": 2, "stepping_leg": 4, "free_link": 3, "chain_flexible": 4, "four_bar": 1}


@pytest.mark.parametrize("config", MECHANISMS)
def test_freedoms_obey_all_joints(config: str) -> None:
    moved = motion(config, "solver.end_time_s=0.05")
    free = freedoms(moved)
    assert free.W.shape[2] == MECHANISMS[config]
    for joint in moved.scene.joints:
        rows = moved.constraints.held(joint).J
        # A link that bends is rigid here, its ends turn with it: rows of its slopes are of its shape, as far as it is.
        assert np.abs(rows[:, :2] @ free.W).max(initial=0.0) < 1e-9


@pytest.mark.parametrize("config", ["double_pendulum", "free_link"])
def test_a_motion_of_rigid_bodies_lies_in_its_freedoms(config: str) -> None:
    moved = motion(config, "solver.end_time_s=0.3")
    W, v, mass = freedoms(moved).W, moved.trajectory.v, moved.trajectory.mass
    momenta = W.transpose(0, 2, 1) @ mass
    rates = np.linalg.solve(momenta @ W, (momenta @ v[:, :, None]))
    # Joints are held to the tolerance of Newton's method.
    np.testing.assert_allclose((W @ rates)[:, :, 0], v, atol=1e-6 * np.abs(v).max())


def test_both_methods_find_the_same_error() -> None:
    """Of a rod with 8 strips that topples over."""
    sets = "load.strips_per_rigid_part=8", "solver.step_s=2e-4", "solver.accuracy=null", "medium=rft3d_sand"
    found = [module.strip_error(motion("free_link", *sets, f"method={by}"), 1e-5) for by in ("minimal", "engine")]
    # The two motions differ by what Newton's method leaves.
    assert found[0] == pytest.approx(found[1], rel=0.2)
    assert found[0] > 2e-4
