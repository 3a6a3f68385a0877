"""A policy for the runner, found by a plain evolution strategy, compared with the gait set by hand.

    python validation/runner_policy.py [--quick]

The environment is `granular_contact/Runner-v0`: 2 s on close-packed poppy seeds, with four motors that have a range of
rates and a limit of torque. The policy is one formula with eleven weights for all four legs. It gives the rate of a leg
from its own angle, the angles of two other legs relative to it, its contact, and the pitch of the trunk. The gait set
by hand is the clock of configs/runner.yaml. It is followed exactly, with unlimited torque, or by the motors of the
policy.
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
# For each leg of HIPS the index of the other leg on its side, and of the opposite leg on the other side.
SAME_SIDE, OTHER_SIDE = [1, 0, 3, 2], [2, 3, 0, 1]
SIZE = 11


def policy(weights: Vector) -> Act:
    """Policy with the same weights (11,) for each leg: actions (4,) from an observation."""

    def act(observation: Vector, _: float) -> Vector:
        sine, cosine, contact = observation[5:9], observation[9:13], observation[17:21]
        features = [np.ones(4), sine, cosine, contact, np.full(4, observation[1]), np.full(4, observation[4])]
        features.append(
            np.array([1.0, -1.0, 1.0, -1.0]) * observation[1]
        )  # pitch with opposite signs for front and rear legs
        for other in (SAME_SIDE, OTHER_SIDE):
            features.append(sine[other] * cosine - cosine[other] * sine)
            features.append(cosine[other] * cosine + sine[other] * sine)
        return np.asarray(np.tanh(weights @ np.array(features)))

    return act


def by_hand() -> Act:
    """Policy of motors that follow the clock of configs/runner.yaml: its rate, plus a correction of the angle error."""
    clocks = [Buehler(2.0, np.pi / 2, np.pi / 2, 0.5, 0.0 if hip.endswith("a") else 0.5, 0.05) for hip in HIPS]

    return policies.following(clocks, RATES, slice(5, 9), slice(9, 13))


@cache
def env() -> GranularEnv:
    """Environment of this process, made once."""
    return runner_env(end_time_s=END)


def walked(act: Act, **options: object) -> float:
    """Distance (m) covered in an episode; options: of its reset."""
    return policies.walked(env(), act, **options)


def score(weights: Vector) -> float:
    """Distance (m) covered with the policy of these weights."""
    return walked(policy(weights))


def study(quick: bool = False) -> Outcome:
    """Run the search; table of the distances of all gaits, and the progress of the search."""
    generations, population = (6, 12) if quick else (20, 16)
    weights, history, seconds = policies.evolved(generations, population, score, SIZE)
    exact = simulate(load(CONFIG, [f"solver.end_time_s={END}", "solver.accuracy=1e-2"])).summary["distance_m"]
    sands = {"as trained": {}, "looser, zeta 0.4": {"medium.zeta": 0.4}, "denser, zeta 0.7": {"medium.zeta": 0.7}}
    distances = {name: [walked(act, **sand) for sand in sands.values()] for name, act in _acts(weights).items()}
    rows = [[name, *(f"{1e3 * distance:.0f}" for distance in of_gait)] for name, of_gait in distances.items()]
    rows.append(["by hand, followed exactly", f"{1e3 * exact:.0f}", "", ""])
    table = markdown(["gait", *(f"mm in {END:g} s, {sand}" for sand in sands)], rows)
    best = ", ".join(f"{1e3 * distance:.0f}" for distance in history)
    tried = f"{generations * population} episodes in {seconds:.0f} s on {PROCESSES} processes; best so far, mm: {best}"
    numbers = ", ".join(f"{weight:.3f}" for weight in weights)
    ahead = distances["policy"][0] / max(exact, distances["by hand, by the motors"][0])
    claim = Claim(
        "runner_policy.the policy walks farther than the gait set by hand", ahead > 1.0, f"{ahead:.2f} times as far"
    )
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
