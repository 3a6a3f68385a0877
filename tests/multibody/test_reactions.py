"""Forces of prescribed motions: their power is the rate of the energies, at every step and however steps are chosen."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from granular_contact import load, simulate
from granular_contact.mechanics.drive_error import drive_warnings
from granular_contact.results.summary import Driving
from granular_contact.scene import build

BAR = {"type": "link", "length_m": 0.1, "diameter_m": 0.01, "density_kg_m3": 7700}
SINE = {"type": "sine", "amplitude": 40, "frequency_Hz": 3, "phase_deg": 20}
TURN = {"type": "motion", "angle_deg": SINE}
SHIFT = {"type": "motion", "position_m": {"type": "sine", "amplitude": 0.05, "frequency_Hz": 4, "offset": 0.03}}
FLAT = {
    "slider on what turns": {
        "joints": {
            "pin": {"type": "hinge", "parent": "ground", "child": "a"},
            "rail": {"type": "slider", "parent": "a", "child": "b", "parent_point_m": [0.1, 0.02]}
            | {"child_point_m": [0, 0.03], "axis": [1, 2]},
        },
        "drives": {"rail": SHIFT},
        "start": {"pin": {"rate_rad_s": 6}},
    },
    "two that share their masses, in flight": {
        "joints": {
            "air": {"type": "free", "parent": "ground", "child": "a", "child_point_m": [0.02, 0.01]},
            "knee": {"type": "hinge", "parent": "a", "child": "b", "parent_point_m": [0.1, 0]},
            "rail": {"type": "slider", "parent": "b", "child": "c", "parent_point_m": [0.1, 0], "axis": [1, -1]},
        },
        "drives": {"knee": TURN, "rail": SHIFT},
        "start": {"air": {"y_m": 1, "vx_m_s": 1, "rate_rad_s": 5}},
    },
    "crank of a loop": {
        "joints": {
            "one": {"type": "hinge", "parent": "ground", "child": "a", "home_deg": -90},
            "two": {"type": "hinge", "parent": "a", "child": "b", "parent_point_m": [0.1, 0], "home_deg": 90},
            "three": {"type": "hinge", "parent": "ground", "child": "c", "parent_point_m": [0.1, 0], "home_deg": -90},
        },
        "closures": {
            "end": {"type": "hinge", "parent": "b", "child": "c", "parent_point_m": [0.1, 0], "child_point_m": [0.1, 0]}
        },
        "drives": {"one": TURN | {"angle_deg": SINE | {"amplitude": 20, "offset": -80}}},
        "start": {},
    },
}
DEEP = {
    "two that share their masses, in flight": {
        "joints": {
            "air": {"type": "free", "parent": "ground", "child": "a"},
            "knee": {"type": "hinge", "parent": "a", "child": "b", "parent_point_m": [0.1, 0, 0], "axis": [1, 2, 3]},
            "rail": {"type": "slider", "parent": "b", "child": "c", "parent_point_m": [0.1, 0.02, 0]}
            | {"child_point_m": [0, 0, 0.03], "axis": [1, -1, 2]},
            "end": {"type": "ball", "parent": "c", "child": "d", "parent_point_m": [0.1, 0, 0]},
        },
        "drives": {"knee": TURN, "rail": SHIFT},
        "start": {"air": {"z_m": 1, "vx_m_s": 1, "spin_rad_s": [3, -4, 5]}, "end": {"spin_rad_s": [1, 2, -3]}},
    },
    "crank of a leaning loop": {
        "joints": {
            "one": {"type": "hinge", "axis": [0, 1, 0], "parent": "ground", "child": "a", "home_deg": 90}
            | {"rpy_deg": [20, 0, 0]},
            "two": {"type": "hinge", "axis": [0, 1, 0], "parent": "a", "child": "b", "parent_point_m": [0.1, 0, 0]}
            | {"home_deg": -90},
            "three": {"type": "hinge", "axis": [0, 1, 0], "parent": "b", "child": "c", "parent_point_m": [0.1, 0, 0]}
            | {"home_deg": -90},
            "four": {"type": "ball", "parent": "b", "child": "d", "parent_point_m": [0.05, 0, 0]},
        },
        "closures": {
            "end": {"type": "hinge", "axis": [0, 1, 0], "parent": "ground", "child": "c", "rpy_deg": [20, 0, 0]}
            | {"parent_point_m": [0.1, 0, 0], "child_point_m": [0.1, 0, 0]}
        },
        "drives": {"one": TURN | {"angle_deg": SINE | {"amplitude": 20, "offset": 80}}},
        "start": {"four": {"rpy_deg": [0, 60, 0], "spin_rad_s": [1, 0, 2]}},
    },
}
CASES = [(False, name) for name in FLAT] + [(True, name) for name in DEEP]


def tree_of(case: dict[str, Any], in_space: bool, **solver: Any) -> dict[str, Any]:
    joints, closures = case["joints"], case.get("closures", {})
    bodies = sorted({joint["child"] for joint in [*joints.values(), *closures.values()]})
    model = {"name": "it", "bodies": dict.fromkeys(bodies, BAR), "joints": joints, "closures": closures}
    model |= {"in_space": True} if in_space else {}
    solver = {"end_time_s": 0.06, "step_s": 2e-4, "rest_time_s": None, "tolerance": 1e-9} | solver
    return {"model": model, "initial": {"joints": case["start"]}, "drives": case["drives"], "solver": solver}


def run_of(case: dict[str, Any], in_space: bool, **solver: Any) -> Any:
    return simulate(load(tree_of(case, in_space, **solver)))


@pytest.mark.slow
@pytest.mark.parametrize(("in_space", "name"), CASES, ids=str)
def test_power_is_the_rate_of_the_energy_however_steps_are_chosen(in_space: bool, name: str) -> None:
    case = (DEEP if in_space else FLAT)[name]
    run = run_of(case, in_space)
    power = sum(run[f"{joint}_power_W"] for joint in case["drives"])
    stored = run["kinetic_J"] + run["gravity_J"]
    rate = np.gradient(stored, run["time_s"], edge_order=2)
    # Parabolas through three steps: (omega h)^2 / 6 = 4e-6 with the 25 rad/s of the motions, and some more in their
    # products. Velocities, and so energies, swing for some steps at the start.
    late = slice(len(power) // 10, -2)
    assert np.abs(power - rate)[late].max() < 1e-4 * np.abs(power).max()
    work = run["drive_work_J"] - (stored - stored[0])
    assert np.abs(work).max() < 1e-4 * np.abs(power).max() * run["time_s"][-1]
    # And as many steps as the error asks for tell the same of it.
    chosen = run_of(case, in_space, accuracy=1e-3)
    assert len(chosen["time_s"]) < 0.6 * len(run["time_s"])
    for joint, numbers in run.summary["drives"].items():
        for key in ("torque_Nm", "force_N", "power_W"):
            if f"largest_{key}" in numbers:
                got = chosen.summary["drives"][joint][f"largest_{key}"]
                assert got == pytest.approx(numbers[f"largest_{key}"], rel=4e-3), (joint, key)


KNOTS = {"type": "table", "time_s": [0, 0.04, 0.05, 0.1], "values": [0, 0.01, 0.03, -0.01]}


@pytest.mark.parametrize("solver", [{"step_s": 2.3e-4}, {"step_s": 1.7e-4}, {"accuracy": 1e-2}, {"accuracy": 1e-3}])
def test_the_greatest_force_on_either_side_of_a_jump_is_reported(solver: dict[str, float]) -> None:
    """Cubics through a table: the acceleration is greatest just before and after its instants, where no step may be."""
    mass = BAR["density_kg_m3"] * np.pi / 4 * BAR["diameter_m"] ** 2 * BAR["length_m"]  # type: ignore[operator]
    rail = {"type": "slider", "parent": "ground", "child": "a", "axis": [1, 0]}
    case = {"joints": {"rail": rail}, "start": {}, "drives": {"rail": {"type": "motion", "position_m": KNOTS}}}
    run = run_of(case, False, **{"end_time_s": 0.1} | solver)
    # Fritsch and Butland's slope at 0.04 s, w = (2 x 0.01 + 0.04, 0.01 + 2 x 0.04); 0 at 0.05 s, where it turns round.
    before, after = 0.25, 2.0
    slope = 0.15 / (0.06 / before + 0.09 / after)
    ends = {0.04: (0.0, slope, before), 0.01: (slope, 0.0, after), 0.05: (0.0, 0.0, -0.8)}
    sides = [
        abs(force)
        for h, (a, b, mean) in ends.items()
        for force in ((6 * mean - 4 * a - 2 * b) / h, (2 * a + 4 * b - 6 * mean) / h)
    ]
    # The instants lie 1e-10 s off their jumps; the inertia is interpolated between two steps, here it is constant.
    assert run.summary["drives"]["rail"]["largest_force_N"] == pytest.approx(mass * max(sides), rel=1e-6)
    assert run.summary["energy"]["imbalance_relative"] < 1e-9


def test_a_controller_does_not_amplify_the_newton_residual() -> None:
    """Of a leg in flight the torque went to and fro between 0.03 and 0.6 mN m from step to step."""
    hold = {"type": "pd", "angle_deg": SINE | {"amplitude": 5}, "gain_Nm_per_rad": 3, "rate_gain_Nm_s_per_rad": 0.1}
    case = {"joints": FLAT["two that share their masses, in flight"]["joints"], "drives": {"knee": hold}}
    case["start"] = {"air": {"y_m": 1, "vx_m_s": 1, "rate_rad_s": 2}, "knee": {"angle_deg": 1}}
    torque = run_of(case, False, tolerance=1e-5)["knee_torque_Nm"]
    late = torque[len(torque) // 3 :]
    # What is smooth has second differences of (omega h)^2, 1e-3 at 150 rad/s.
    assert np.abs(np.diff(late, 2)).max() < 2e-3 * np.abs(late).max()


@pytest.mark.parametrize(
    ("beside", "limit", "expected"),
    [
        ((0.97, 0.95), np.inf, ""),
        ((0.95, 0.92), np.inf, "3 N, is not resolved: one step before and one step after it the force is lower, by 13"),
        ((-1.0, -1.0), 3.0, ""),
        ((0.1, 0.98), np.inf, "lower, by 92"),
    ],
)
def test_a_greatest_force_that_steps_do_not_resolve_is_reported(
    beside: tuple[float, float], limit: float, expected: str
) -> None:
    scene = build(load(tree_of(FLAT["slider on what turns"], False)))
    drive = replace(scene.drives[0], kind="control", limit=limit)
    force = -3.0 * np.array([0.1, 0.2, beside[0], 1.0, beside[1], 0.1])
    warnings = list(drive_warnings(replace(scene, drives=(drive,)), {"rail": Driving(force, force, force)}))
    assert len(warnings) == bool(expected)
    assert all(expected in warning.sentence for warning in warnings)


@pytest.mark.parametrize(
    ("power", "accuracy", "expected"),
    [
        ((0.2, 0.5, 0.97, 1.0), None, "1 W, is that at the end of the run, where it rises by 3"),
        ((0.2, 0.5, 0.97, 1.0), 1e-3, ""),  # chosen steps may be as long as it takes
        ((0.2, 0.5, 0.99, 1.0), None, ""),
        ((0.2, 1.0, 0.96, 0.99), None, ""),
        ((-0.2, -0.9, -0.3, -0.2), None, ""),
        ((-0.2, -0.5, 4e-7, 2.1e-6), None, ""),  # it brakes
    ],
)
def test_a_greatest_power_that_still_rises_at_the_end_is_reported(
    power: tuple[float, ...], accuracy: float | None, expected: str
) -> None:
    scene = build(load(tree_of(FLAT["slider on what turns"], False)))
    scene = replace(scene, solver=scene.solver.model_copy(update={"accuracy": accuracy}), drives=scene.drives[:1])
    force = np.ones(len(power))  # N
    warnings = list(drive_warnings(scene, {"rail": Driving(force, np.array(power), force)}))
    assert len(warnings) == bool(expected)
    assert all(expected in warning.sentence for warning in warnings)


def test_drives_with_negligible_force_or_power_give_no_warning() -> None:
    """A drive that holds still what no force acts on gives round-off alone."""
    scene = build(load(tree_of(FLAT["slider on what turns"], False)))
    scene = replace(scene, drives=(replace(scene.drives[0], kind="control"),))
    spike, rising = np.array([0.1, 0.1, 1.0, 0.1, 0.1]), np.array([0.1, 0.2, 0.3, 0.5, 1.0])
    for size in (1.0, 1e-6 * scene.force_scale):
        warnings = list(drive_warnings(scene, {"rail": Driving(size * spike, 0.0 * spike, spike)}))
        assert len(warnings) == (size == 1.0)
    for energy in (0.0, 1e5):  # J, in a second
        warnings = list(drive_warnings(scene, {"rail": Driving(np.ones(5), rising, rising)}, energy, 1.0))
        assert len(warnings) == (energy == 0.0)


@pytest.mark.parametrize("lasts", [9e-5, 2e-3])
def test_a_controller_faster_than_the_steps_is_reported(lasts: float) -> None:
    """It takes up a mass within half a step, or within 2 ms: the force comes from nothing, and is least later."""
    mass = 7700 * np.pi / 4 * 0.01**2 * 0.1
    joint = {"rail": {"type": "slider", "parent": "ground", "child": "a", "axis": [0, 1]}}
    lift = {"type": "sine", "amplitude": -0.02, "frequency_Hz": 4, "phase_deg": 90, "offset": 0.02}
    control = {"type": "pd_slider", "position_m": lift, "gain_N_per_m": mass / lasts / 0.02}
    case = {"joints": joint, "drives": {"rail": control | {"speed_gain_N_s_per_m": mass / lasts}}, "start": {}}
    run = run_of(case, False)
    warnings = [sentence for sentence in run.warnings if "rail, 1.43 N, is not resolved" in sentence]
    assert len(warnings) == (lasts < 2e-4)
