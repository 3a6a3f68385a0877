"""What the studies of policies share: a plain evolution strategy, motors that follow clocks, an episode."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from granular_contact.gym.environment import GranularEnv
from granular_contact.scene.signals import Buehler

Vector = NDArray[np.float64]
Act = Callable[[Vector, float], Vector]
PROCESSES, SPREAD = 2, 0.5


def evolved(
    generations: int, population: int, score: Callable[[Vector], float], size: int, seed: int = 1
) -> tuple[Vector, list[float], float]:
    """Best weights (size,), the best score so far after each generation, and the time (s) it took.

    Pairs of opposite steps around a mean; the better half draws the mean after it, by ranks; the spread shrinks slowly.
    """
    random, mean, spread = np.random.default_rng(seed), np.zeros(size), SPREAD
    ranks = np.log(0.5 * population + 0.5) - np.log(np.arange(1, population // 2 + 1))
    best, history = (-np.inf, mean), list[float]()
    began = time.perf_counter()
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        for _ in range(generations):
            steps = random.normal(size=(population // 2, size))
            tried = mean + spread * np.concatenate([steps, -steps])
            found = np.array(pool.map(score, tried, chunksize=1))
            order = np.argsort(-found)
            best = max(best, (float(found[order[0]]), tried[order[0]]), key=lambda pair: pair[0])
            mean = ranks @ tried[order[: population // 2]] / ranks.sum()
            spread *= 0.97
            history.append(best[0])
    return best[1], history, time.perf_counter() - began


def following(clocks: Sequence[Buehler], rates: tuple[float, float], sines: slice, cosines: slice) -> Act:
    """Clocks followed by motors: their rates, and what makes up for the angles missed.

    rates: the range of the motors; sines, cosines: of the angles, where they are in what is seen.
    """

    def act(seen: Vector, t: float) -> Vector:
        wanted = np.array([clock.value(t) for clock in clocks])
        missed = np.angle(np.exp(1j * wanted) / (seen[cosines] + 1j * seen[sines]))
        asked = np.array([clock.rate(t) for clock in clocks]) + 20.0 * missed
        return np.asarray(2.0 * (asked - rates[0]) / (rates[1] - rates[0]) - 1.0)

    return act


def walked(env: GranularEnv, act: Act, **options: object) -> float:
    """Sum of the rewards, the way (m), of an episode; options: of its reset."""
    seen, info = env.reset(options=dict(options))
    total = 0.0
    while True:
        seen, reward, ended, cut, info = env.step(act(seen.astype(float), info["time_s"]))
        total += reward
        if ended or cut:
            return total
