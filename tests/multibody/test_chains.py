"""Chains: one link is the pendulum; many hang and swing as a chain does; beams that stiffen become rigid links."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import j0, jn_zeros
from support_models import chain
from support_runs import order, simulate, tip_error

PENDULUM = """
model:
  name: one
  bodies: {link: {type: link, length_m: 0.3, diameter_m: 0.006, density_kg_m3: 7700}}
  joints: {pivot: {type: hinge, parent: ground, child: link}}
medium: play_sand
initial: {impact_angle_deg: 40, impact_speed_rad_s: 5}
"""


STRIKE = "initial={impact_angle_deg: 40, impact_speed_rad_s: 5}"


def test_a_chain_of_one_link_is_a_pendulum() -> None:
    single_link, pendulum = simulate(chain(1, 0.3), "medium=play_sand", STRIKE), simulate(PENDULUM)
    for mine, theirs in (
        ("hinge_1_angle_deg", "pivot_angle_deg"),
        ("hinge_1_rate_rad_s", "pivot_rate_rad_s"),
        ("tip_x_m", "tip_x_m"),
        ("depth_m", "depth_m"),
        ("granular_work_J", "granular_work_J"),
    ):
        np.testing.assert_allclose(single_link[mine], pendulum[theirs], rtol=1e-8, atol=1e-12)
    assert single_link.summary["stopping_time_s"] == pytest.approx(pendulum.summary["stopping_time_s"], rel=1e-8)
    assert single_link.summary["stopping_time_s"] > 0.01


def hanging(count: int, mode: int) -> str:
    """A chain of 1 m that hangs, bent as the continuous chain is in a mode, and let go."""
    root = jn_zeros(0, mode)[-1]
    height = np.linspace(1.0, 0.0, count + 1)  # of the joints above the free end
    shape = 1e-3 * j0(root * np.sqrt(height))
    lean = np.degrees(np.arcsin(np.diff(shape) * count))
    bends = [90.0 - lean[0], *(-np.diff(lean))]
    joints = ", ".join(f"hinge_{i + 1}: {{angle_deg: {bend!r}}}" for i, bend in enumerate(map(float, bends)))
    quarter = np.pi / 2 / (0.5 * root * np.sqrt(9.81))
    return chain(
        count,
        1.0 / count,
        f"initial: {{joints: {{{joints}}}}}",
        f"solver: {{end_time_s: {1.3 * quarter}, tolerance: 1e-9, rest_time_s: null}}",
    )


def frequency(count: int, mode: int) -> float:
    """Angular frequency (rad/s) from the time at which the tip first hangs below its pivot."""
    run = simulate(hanging(count, mode), "solver.step_s=5e-4")
    x, time = run["tip_x_m"], run["time_s"]
    k = int(np.flatnonzero(x[1:] * x[0] <= 0.0)[0])
    return np.pi / 2 / float(time[k] + (time[k + 1] - time[k]) * x[k] / (x[k] - x[k + 1]))


@pytest.mark.slow
@pytest.mark.parametrize("mode", [1, 2])
def test_frequencies_of_many_links_approach_those_of_the_hanging_chain(mode: int) -> None:
    exact = 0.5 * jn_zeros(0, mode)[-1] * np.sqrt(9.81)
    counts = [4, 8, 16] if mode == 1 else [16, 32, 64]  # a higher mode has shorter waves at its lower end
    errors = [abs(frequency(count, mode) / exact - 1.0) for count in counts]
    # Straight links in place of a curve: second order in their length, which is (j_k / 2 n)^2 / 6 of the square.
    assert errors[-1] < 2 * (0.5 * jn_zeros(0, mode)[-1] / counts[-1]) ** 2 / 6
    assert order([1 / n for n in counts], errors) == pytest.approx(2.0, abs=0.2)


@pytest.mark.slow
def test_beams_that_stiffen_become_rigid_links() -> None:
    times, errors, moduli = np.linspace(0.0, 0.1, 51), [], [2e7, 1e8, 5e8]
    settings = ("solver={step_s: 1e-4, end_time_s: 0.1, rest_time_s: null, tolerance: 1e-7}", STRIKE)
    rigid = simulate(chain(3, 0.1), *settings)
    for modulus in moduli:
        beam = f"{{youngs_modulus_Pa: {modulus}, elements: 4}}"
        errors.append(tip_error(simulate(chain(3, 0.1, flexible=beam), *settings), rigid, times))
    # Deflections go with the inverse of the stiffness; what is left is the rotary inertia of sections, which cables
    # have not: 3 (d / 4 l)^2 = 7e-4 of the links' inertia, here 5e-6 m.
    assert errors[-1] < 5e-5
    assert order([1 / modulus for modulus in moduli], errors) == pytest.approx(1.0, abs=0.2)


@pytest.mark.slow
def test_several_links_meet_the_sand_at_once() -> None:
    run = simulate(
        chain(6, 0.05),
        "medium=play_sand",
        "initial={impact_angle_deg: 10, impact_tip_speed_m_s: 2}",
        "solver.step_s=1e-4",
    )
    contacts = run.summary["contacts"]
    assert sum(bool(intervals) for intervals in contacts.values()) >= 3
    # By the columns of the bodies the whole force is that of the terms.
    for axis in "xy":
        bodies = np.sum([run[f"link_{i}_granular_{axis}_N"] for i in range(1, 7) if f"link_{i}" in contacts], axis=0)
        terms = np.sum([run[f"{term}_force_{axis}_N"] for term in run.terms], axis=0)
        np.testing.assert_allclose(bodies, terms, atol=1e-9 * np.abs(terms).max())
    assert run.summary["energy"]["imbalance_relative"] < 1e-3
