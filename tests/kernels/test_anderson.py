"""Iterations that go on from those before: they end sooner, and are led no further than those before know."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from granular_contact.jit.lending import places
from granular_contact.mechanics.kernels import anderson
from granular_contact.mechanics.kernels import iterations as of

UNKNOWNS = 4
OF_Q, OF_V = 1e-6, 1e-3


@dataclass
class Iterations:
    """Arrays of a system, as those of an engine; a: accelerations at the start of the step."""

    a: NDArray[np.float64] = field(default_factory=lambda: np.zeros(UNKNOWNS))
    multipliers: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        self.q, self.v = np.zeros(UNKNOWNS), np.zeros(UNKNOWNS)
        self.v_before = np.zeros(UNKNOWNS)
        before = self.v_before, self.a.copy(), np.zeros(1)
        kept = np.zeros((4, UNKNOWNS)), np.zeros((2, 1)), np.zeros(2)
        pairs = [np.zeros((rows, of.DEPTH)) for rows in (UNKNOWNS, 1, UNKNOWNS, of.DEPTH)]
        numbers = np.zeros(of.NUMBERS, np.int64), np.zeros(of.LINE)
        now = self.q, self.v, self.a, self.multipliers
        way = np.zeros((2, UNKNOWNS)), np.zeros((2, 1))
        self.arrays = [*now, *before, np.ones(UNKNOWNS), *kept, *pairs, *numbers, *way]
        self.words = places(*self.arrays)
        self.begin()

    def begin(self, jacobians: int = 1, *, fixed: bool = False, held: float = 0.0) -> bool:
        """Begin a step, where the engine has set all to zero; whether it is to be with a new Jacobian."""
        for array in (self.q, self.v, self.a):
            array[:] = 0.0
        return bool(anderson.begin(self.words, OF_Q, OF_V, False, jacobians, fixed, held))

    def lead(self, a: NDArray[np.float64], multipliers: float, jacobians: int = 1, gain: float = np.inf) -> bool:
        """Let an iteration lead to a and these multipliers, and the next one begin where it is then.

        Whether that is to be with a new Jacobian.
        """
        further = a - self.a
        self.q += OF_Q * further
        self.v += OF_V * further
        self.a[:], self.multipliers[:] = a, multipliers
        return bool(anderson.go_on(self.words, jacobians, gain, True))


def test_a_linear_iteration_ends_sooner() -> None:
    """By itself the slowest of its directions leaves 0.9 of itself each time: a quarter of it after 13."""
    rng = np.random.default_rng(1)
    turn = np.linalg.qr(rng.normal(size=(UNKNOWNS, UNKNOWNS)))[0]
    leaves, end = turn @ np.diag([0.9, -0.6, 0.4, 0.1]) @ turn.T, rng.normal(size=UNKNOWNS)
    system, changes = Iterations(), []
    for _ in range(14):
        led = end + leaves @ (system.a - end)
        changes.append(np.linalg.norm(led - system.a))
        system.lead(led, float(led.sum()))
    assert changes[-1] < 1e-3 * changes[0]
    assert np.allclose(system.a, end, atol=1e-2)
    # Coordinates and rates went with the accelerations.
    assert np.allclose(system.q, OF_Q * system.a, rtol=1e-12)
    assert np.allclose(system.v, OF_V * system.a, rtol=1e-12)


def test_what_differs_by_round_off_leads_nowhere() -> None:
    """Iterations that agree in all motion to round-off, and in multipliers not yet, say nothing of the next step."""
    system = Iterations(np.ones(UNKNOWNS))
    for n in range(4):
        system.lead(np.ones(UNKNOWNS) + 1e-13 * n * n, 10.0 / (n + 1))
    system.begin()
    led = system.a + 5.0
    system.lead(led, 7.0)
    assert np.array_equal(system.a, led)
    assert system.multipliers == [7.0]


def stopping(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """What is left of the forces on beads that friction stops, by the sign of their speeds over a narrow range."""
    return MASS @ a + FRICTION * np.clip((START + OF_V * a) / NARROW, -1.0, 1.0)


def slope(a: NDArray[np.float64]) -> NDArray[np.float64]:
    """Its Jacobian."""
    holds = np.abs(START + OF_V * a) < NARROW
    return MASS + np.diag(FRICTION * OF_V / NARROW * holds)


MASS = 4.0 * np.eye(UNKNOWNS) + np.eye(UNKNOWNS, k=1) + np.eye(UNKNOWNS, k=-1)
FRICTION, NARROW, START = 3.0, 1e-6, 3e-3 * np.linspace(0.1, 1.0, UNKNOWNS)  # N, m/s, m/s


def iterations_until_solved(*, fixed: bool) -> int:
    """Of a step in which friction stops what moves, by Jacobians that are renewed when asked for; at most 60."""
    system = Iterations()
    renews, jacobians, jacobian = system.begin(fixed=fixed), 1, MASS
    for n in range(60):
        if np.abs(stopping(system.a)).max() < 1e-9:
            return n
        if renews:
            jacobians, jacobian = jacobians + 1, slope(system.a)
        led = system.a - np.linalg.solve(jacobian, stopping(system.a))
        renews = system.lead(led, 0.0, jacobians, 0.5)
    return 60


def test_an_iteration_that_led_too_far_is_gone_on_with_on_its_way() -> None:
    """Friction that holds within a narrow range of speeds is hit by it, and missed on either side without."""
    assert iterations_until_solved(fixed=True) < 30
    assert iterations_until_solved(fixed=False) == 60


def test_a_jacobian_that_has_cost_enough_iterations_is_renewed() -> None:
    """Steps with it take one iteration, then three each: it has cost six more after three of these."""
    system = Iterations()
    asked = [system.begin(1, fixed=True)]
    for count in (1, 3, 3, 3):
        for n in range(count):
            system.lead(np.full(UNKNOWNS, 1.0 + 0.1**n), 0.0)
        asked.append(system.begin(1, fixed=True))
    assert asked == [False] * 4 + [True]
    assert not system.begin(2, fixed=True)  # a new one has cost nothing yet


def test_what_bristles_hold_begins_a_step_with_the_rate_that_it_had() -> None:
    """And not with the acceleration that has stopped it, which still counts for all that is faster or turns round."""
    system = Iterations(np.full(UNKNOWNS, 2.0))
    system.v_before[:] = 1e-4, -1e-4, 2e-2, 1e-3
    system.begin(fixed=True, held=1e-2)
    assert system.v == pytest.approx([1e-4, 0.0, 2e-3, 1e-3])
    system.begin(fixed=True)
    assert system.v == pytest.approx([2e-3, 0.0, 2e-3, 2e-3])
