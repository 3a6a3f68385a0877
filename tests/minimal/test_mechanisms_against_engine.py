"""Mechanisms in minimal coordinates and through the engine: free bases, sliders, drives, joint laws, all beds."""

from __future__ import annotations

import numpy as np
import pytest
from support_parts import called
from support_runs import simulate, tip_error

from granular_contact.mechanics.kernels.signal_tables import SIGNAL, look_up
from granular_contact.results import Results
from granular_contact.scene.signal_tables import jerks, tabulate
from granular_contact.scene.signals import Buehler, Constant, Ramp, Signal, Sine, Smoothed, jumps, piecewise

LEG = """
model:
  name: leg
  bodies:
    hull:
      type: rigid
      mass_kg: 0.3
      inertia_kg_m2: 2.0e-4
      shapes: [{type: disc, diameter_m: 0.03, thickness_m: 0.03, in_sand: false}]
    thigh: {type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 2700}
    shank: {type: link, length_m: 0.1, diameter_m: 0.01, density_kg_m3: 2700}
  joints:
    rail: {type: slider, parent: ground, child: hull, axis: [0, 1], damping_N_s_per_m: 0.5}
    hip: {type: hinge, parent: hull, child: thigh}
    knee:
      type: hinge
      parent: thigh
      child: shank
      parent_point_m: [0.1, 0]
      spring: {stiffness_Nm_per_rad: 0.4, rest_deg: 5}
      damping_Nm_s_per_rad: 2.0e-3
      stops: {lower_deg: -20, upper_deg: 12, stiffness_Nm_per_rad: 50, dissipation_s_per_rad: 0.1}
      friction: {torque_Nm: 0.01}
medium: play_sand
bed: {height_m: -0.19, layers: [{top_m: 0.01, medium: poppy_seeds_close}]}
initial: {joints: {hip: {angle_deg: 70}, knee: {angle_deg: 0}}}
drives:
  hip: {type: motion, angle_deg: {type: sine, amplitude: 20, frequency_Hz: 5, offset: 70}}
  knee: {type: torque, torque_Nm: {type: sine, amplitude: 0.05, frequency_Hz: 7}}
solver: {end_time_s: 0.2}
load: {strips_per_rigid_part: 4}
"""
# What else a leg may have, on top of the one above.
CASES = {
    "layers, springs, stops": (LEG, ()),
    "stiff floor": (LEG, ("bed={height_m: -0.19, depth_m: 0.01, floor: {stiffness_N_m2: 1e4, damping_s_m: 0.3}}",)),
    "controlled hip": (
        LEG,
        (
            "drives.hip={type: pd, angle_deg: {type: sine, amplitude: 20, frequency_Hz: 5, offset: 70}, "
            "gain_Nm_per_rad: 3, rate_gain_Nm_s_per_rad: 0.03, limit_Nm: 0.5}",
        ),
    ),
    "controlled rate": (
        LEG,
        (
            "drives.hip={type: pd, rate_rad_s: {type: ramp, from: 0, to: 3, duration_s: 0.1}, "
            "rate_gain_Nm_s_per_rad: 0.05}",
        ),
    ),
    "force on the rail": (LEG, ("drives.rail={type: force, force_N: {type: sine, amplitude: 2, frequency_Hz: 9}}",)),
    "free base": ("runner", ("solver.end_time_s=0.25",)),
    # Its strips would be chosen by the accuracy: as short as they get, so that steps alone are compared.
    "free fall": ("free_link", ("load.strips_per_rigid_part=128",)),
    "prescribed slider": ("dragged_plate", ("solver.end_time_s=0.2",)),
}
FINE = ("solver.accuracy=null", "solver.rest_time_s=null", "method=engine", "solver.tolerance=1e-8")


def by_engine(case: str, step: float = 1e-4) -> Results:
    text, more = CASES[case]
    return simulate(text, *more, *FINE, f"solver.step_s={step}")


