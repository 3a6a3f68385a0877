"""Helpers of the studies of policies: an evolution strategy, motors that follow clocks, and a run of an episode."""

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
    """Maximise a score by an evolution strategy.

    Candidates are pairs of opposite steps around a mean. The mean moves towards the better half, weighted by rank; the
    step size shrinks slowly. Returns the best weights (size,), the best score so far after each generation, and the run
    time (s).
    """
    random, mean, spread = np.random.default_rng(seed), np.zeros(size), SPREAD
    ranks = np.log(0.5 * population + 0.5) - np.log(np.arange(1, population // 2 + 1))
    best, history = (-np.inf, mean), list[float]()
    began = time.perf_counter()
    with multiprocessing.get_context("spawn").Pool(PROCESSES) as pool:
        for _ in range(generations):
            steps = random.normal(size=(population // 2, size))
            tried = mean + spread * np.concatenate([steps, -steps])
            scores = np.array(pool.map(score, tried, chunksize=1))
            order = np.argsort(-scores)
            best = max(best, (float(scores[order[0]]), tried[order[0]]), key=lambda pair: pair[0])
            mean = ranks @ tried[order[: population // 2]] / ranks.sum()
            spread *= 0.97
            history.append(best[0])
    return best[1], history, time.perf_counter() - began


def following(clocks: Sequence[Buehler], rates: tuple[float, float], sines: slice, cosines: slice) -> Act:
    """Policy of motors that follow clocks: the rates of the clocks plus a correction of the angle errors.

    rates: range of the motors; sines, cosines: slices of the observation that hold those of the angles.
    """

    def act(observation: Vector, t: float) -> Vector:
        wanted = np.array([clock.value(t) for clock in clocks])
        missed = np.angle(np.exp(1j * wanted) / (observation[cosines] + 1j * observation[sines]))
        asked = np.array([clock.rate(t) for clock in clocks]) + 20.0 * missed
        return np.asarray(2.0 * (asked - rates[0]) / (rates[1] - rates[0]) - 1.0)

    return act


def walked(env: GranularEnv, act: Act, **options: object) -> float:
    """Sum of the rewards of an episode, which is the distance covered (m); options: of its reset."""
    observation, info = env.reset(options=dict(options))
    total = 0.0
    while True:
        observation, reward, ended, cut, info = env.step(act(observation.astype(float), info["time_s"]))
        total += reward
        if ended or cut:
            return total
