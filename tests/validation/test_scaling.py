"""The studies of long chains: how they judge, and what needs no clock."""

from __future__ import annotations

import numpy as np
import pytest

from validation import chains, scaling


def cost(solve: float) -> scaling.Cost:
    return scaling.Cost(solve=solve, whole=2 * solve, steps=200, iterations=500, jacobians=10)


def costs(power: float, load: float) -> scaling.Costs:
    return {
        (kind, case, n): cost(2e-4 * n**power * (1.0 if case == scaling.BARE else load))
        for kind in scaling.KINDS
        for case in scaling.CASES
        for n in scaling.SIZES
    }


@pytest.mark.parametrize(("power", "load", "held"), [(1.0, 1.02, [True, True, True]), (1.3, 1.8, [False] * 3)])
def test_claims_are_judged_by_their_numbers(power: float, load: float, held: list[bool]) -> None:
    made = costs(power, load)
    assert [claim.held for claim in scaling.claims(made)] == held
    assert f"{power:.2f}" in scaling.claims(made)[0].detail
    assert scaling.slope(made, "rigid", "all") == pytest.approx(power)
    assert "| rigid | 256 | all |" in scaling.tables(made)


def test_chains_are_as_asked() -> None:
    scene = chains.chain(16, immersed=0.25)
    assert len(scene.rigid) == 16
    assert scene.mass == pytest.approx(chains.DENSITY * np.pi / 4 * chains.DIAMETER**2 * chains.LENGTH)
    # The lowest quarter of a straight chain is below the surface.
    lowest = scene.tip_position[1]
    assert scene.surface == pytest.approx(0.75 * lowest)
    assert chains.strips(1) * 1 == chains.strips(16) * 16 == 16


def test_cost_of_the_load_is_linear_in_the_number_of_links() -> None:
    """Entries of its tangent, and calls from Python, which are as many for 64 links as for 16."""
    entries, calls = [], []
    for links in (16, 64):
        system = scaling.build(scaling.set_up("rigid", "all", links))
        trajectory = scaling.solve(system)
        (batch,) = system.bed.load.batches
        entries.append(batch.entries)
        cost = trajectory.cost
        calls.append(cost.load_calls / (cost.newton_iterations + cost.steps))
    assert entries[1] == 4 * entries[0]
    # One for each iteration, one more for each step.
    assert all(0.9 < each < 1.1 for each in calls)


@pytest.mark.slow
def test_mujoco_and_minimal_coordinates_agree() -> None:
    pytest.importorskip("mujoco")
    from validation import peer_chains

    start = (31.0, 6.24)
    fine = peer_chains.minimal(4, 1e-6, start)
    theirs = peer_chains.mujoco(4, 3200, start, integrator="RK4", native=True)
    # Two programs, one law; ours is within 0.02 um of its limit, MuJoCo's fourth order within less.
    assert peer_chains.distance(theirs, fine) < 0.1
    plain = [peer_chains.distance(peer_chains.mujoco(4, steps, start), fine) for steps in (1600, 3200)]
    assert plain[0] / plain[1] == pytest.approx(2.0, abs=0.2)  # Euler, of first order


@pytest.mark.slow
def test_a_chain_of_links_that_bend_in_the_sand_seldom_repeats_a_step() -> None:
    """Where bristles of many links yield at once iterations go to and fro; 262 steps and 263 Jacobians were taken."""
    cost = scaling.once(scaling.set_up("flexible", "lowest quarter", 16), empty=False)
    assert cost.steps < 230  # 205 when written, of 200
    assert cost.jacobians < 200  # 124


@pytest.mark.slow
def test_chains_that_bend_take_at_most_three_times_the_iterations_in_sand() -> None:
    """Unresolved vibrations of links that bend let bristles yield and hold anew; without sand it takes 432 and 4."""
    cost = scaling.once(scaling.set_up("flexible", "lowest quarter", 32), empty=False)
    assert cost.iterations < 1300  # 1165 when written, of 205 steps
    assert cost.jacobians < 180  # 148
