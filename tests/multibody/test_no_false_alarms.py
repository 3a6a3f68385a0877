"""Runs that must have no warning: quantities of round-off are compared with the scale of the run."""

from __future__ import annotations

from typing import Any

import pytest
from support_models import one_body

from granular_contact import Simulation, load, simulate

CONE = {"type": "cone", "diameter_m": 0.02, "height_m": 0.04}
INERTIA = {"xx": 0.01, "yy": 0.01, "zz": 0.01}


def test_a_drive_that_brakes_at_fixed_steps() -> None:
    """A cone that is heavier than what the sand carries is let down: the power is negative, and ends at zero."""
    lowered = {"type": "ramp", "from": 0, "to": 0.06, "duration_s": 2}
    cone = {"type": "rigid", "mass_kg": 1, "inertia_kg_m2": INERTIA, "shapes": [CONE]}
    config: dict[str, Any] = {
        "model": one_body("cone", cone, "rail", "slider", axis=[0, 0, -1]),
        "medium": "rft_generic",
        "surface_height_m": 0,
        "drives": {"rail": {"type": "motion", "position_m": lowered}},
        "solver": {"end_time_s": 2, "step_s": 5e-3},
        "output": {"figures": False},
    }
    results = simulate(config)
    assert results.summary["drives"]["rail"]["largest_power_W"] < 1e-4
    assert results.warnings == ()


@pytest.mark.parametrize("solver", [{"step_s": 1e-3}, {"accuracy": 1e-3}])
def test_a_robot_that_holds_still_without_gravity(solver: dict[str, Any]) -> None:
    """Two hinges under PD control at their references: their torques are what Newton's method leaves."""
    link = {"type": "link", "length_m": 0.1, "diameter_m": 0.01, "density_kg_m3": 1200}
    hold = {"type": "pd", "angle_deg": 30, "gain_Nm_per_rad": 10, "rate_gain_Nm_s_per_rad": 0.1}
    config: dict[str, Any] = {
        "model": {
            "name": "arm",
            "bodies": {"upper": link, "lower": link},
            "joints": {
                "shoulder": {"type": "hinge", "parent": "ground", "child": "upper"},
                "elbow": {"type": "hinge", "parent": "upper", "child": "lower"},
            },
        },
        "gravity_m_s2": 0,
        "initial": {"joints": {"shoulder": {"angle_deg": 30.000001}, "elbow": {"angle_deg": 30}}},
        "drives": {"shoulder": hold, "elbow": hold},
        "solver": {"end_time_s": 0.2, "rest_time_s": None, **solver},
        "output": {"figures": False},
    }
    simulation = Simulation(load(config))
    while simulation.ended is None:
        simulation.step(None, 0.05)
    assert simulation.results().warnings == ()
