"""A policy of four numbers for the runner, found by an evolution strategy in two dozen episodes."""

from __future__ import annotations

import gymnasium
import numpy as np
from common import panels, save

import granular_contact.gym  # noqa: F401  # registers the environment

EPISODES, SPREAD = 24, 0.3
env = gymnasium.make("granular_contact/Runner-v0", end_time_s=0.5)


def distance(rates: np.ndarray) -> float:
    """How far (m) the runner gets with these rates of its four hips, from -1 to 1."""
    env.reset(seed=1)
    total, ended = 0.0, False
    while not ended:
        _, reward, fell, cut, _ = env.step(np.clip(rates, -1.0, 1.0).astype(np.float32))
        total, ended = total + float(reward), fell or cut
    return total


random = np.random.default_rng(3)
best, reached = np.full(4, 0.2), []
most = distance(best)
for _ in range(EPISODES):  # of a parent and a child the better one lives
    child = best + SPREAD * random.normal(size=4)
    if (got := distance(child)) > most:
        best, most = child, got
    reached.append(most)
print(f"from {1e3 * distance(np.full(4, 0.2)):.0f} to {1e3 * most:.0f} mm in 0.5 s, after {EPISODES} episodes")

figure, axes = panels(1)
axes.step(range(1, EPISODES + 1), 1e3 * np.array(reached), where="post")
axes.set(xlabel="episode", ylabel="best distance (mm)")
save(figure)
