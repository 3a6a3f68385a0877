"""A policy for the hexapod, found by a plain evolution strategy, compared with the gait set by hand.

    python validation/hexapod_policy.py [--quick]

The environment is `granular_contact/Hexapod-v0`: 2 s on sand, with six motors that have a range of rates and a limit of
torque. The policy is one formula with twelve weights for all six legs. It gives the rate of a leg from its own angle
and contact, from the angles of the legs of its tripod and of the other tripod, and from the attitude of the trunk. The
evolution strategy is that of `policies`. The gait set by hand is that of configs/hexapod.yaml. It is followed exactly,
with unlimited torque, or by the motors of the policy.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from granular_contact import load, simulate
from granular_contact.gym.environment import GranularEnv
from granular_contact.gym.hexapod import RATES, TRIPOD, hexapod_env
from granular_contact.scene.signals import Buehler
from validation import policies
from validation.policies import PROCESSES, Act, Vector
from validation.study import Claim, Outcome, script
from validation.tables import markdown

END = 2.0  # s
SIZE = 12
PLACE, SIDE = (
    np.repeat([1.0, 0.0, -1.0], 2),
    np.tile([1.0, -1.0], 3),
)  # position of each leg: from front (1) to rear (-1), left (1) and right (-1)
SAME = np.equal.outer(TRIPOD, TRIPOD) / 3.0  # (6, 6): weights of the mean over the legs of the same tripod
OTHER = 1.0 / 3.0 - SAME


def policy(weights: Vector) -> Act:
    """Policy with the same weights (12,) for each leg: actions (6,) from an observation."""

    def act(observation: Vector, _: float) -> Vector:
        roll, pitch, yaw = observation[1:4]
        sine, cosine, contact = observation[10:16], observation[16:22], observation[28:34]
        features = [np.ones(6), sine, cosine, contact, pitch * np.ones(6), pitch * PLACE, roll * SIDE, yaw * SIDE]
        for mean in (SAME, OTHER):
            s, c = mean @ sine, mean @ cosine
            features += [s * cosine - c * sine, c * cosine + s * sine]
        return np.asarray(np.tanh(weights @ np.array(features)))

    return act


def by_hand() -> Act:
    """Policy of motors that follow the clock of configs/hexapod.yaml: its rate plus a correction of the angle error."""
    clocks = [Buehler(1.0, np.radians(60.0), 0.0, 0.55, 0.5 * tripod, 0.05) for tripod in TRIPOD]

    return policies.following(clocks, RATES, slice(10, 16), slice(16, 22))


@cache
def env() -> GranularEnv:
    """Environment of this process, made once."""
    return hexapod_env(end_time_s=END)


def walked(act: Act, **options: object) -> float:
    """Distance (m) covered ahead in an episode; options: of its reset."""
    return policies.walked(env(), act, **options)


def score(weights: Vector) -> float:
    """Distance (m) covered ahead with the policy of these weights."""
    return walked(policy(weights))


def study(quick: bool = False) -> Outcome:
    """Run the search; table of the distances of all gaits, and the progress of the search."""
    generations, population = (3, 8) if quick else (20, 16)
    weights, history, seconds = policies.evolved(generations, population, score, SIZE)
    exact = simulate(load("hexapod", [f"solver.end_time_s={END}"])).summary["distance_m"]
    sands = {"as trained": {}, "weaker, mu_int 0.8": {"medium.mu_int": 0.8}}
    gaits: dict[str, Act] = {
        "policy": policy(weights),
        "by hand, by the motors": by_hand(),
        "all motors at half of their rate": lambda *_: np.zeros(6),
        "all motors at their rate": lambda *_: np.ones(6),
    }
    distances = {name: [walked(act, **sand) for sand in sands.values()] for name, act in gaits.items()}
    rows = [[name, *(f"{1e3 * distance:.0f}" for distance in of_gait)] for name, of_gait in distances.items()]
    rows.append(["by hand, followed exactly", f"{1e3 * exact:.0f}", ""])
    table = markdown(["gait", *(f"mm in {END:g} s, {sand}" for sand in sands)], rows)
    best = ", ".join(f"{1e3 * distance:.0f}" for distance in history)
    tried = f"{generations * population} episodes in {seconds:.0f} s on {PROCESSES} processes; best so far, mm: {best}"
    numbers = ", ".join(f"{weight:.3f}" for weight in weights)
    ahead = distances["policy"][0] / max(exact, distances["by hand, by the motors"][0])
    claim = Claim(
        "hexapod_policy.the policy walks farther than the gait set by hand", ahead > 1.0, f"{ahead:.2f} times as far"
    )
    return Outcome(f"{table}\n\n{tried}; seed 1\n\nweights: {numbers}", (claim,))


if __name__ == "__main__":
    sys.exit(script(study))
