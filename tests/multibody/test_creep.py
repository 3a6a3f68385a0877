"""The warning about motion left at rest: given where a mechanism still creeps, and not where it stands."""

import numpy as np
import pytest

from granular_contact import load, simulate
from granular_contact.mechanics.accuracy import displacement_left

REST_TIME, REST_SPEED = 0.02, 1e-3


def damped_strip(damping, *, in_space):
    """A clamped link that sags under its weight, with so much internal damping (N m2 s) that it cannot vibrate."""
    flexible = {"bending_stiffness_N_m2": 0.5, "elements": 4, "bending_damping_N_m2_s": damping}
    link = {"type": "link", "length_m": 0.5, "diameter_m": 0.006, "density_kg_m3": 2700, "flexible": flexible}
    clamp = {"type": "weld", "parent": "ground", "child": "link"}
    model = {"name": "strip", "in_space": in_space, "bodies": {"link": link}, "joints": {"clamp": clamp}}
    return load({"model": model, "medium": None, "solver": {"end_time_s": 30, "accuracy": 1e-2}})


def creeping(results):
    """Warnings about creep."""
    return [warning for warning in results.warnings if "creeps" in warning]


@pytest.mark.parametrize("decay", [0.05, 0.5])
def test_exponential_decay_leaves_speed_times_time_constant(decay):
    time = np.linspace(0.0, 1.0, 4001)
    speeds = REST_SPEED * np.exp(-(time - 1.0) / decay)[:, None] * [1.0, -2.0]
    # Of the closed form only round-off of the decay over the rest time is left.
    until_the_end = 1.0 - np.exp(-2.0 / decay)
    remaining = displacement_left(time, speeds, REST_TIME, REST_SPEED, 3.0)
    np.testing.assert_allclose(remaining, 2.0 * REST_SPEED * decay * until_the_end, rtol=1e-9)


def test_vibration_and_runs_at_their_end_have_no_motion_left():
    time = np.linspace(0.0, 1.0, 4001)
    vibration = REST_SPEED * np.sin(2.0 * np.pi * 60.0 * time)[:, None]  # more than a period in the rest time
    assert displacement_left(time, vibration, REST_TIME, REST_SPEED, 10.0) == 0.0
    assert displacement_left(time, np.full((4001, 1), REST_SPEED), REST_TIME, REST_SPEED, 1.0) == 0.0


@pytest.mark.parametrize("in_space", [False, True])
def test_an_overdamped_link_that_still_sags_is_reported_with_what_is_left(in_space):
    strip = damped_strip(3.0, in_space=in_space)
    tip = "tip_z_m" if in_space else "tip_y_m"
    short, whole = simulate(strip), simulate(strip.replace({"solver.rest_time_s": None}))
    assert short.status.code == "rest"
    (warning,) = creeping(short)
    estimate = float(warning.split("about ")[1].split(" m,")[0])
    missing = abs(whole[tip][-1] - short[tip][-1])
    assert missing > 0.2 * abs(short[tip][-1] - short[tip][0])  # so it was worth a warning
    # Deflections of several modes: the slowest one alone is left, so that the decay is geometric to some per cent.
    np.testing.assert_allclose(estimate, missing, rtol=0.1)


def test_a_link_at_rest_in_sand_is_not_called_creeping():
    rested = simulate(load("pendulum_rigid"))
    assert rested.status.code == "rest"
    assert not creeping(rested)
