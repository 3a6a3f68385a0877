"""Extrapolated iterations (Anderson): they converge sooner, within the change that earlier iterations support."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from granular_contact.mechanics.kernels import anderson
from granular_contact.mechanics.kernels.iterations import ITERATIONS, room
from granular_contact.mechanics.kernels.numerics import CONTRACTION, REGULARISATION

UNKNOWNS = 4
OF_Q, OF_V = 1e-6, 1e-3


@dataclass
class Iterations:
    """Arrays of a system, as those of an engine; a: accelerations at the start of the step."""

    a: NDArray[np.float64] = field(default_factory=lambda: np.zeros(UNKNOWNS))
    multipliers: NDArray[np.float64] = field(default_factory=lambda: np.zeros(1))

    def __post_init__(self) -> None:
        self.q, self.v = np.zeros(UNKNOWNS), np.zeros(UNKNOWNS)
        iterate = {"q": self.q, "v": self.v, "a": self.a, "multipliers": self.multipliers}
        before = {"a_before": self.a.copy(), "multipliers_before": np.zeros(1)}
        self.arrays = iterate | before | {"lever": np.ones(UNKNOWNS)} | room(UNKNOWNS, 1)
        self.addresses = ITERATIONS.addresses(self.arrays)
        self.begin()

    def begin(self) -> None:
        """Begin a step, where the engine has set all to zero."""
        for array in (self.q, self.v, self.a):
            array[:] = 0.0
        anderson.begin(self.addresses, OF_Q, OF_V)

    def lead(self, a: NDArray[np.float64], multipliers: float, jacobians: int = 1) -> bool:
        """Let an iteration lead to a and these multipliers, and the next one begin where it is then.

        Whether that is to be with a new Jacobian.
        """
        further = a - self.a
        self.q += OF_Q * further
        self.v += OF_V * further
        self.a[:], self.multipliers[:] = a, multipliers
        return bool(anderson.accelerate(self.addresses, jacobians))


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


def test_iterations_that_differ_by_round_off_are_not_extrapolated() -> None:
    """Iterations that agree in all motion to round-off, and in multipliers not yet, say nothing of the next step."""
    system = Iterations(np.ones(UNKNOWNS))
    for n in range(4):
        system.lead(np.ones(UNKNOWNS) + 1e-13 * n * n, 10.0 / (n + 1))
    system.begin()
    led = system.a + 5.0
    system.lead(led, 7.0)
    assert np.array_equal(system.a, led)
    assert system.multipliers == [7.0]


def test_an_iteration_that_contracts_too_little_asks_for_a_jacobian() -> None:
    """Changes that halve do not, by a hair; one that shrinks to 0.6 does, and with a new Jacobian the count begins."""
    direction = np.ones(UNKNOWNS)
    for ratio, slow in ((0.99 * CONTRACTION, False), (1.2 * CONTRACTION, True)):
        system = Iterations()
        assert not system.lead(system.a + direction, 0.0)
        assert system.lead(system.a + ratio * direction, 0.0) == slow
        assert not system.lead(system.a + direction, 0.0, jacobians=2)


def test_an_iteration_that_overshoots_keeps_its_jacobian() -> None:
    """It passed the solution by four times what it was away: where it goes on lies between the two, by the secant."""
    direction = np.ones(UNKNOWNS)
    system = Iterations()
    system.lead(system.a + direction, 0.0)
    assert not system.lead(system.a - 4.0 * direction, 0.0)
    assert np.allclose(system.a, direction / 5.0, atol=5.0 * REGULARISATION)  # of a way of 5


def test_a_step_begins_with_the_last_accelerations_and_multipliers() -> None:
    system = Iterations(np.array([1.0, -2.0, 3.0, 0.0]))
    assert np.array_equal(system.a, [1.0, -2.0, 3.0, 0.0])
    assert np.allclose(system.v, OF_V * system.a, rtol=1e-15)
    assert np.allclose(system.q, OF_Q * system.a, rtol=1e-15)
