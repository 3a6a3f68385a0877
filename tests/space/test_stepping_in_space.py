"""Scenes in space that go on step by step: the same run as in one call, steered, and back to a state bit for bit."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

from granular_contact import Results, Simulation, load, simulate

# A trunk on two paddles that scull through sand on a slope, one driven from outside and one by a clock, and a tail of
# bars on a ball joint.
SCULLER: dict[str, Any] = {
    "model": {
        "in_space": True,
        "name": "sculler",
        "bodies": {
            "trunk": {
                "type": "rigid",
                "density_kg_m3": 900,
                "shapes": [{"type": "box", "size_m": [0.1, 0.06, 0.03], "facet_size_m": 0.05}],
            },
            "left": {
                "type": "rigid",
                "density_kg_m3": 2000,
                "shapes": [{"type": "plate", "size_m": [0.06, 0.03], "thickness_m": 0.004, "facet_size_m": 0.04}],
            },
            "right": {
                "type": "rigid",
                "density_kg_m3": 2000,
                "shapes": [{"type": "sphere", "diameter_m": 0.03, "center_m": [0.03, 0, 0], "facet_size_m": 0.03}],
            },
            "tail": {
                "type": "rigid",
                "density_kg_m3": 2000,
                "shapes": [{"type": "cylinder", "diameter_m": 0.01, "start_m": [0, 0, 0], "end_m": [-0.06, 0, 0]}],
            },
        },
        "joints": {
            "flight": {"type": "free", "parent": "ground", "child": "trunk"},
            "hip_left": {
                "type": "hinge",
                "axis": [0, 1, 0],
                "parent": "trunk",
                "child": "left",
                "parent_point_m": [0, 0.05, 0],
                "friction": {"torque_Nm": 0.005},
            },
            "hip_right": {"type": "hinge", "axis": [0.1, 1, 0], "parent": "trunk", "child": "right"}
            | {"parent_point_m": [0, -0.05, 0]},
            "root": {"type": "ball", "parent": "trunk", "child": "tail", "parent_point_m": [-0.05, 0, 0]},
        },
    },
    "medium": "rft3d_sand",
    "bed": {"height_m": 0, "slope_deg": 6, "slope_direction_deg": 40},
    "initial": {"joints": {"flight": {"z_m": 0.017, "vx_m_s": 0.2}, "root": {"spin_rad_s": [0, 2, 1]}}},
    "drives": {
        "hip_left": {"type": "external", "torque_Nm": 0, "range": [-0.1, 0.1]},
        "hip_right": {"type": "motion", "angle_deg": {"type": "ramp", "from": 0, "to": 450, "duration_s": 0.06}},
    },
    "solver": {"end_time_s": 0.06, "step_s": 1e-3, "rest_time_s": None},
}
PAUSES = 6


def sculler(**solver: Any) -> Simulation:
    return Simulation(load(SCULLER | {"solver": SCULLER["solver"] | solver}))


def go_on(simulation: Simulation, pauses: int) -> list[np.ndarray]:
    """All that is seen in the pauses to come."""
    pause, seen = simulation.scenario.solver.end_time_s / PAUSES, []
    for _ in range(pauses):
        torque = 0.06 * (-1.0) ** round(simulation.time / pause)
        seen.append(np.array(list(simulation.step({"hip_left_torque_Nm": torque}, pause).values())))
    return seen


@pytest.mark.slow
@pytest.mark.parametrize("solver", [{}, {"accuracy": 1e-2}], ids=["fixed steps", "chosen steps"])
def test_a_state_in_space_has_the_same_future_bit_by_bit(solver: dict[str, Any]) -> None:
    simulation = sculler(**solver)
    before = go_on(simulation, 3)
    kept = pickle.dumps(simulation.state())
    future = go_on(simulation, PAUSES - 3)
    assert simulation.ended is not None
    results = simulation.results()
    for other in (simulation, sculler(**solver)):
        other.restore(pickle.loads(kept))
        np.testing.assert_array_equal(go_on(other, PAUSES - 3), future)
        np.testing.assert_array_equal(other.results().table, results.table)
    simulation.reset()
    np.testing.assert_array_equal(go_on(simulation, PAUSES), before + future)
    # The sand carries it, friction and drive act; a hinge that turns more than once in a pause is followed.
    assert results["depth_m"].max() > 1e-3
    assert results["friction_work_J"][-1] < -1e-4
    simulation.reset()
    assert simulation.step(None, 1.0)["hip_right_angle_deg"] == pytest.approx(450.0, abs=1e-6)


@pytest.mark.slow
def test_observations_in_space_are_the_columns_of_the_results() -> None:
    simulation = sculler()
    seen = go_on(simulation, PAUSES)[-1]
    results, names = simulation.results(), list(simulation.observe())
    observed = dict(zip(names, seen, strict=True))
    shared = [column.name for column in results.columns if column.name in observed]
    assert len(shared) > 50
    for name in shared:
        value = observed[name]
        last = results[name][-1]
        turns = 360.0 * round((last - value) / 360.0) if "_yaw_" in name or "_roll_" in name else 0.0  # columns go on
        assert value + turns == pytest.approx(last, rel=1e-9, abs=1e-9), name
    assert [observed[f"{body}_contact"] for body in ("trunk", "left", "right", "tail")].count(1.0) > 0
    assert simulation.outlines()


@pytest.mark.slow
def test_a_controller_steers_a_run_in_space() -> None:
    """One that does nothing leaves the run as it is in one call; one that pushes is heard."""
    still = load(SCULLER)

    def push(torque: float) -> Results:
        return simulate(
            still, control=lambda _, seen: [torque - 2e-3 * seen["hip_left_rate_rad_s"]], control_rate_Hz=100
        )

    whole = simulate(still)
    same = simulate(still, control=lambda *_: {"hip_left_torque_Nm": 0.0}, control_rate_Hz=100)
    # Steps that Newton's method had to shorten end elsewhere.
    assert abs(same["hip_left_angle_deg"][-1] - whole["hip_left_angle_deg"][-1]) < 0.1
    assert abs(push(0.05)["hip_left_angle_deg"][-1] - push(-0.05)["hip_left_angle_deg"][-1]) > 1.0


@pytest.mark.slow
def test_a_chain_translated_by_1_km_takes_as_many_steps_as_at_the_origin() -> None:
    """Round-off of constraints is no error that shorter steps mend: it made them ever shorter, 200 000 of them."""
    links = {"type": "link", "density_kg_m3": 4000, "diameter_m": 0.015}
    given: dict[str, Any] = {
        "model": {
            "name": "chain",
            "in_space": True,
            "bodies": {"upper": {**links, "length_m": 0.06}, "lower": {**links, "length_m": 0.15}},
            "joints": {
                "root": {"type": "hinge", "parent": "ground", "child": "upper", "axis": [0.2, 1.0, 0.1]},
                "knee": {"type": "ball", "parent": "upper", "child": "lower", "parent_point_m": [0.06, 0.0, 0.0]},
            },
        },
        "initial": {"joints": {"root": {"angle_deg": 70.0, "rate_rad_s": 3.5}}},
        "medium": "rft_generic",
        "solver": {"end_time_s": 0.135, "accuracy": 1e-3},
        "method": "engine",
        "bed": {"height_m": -0.19, "depth_m": 0.04, "floor": {"stiffness_N_m3": 2.3e6, "damping_s_m": 0.0}},
    }
    near = simulate(given)
    given["model"]["joints"]["root"]["parent_point_m"] = [800.0, -600.0, 0.0]
    far = simulate(given)
    assert near.status.code == far.status.code == "end_time"
    assert len(far["time_s"]) < 3 * len(near["time_s"])
    assert abs(far["tip_z_m"][-1] - near["tip_z_m"][-1]) < 2e-3 * 0.2