def minimal(case: str, accuracy: float = 1e-4) -> Results:
    text, more = CASES[case]
    overrides = f"solver.accuracy={accuracy}", "solver.step_s=null", "solver.rest_time_s=null", "method=minimal"
    return simulate(text, *more, *overrides)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_minimal_coordinates_and_engine_give_the_same_results(case: str) -> None:
    ours, theirs = minimal(case), by_engine(case)
    assert [column.name for column in ours.columns] == [column.name for column in theirs.columns]
    times = np.linspace(0.0, theirs["time_s"][-1], 301)
    travelled = np.abs(np.diff(np.column_stack([theirs["tip_x_m"], theirs["tip_y_m"]]), axis=0)).sum()
    # Errors of the steps of both are some 1e-4 of the way or less, that of chords of some ms as much.
    assert tip_error(ours, theirs, times) < 1e-3 * travelled
    for name in ("kinetic_J", "gravity_J", "granular_work_J", "drive_work_J", "floor_work_J", "friction_work_J"):
        if name in {column.name for column in theirs.columns}:
            a, b = (np.interp(times, r["time_s"], r[name]) for r in (ours, theirs))
            scale = max(np.ptp(theirs[other]) for other in ("kinetic_J", "gravity_J", "granular_work_J", name))
            np.testing.assert_allclose(a, b, atol=5e-3 * scale, err_msg=name)
    assert ours.summary["energy"]["imbalance_relative"] < 1e-3


@pytest.mark.parametrize("case", ["layers, springs, stops", "controlled hip"])
def test_torques_of_drives_are_the_engine_s(case: str) -> None:
    ours, theirs = minimal(case), by_engine(case)
    times = np.linspace(0.01, 0.2, 201)
    for name in ("hip_torque_Nm", "hip_power_W", "knee_torque_Nm"):
        a, b = (np.interp(times, r["time_s"], r[name]) for r in (ours, theirs))
        assert np.sqrt(np.mean((a - b) ** 2)) < 0.01 * np.ptp(theirs[name])


@pytest.mark.slow
def test_error_of_a_driven_mechanism_follows_the_accuracy() -> None:
    fine = minimal("layers, springs, stops", 1e-5)
    travelled = np.abs(np.diff(np.column_stack([fine["tip_x_m"], fine["tip_y_m"]]), axis=0)).sum()
    for accuracy in (1e-2, 1e-3):
        run = minimal("layers, springs, stops", accuracy)
        assert tip_error(run, fine, run["time_s"]) < accuracy * travelled


def test_fixed_steps_are_the_engine_s() -> None:
    """The same scheme in other coordinates, over the same steps: what is apart is of its order, with a small factor."""
    text, more = CASES["free base"]
    overrides = (
        *more,
        "solver.accuracy=null",
        "solver.step_s=2e-4",
        "solver.spectral_radius=0.9",
        "solver.tolerance=1e-7",
    )
    ours, theirs = (simulate(text, *overrides, f"method={method}") for method in ("minimal", "engine"))
    assert np.allclose(ours["time_s"], theirs["time_s"], rtol=0.0, atol=1e-12)
    travelled = np.abs(np.diff(np.column_stack([theirs["tip_x_m"], theirs["tip_y_m"]]), axis=0)).sum()
    assert tip_error(ours, theirs, theirs["time_s"]) < 1e-4 * travelled


SIGNALS: dict[str, Signal] = {
    "constant": Constant(0.3),
    "sine": Sine(0.4, 30.0, 0.2, 0.1),
    "ramp": Ramp(0.1, 0.7, 0.11, 0.3),
    "clock": Buehler(2.0, 1.5, 0.2, 0.5, 0.1, 0.1),
    "table": piecewise(np.array([0.0, 0.1, 0.35, 0.9]), np.array([0.0, 0.5, 0.2, 0.4]), cubic=True),
}
_bent = piecewise(np.array([0.0, 0.1, 0.35, 0.9]), np.array([0.0, 0.5, 0.2, 0.4]), cubic=False)
SIGNALS["smoothed"] = Smoothed(_bent, jumps(_bent), 0.04)


@pytest.mark.parametrize("name", SIGNALS)
def test_tables_of_signals_are_the_signals(name: str) -> None:
    signal, record = SIGNALS[name], np.zeros(1, SIGNAL)
    knots, pieces = tabulate([signal], 1.0)
    times = np.random.default_rng(1).uniform(0.0, 1.0, 500)
    breaks = np.array([*jerks(signal), np.inf])
    for t in times.tolist():
        called(look_up)(t, knots, pieces, record)
        # Accelerations jump at the knots of tables, which are knots of ours; elsewhere a piece is off by 1e-6 of them.
        assert np.abs(breaks - t).min() > 1e-9
        scale = np.abs(pieces[0, :, 1]).max(), 2.0 * np.abs(pieces[0, :, 2]).max() + 1e-9
        assert record["value"][0] == pytest.approx(signal.value(t), abs=1e-8)
        assert record["rate"][0] == pytest.approx(signal.rate(t), abs=1e-6 * scale[0] + 1e-9)
        assert record["acceleration"][0] == pytest.approx(signal.acceleration(t), abs=1e-3 * scale[1])
