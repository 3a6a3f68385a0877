"""Coordinates of joints as functions of nodes: derivatives by differences, and turns."""

from __future__ import annotations

import numpy as np
import pytest

from granular_contact.mechanics.coordinates import Coordinate, End
from granular_contact.scene.types import Joint

RIGID, CABLE, GROUND = [0.1, -0.2, 0.4], [0.3, 0.2, 0.8, 0.6], list[float]()
CASES = [
    ("hinge", GROUND, RIGID),
    ("hinge", RIGID, RIGID),
    ("hinge", RIGID, CABLE),
    ("hinge", CABLE, RIGID),
    ("hinge", CABLE, CABLE),
    ("slider", GROUND, RIGID),
    ("slider", RIGID, RIGID),
    ("slider", RIGID, CABLE),
    ("slider", GROUND, CABLE),
]


def made(kind: str, parent: list[float], child: list[float]) -> Coordinate:
    points = [np.array([0.05, 0.02]), np.array([-0.03, 0.04])]
    axis = np.array([0.6, 0.8]) if kind == "slider" else None
    joint = Joint("j", kind, "p", points[0], "c", points[1], axis=axis, offset=0.3)
    ends = [End(reference, point.tolist()) for reference, point in zip((parent, child), points, strict=True)]
    return Coordinate(joint, *ends)


@pytest.mark.parametrize(("kind", "parent", "child"), CASES)
def test_derivatives(kind: str, parent: list[float], child: list[float]) -> None:
    s, n = made(kind, parent, child), len(parent) + len(child)
    rng = np.random.default_rng(3)
    q, v, step = 0.3 * rng.standard_normal(n), rng.standard_normal(n), 1e-6

    def at(q: np.ndarray) -> tuple[float, float, np.ndarray]:
        value, rate, slope = s.at(q.tolist(), v.tolist())
        return value, rate, np.array(slope)

    _, rate, slope = at(q)
    unit = np.eye(n) * step
    # Central differences of a function with derivatives of order one: step^2 and round-off of 1e-16 / step.
    by_value = np.array([(at(q + e)[0] - at(q - e)[0]) / (2 * step) for e in unit])
    np.testing.assert_allclose(slope, by_value, atol=1e-8)
    assert rate == pytest.approx(slope @ v, rel=1e-12)


def test_a_slope_is_counted_through_whole_turns() -> None:
    s = made("hinge", GROUND, [0.0, 0.0, 1.0, 0.0])
    start = s.at([0.0] * 4, [0.0] * 4)[0]
    for angle in np.linspace(0.0, 4.5 * np.pi, 91)[1:]:
        value, _, _ = s.at([0.0, 0.0, np.cos(angle) - 1.0, np.sin(angle)], [0.0] * 4)
    # The angle of a hinge is the parent's less the child's.
    assert value == pytest.approx(start - 4.5 * np.pi, rel=1e-12)
