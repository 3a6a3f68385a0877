"""A policy for the runner, found by a plain evolution strategy, against the gait that was set by hand.

    python validation/runner_policy.py [--quick]

The environment is `granular_contact/Runner-v0`: 2 s on close-packed poppy seeds, four motors with a range of rates and
a limit of torque. The policy is one formula for all four legs, of eleven numbers: the rate of a leg from its own angle,
the angles of two others relative to it, its contact, and the pitch of the trunk. The gait set by hand is the clock of
configs/runner.yaml: followed exactly, whatever torque that takes, and followed by the same motors as the policy has.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import load, simulate
from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.runner import HIPS, RATES, runner_env
from granular_contact.scene.signals import Buehler
from validation import policies
from validation.policies import PROCESSES, Act, Vector
from validation.study import Claim, Outcome, script
from validation.tables import markdown

CONFIG = Path(__file__).parents[1] / "configs" / "runner.yaml"
END = 2.0  # s
# Of each leg the other one of its side, and that of the other side at its place; legs as of HIPS.
SAME_SIDE, OTHER_SIDE = [1, 0, 3, 2], [2, 3, 0, 1]
SIZE = 11


def policy(weights: Vector) -> Act:
    """Actions (4,) from what is seen, by the same weights (11,) for each leg."""

    def act(seen: Vector, _: float) -> Vector:
        sine, cosine, contact = seen[5:9], seen[9:13], seen[17:21]
        features = [np.ones(4), sine, cosine, contact, np.full(4, seen[1]), np.full(4, seen[4])]
        features.append(np.array([1.0, -1.0, 1.0, -1.0]) * seen[1])  # front legs and rear ones
        for other in (SAME_SIDE, OTHER_SIDE):
            features.append(sine[other] * cosine - cosine[other] * sine)
            features.append(cosine[other] * cosine + sine[other] * sine)
        return np.asarray(np.tanh(weights @ np.array(features)))

    return act


def by_hand() -> Act:
    """The clock of configs/runner.yaml, followed by the motors: its rate, and what makes up for the angle missed."""
    clocks = [Buehler(2.0, np.pi / 2, np.pi / 2, 0.5, 0.0 if hip.endswith("a") else 0.5, 0.05) for hip in HIPS]

    return policies.following(clocks, RATES, slice(5, 9), slice(9, 13))


@cache
def env() -> GranularEnv:
    """The environment of a process."""
    return runner_env(end_time_s=END)


def walked(act: Act, **options: object) -> float:
    """Way (m) of an episode; options: of its reset."""
    return policies.walked(env(), act, **options)


def score(weights: Vector) -> float:
    """Way (m) under a policy."""
    return walked(policy(weights))


def study(quick: bool = False) -> Outcome:
    """Ways of the gaits, and how the strategy got on."""
    generations, population = (6, 12) if quick else (20, 16)
    weights, history, seconds = policies.evolved(generations, population, score, SIZE)
    exact = simulate(load(CONFIG, [f"solver.end_time_s={END}", "solver.accuracy=1e-2"])).summary["distance_m"]
    sands = {"as trained": {}, "looser, zeta 0.4": {"medium.zeta": 0.4}, "denser, zeta 0.7": {"medium.zeta": 0.7}}
    ways = {name: [walked(act, **sand) for sand in sands.values()] for name, act in _acts(weights).items()}
    rows = [[name, *(f"{1e3 * one:.0f}" for one in found)] for name, found in ways.items()]
    rows.append(["by hand, followed exactly", f"{1e3 * exact:.0f}", "", ""])
    table = markdown(["gait", *(f"mm in {END:g} s, {sand}" for sand in sands)], rows)
    best = ", ".join(f"{1e3 * one:.0f}" for one in history)
    tried = f"{generations * population} episodes in {seconds:.0f} s on {PROCESSES} processes; best so far, mm: {best}"
    numbers = ", ".join(f"{one:.3f}" for one in weights)
    ahead = ways["policy"][0] / max(exact, ways["by hand, by the motors"][0])
    claim = Claim("runner_policy.it walks farther than the gait set by hand", ahead > 1.0, f"{ahead:.2f} times as far")
    return Outcome(f"{table}\n\n{tried}\n\nweights: {numbers}", (claim,))


def _acts(weights: Vector) -> dict[str, Act]:
    return {
        "policy": policy(weights),
        "by hand, by the motors": by_hand(),
        "all motors at half of their rate": lambda *_: np.zeros(4),
        "all motors at their rate": lambda *_: np.ones(4),
    }


if __name__ == "__main__":
    sys.exit(script(study))
