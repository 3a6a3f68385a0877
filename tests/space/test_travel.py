"""Distance, speed and cost of transport along x, y, a direction or the path."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support_models import one_body

from granular_contact import load, simulate
from granular_contact.errors import ConfigError, SceneError
from granular_contact.mechanics import mechanism
from granular_contact.scene import build

KEYS = ("distance_m", "forward_speed_m_s", "forward_speed_second_half_m_s", "cost_of_transport")


def cart(axis: list[float], **output: Any) -> dict[str, Any]:
    """A box in space that a force pushes along a rail in vacuum: a = 2 m/s2 for 1 s."""
    body = {"type": "rigid", "density_kg_m3": 500, "shapes": [{"type": "box", "size_m": [0.1, 0.1, 0.1]}]}
    return {
        "model": one_body("box", body, "rail", "slider", axis=axis),
        "drives": {"rail": {"type": "force", "force_N": 1.0}},
        "solver": {"end_time_s": 1.0, "step_s": 0.01},
        "output": {"figures": False, **output},
    }


def travels(run: dict[str, Any]) -> list[float]:
    summary = simulate(load(run)).summary
    return [summary[key] for key in KEYS]


@pytest.mark.parametrize(
    ("axis", "travel"), [([1, 0, 0], "x"), ([0, 1, 0], "y"), ([3, 4, 0], [0.3, 0.4]), ([3, 4, 0], "path")]
)
def test_an_even_acceleration_goes_half_its_rate_in_a_second(axis: list[float], travel: Any) -> None:
    """1 m along the rail, 3/4 of it in the second half; work 1 N times 1 m over a weight of 0.5 kg times 1 m."""
    # Trapezoids of a rate that is linear are exact; second-order steps of an even force too.
    assert travels(cart(axis, travel=travel)) == pytest.approx([1.0, 1.0, 1.5, 1.0 / (0.5 * 9.81)], rel=1e-9)


def test_motion_across_the_travel_direction_is_no_distance() -> None:
    assert travels(cart([3, 4, 0], travel="x"))[:2] == pytest.approx([0.6, 0.6], rel=1e-9)
    assert "distance_m" not in simulate(load(cart([0, 1, 0], travel="x"))).summary


def test_what_stands_has_no_cost_of_transport() -> None:
    """A robot that stood for 0.5 s had 0.74, from a distance of 4e-13 m: the best of a search for the least cost."""
    summary = simulate(load(cart([1, 0, 0]) | {"drives": {"rail": {"type": "force", "force_N": 1e-6}}})).summary
    assert summary["distance_m"] == pytest.approx(1e-6)
    assert summary["cost_of_transport"] is None


def test_a_circle_has_a_path_and_no_distance() -> None:
    time = np.linspace(0.0, 2.0, 2001)
    turn = math.pi * time  # one turn of a radius of 0.5 m, while it goes up and down
    place = np.column_stack([0.5 * np.cos(turn), 0.5 * np.sin(turn), np.sin(3 * turn)])
    velocity = math.pi * np.column_stack([-0.5 * np.sin(turn), 0.5 * np.cos(turn), 3 * np.cos(3 * turn)])
    motion: Any = SimpleNamespace(common_center=(place, velocity), trajectory=SimpleNamespace(time=time))
    for travel, expected in ((None, math.pi), ((1.0, 0.0), 0.0)):
        motion.scene = SimpleNamespace(travel=travel)
        along, _ = mechanism.advance(motion)
        assert along[-1] - along[0] == pytest.approx(expected, abs=1e-9)


def test_travel_without_a_direction_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"output\.travel: got \[0\.0, 0\.0\]; allowed is a direction on the ground"):
        load(cart([1, 0, 0], travel=[0, 0]))
    with pytest.raises(SceneError, match=r"output\.travel: got y, but y is up in the plane: allowed are x and path"):
        build(load("runner", output={"travel": "y"}))
