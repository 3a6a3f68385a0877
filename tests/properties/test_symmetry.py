"""Forces are mirrored with the scene and do not depend on its place; above the surface there are none."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_properties import COMMON, State, floors, states

from granular_contact.config import load_scenario
from granular_contact.scene import build
from validation.random_scenes.images import AWAY, shifted
from validation.random_scenes.scenes import solve, write
from validation.random_scenes.tracks import track

FAST = settings(max_examples=80, deadline=None)
RANDOM = st.randoms(use_true_random=False)
USUAL = st.one_of(states(COMMON), states(COMMON), floors(COMMON))
ANY = st.one_of(states(), states(), states(), floors())
MIRROR = np.array([-1.0, 1.0])


@FAST
@given(ANY)
def test_mirror_image_has_the_mirrored_force(body: State) -> None:
    F, totals = body.forces()
    run = body.run.copy()
    run["side"] *= -1
    run["turn"] *= -1
    mirrored = body.with_(
        P=body.P * MIRROR,
        V=body.V * MIRROR,
        anchors=body.anchors * MIRROR,
        profile=(body.profile * MIRROR)[::-1].copy(),
        run=run,
    )
    G, seen = mirrored.forces()
    # The same operations with other signs, but a slope is measured from its other end: round-off of 0.3 m in depths
    # and stretches, 1e-16 m next to u_y of at least 1e-5 m; times a dozen operations.
    scale = body.scale()
    np.testing.assert_allclose(G, F * MIRROR, atol=1e-9 * scale)
    np.testing.assert_allclose(seen, totals * [-1.0, 1.0, -1.0], atol=1e-9 * scale)


@FAST
@given(USUAL, RANDOM)  # round-off decides what just touches, or lies just between two layers or strips
def test_shift_of_everything_changes_nothing_but_the_moment(body: State, rng: Random) -> None:
    shift = np.array([rng.uniform(-2, 2), rng.uniform(-2, 2)])
    F, totals = body.forces()
    G, moved = body.with_(P=body.P + shift, anchors=body.anchors + shift, profile=body.profile + shift).forces()
    # Round-off of 2 m, 4e-16 m, in stretches of u_y >= 1e-5 m.
    scale = body.scale()
    np.testing.assert_allclose(G, F, atol=1e-8 * scale)
    moment = shift[0] * totals[:, 1] - shift[1] * totals[:, 0]
    np.testing.assert_allclose(moved[:, 2] - totals[:, 2], moment, atol=1e-7 * scale)


@FAST
@given(ANY)
def test_the_order_of_the_stations_does_not_matter(body: State) -> None:
    run = body.run.copy()
    run["cap"] = False  # which is at the last station only
    turned = run.copy()
    turned["side"] *= -1
    turned["turn"] *= -1
    F, totals = body.with_(run=run).forces()
    back = body.with_(P=body.P[::-1].copy(), V=body.V[::-1].copy(), anchors=body.anchors[::-1].copy(), run=turned)
    G, seen = back.forces()
    if body.kind == "ball":  # the first of its two stations takes the force
        G = G[::-1]
    # Round-off: xi and 1 - xi trade places.
    scale = body.scale()
    np.testing.assert_allclose(G[::-1], F, atol=1e-9 * scale)
    np.testing.assert_allclose(seen, totals, atol=1e-9 * scale)


@FAST
@given(ANY)
def test_totals_are_those_of_the_stations(body: State) -> None:
    F, totals = body.forces()
    scale = body.scale()
    np.testing.assert_allclose(F.sum(axis=0), totals[:, :2].sum(axis=0), atol=1e-12 * len(F) * scale)
    moment = float((body.P[:, 0] * F[:, 1] - body.P[:, 1] * F[:, 0]).sum())
    np.testing.assert_allclose(moment, totals[:, 2].sum(), atol=1e-12 * len(F) * scale)


@FAST
@given(ANY, st.floats(0.0, 10.0))
def test_forces_above_the_surface_are_zero(body: State, height: float) -> None:
    top = float(body.profile[:, 1].max())
    lift = np.array([0.0, top - float(body.P[:, 1].min()) + float(body.run["drop"][0]) + height + 1e-12])
    above = body.with_(P=body.P + lift, anchors=body.anchors + lift)
    F, totals = above.forces()
    assert not F.any()
    assert not totals.any()


ENDS, TOLERANCE = 0.1, 1e-5  # s; of Newton's method, the usual one


def falling_rod(modulus: float, tolerance: float) -> dict[str, Any]:
    """A flexible rod that flies into level sand, one end first, by fixed steps."""
    rod = {"type": "link", "length_m": 0.3, "diameter_m": 0.012, "density_kg_m3": 7700.0}
    start = {"angle_deg": 20.0, "rate_rad_s": -3.0, "vx_m_s": -0.9, "vy_m_s": -0.7}
    return {
        "model": {
            "name": "rod",
            "bodies": {"rod": rod | {"flexible": {"youngs_modulus_Pa": modulus}}},
            "joints": {"root": {"type": "free", "parent": "ground", "child": "rod"}},
        },
        "medium": "poppy_seeds_close",
        "bed": {"height_m": -0.11},
        "load": {},
        "initial": {"joints": {"root": start}},
        "solver": {"end_time_s": ENDS, "step_s": 2e-4, "rest_time_s": None, "tolerance": tolerance},
        "output": {"bodies": "all"},
    }


def driven_pendulum() -> dict[str, Any]:
    """Two rigid links that a controller swings through level sand, by fixed steps."""
    link = {"type": "link", "length_m": 0.15, "diameter_m": 0.012, "density_kg_m3": 7700.0}
    hinge = {"type": "hinge", "child": "lower", "parent": "upper", "parent_point_m": [0.15, 0.0]}
    tree = falling_rod(3e8, TOLERANCE)
    tree["model"] = {
        "name": "pendulum",
        "bodies": {"upper": link, "lower": link},
        "joints": {"hip": {"type": "hinge", "parent": "ground", "child": "upper"}, "knee": hinge},
    }
    target = {"type": "sine", "amplitude": 20.0, "frequency_Hz": 5.0}
    tree["drives"] = {
        "knee": {"type": "pd", "angle_deg": target, "gain_Nm_per_rad": 3.0, "rate_gain_Nm_s_per_rad": 0.1}
    }
    return tree | {"initial": {"joints": {"hip": {"angle_deg": 40.0, "rate_rad_s": 3.0}}}}


def apart(one: dict[str, Any], other: dict[str, Any], folder: Path) -> float:
    """How far the rods of two scenes with the same steps are apart at most (m)."""
    mine, theirs = (track(solve(tree, folder), tree, 0.0) for tree in (one, other))
    return float(np.abs(mine.place - theirs.place).max())


def free_fall(force: float, tree: dict[str, Any], folder: Path) -> float:
    """How far a force, of those of the scene, moves its mass until the end (m), where nothing holds it."""
    scene = build(load_scenario(write(tree, folder)))
    return 0.5 * force * scene.force_scale / scene.mass * ENDS**2


@pytest.mark.parametrize("tree", [falling_rod(3e8, TOLERANCE), falling_rod(2e11, TOLERANCE), driven_pendulum()])
def test_motion_is_the_same_after_translation_by_1_km(tree: dict[str, Any], tmp_path: Path) -> None:
    # Depths and stretches are of places in the world, known to the round-off of a kilometre, next to the yield
    # displacement of 10 um: static forces are off by as much of themselves, and no more than the scene's forces.
    off = float(np.spacing(np.hypot(*AWAY))) / 1e-5
    assert apart(tree, shifted(tree), tmp_path) < free_fall(off, tree, tmp_path)


def test_residual_of_iterations_moves_a_free_rod_within_the_tolerance(tmp_path: Path) -> None:
    tree, exact = (falling_rod(3e8, tolerance) for tolerance in (TOLERANCE, 1e-3 * TOLERANCE))
    # The tolerance is of the root mean square of 20 residuals, of which 5 push the rod the same way.
    most = np.sqrt(20.0 * 5.0) * TOLERANCE
    assert apart(tree, exact, tmp_path) < free_fall(float(most), tree, tmp_path)
