"""A policy for the hexapod, found by a plain evolution strategy, against the gait that was set by hand.

    python validation/hexapod_policy.py [--quick]

The environment is `granular_contact/Hexapod-v0`: 2 s on sand, six motors with a range of rates and a limit of torque.
The policy is one formula for all six legs, of twelve numbers: the rate of a leg from its own angle and contact, from
where the legs of its tripod and those of the other one are, and from the attitude of the trunk. The strategy is that of
`policies`. The gait set by hand is that of configs/hexapod.yaml: followed exactly, whatever torque that takes, and
followed by the same motors as the policy has.
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
PLACE, SIDE = np.repeat([1.0, 0.0, -1.0], 2), np.tile([1.0, -1.0], 3)  # of legs: from front to rear, left and right
SAME = np.equal.outer(TRIPOD, TRIPOD) / 3.0  # (6, 6): means over the legs of the same tripod
OTHER = 1.0 / 3.0 - SAME


def policy(weights: Vector) -> Act:
    """Actions (6,) from what is seen, by the same weights (12,) for each leg."""

    def act(seen: Vector, _: float) -> Vector:
        roll, pitch, yaw = seen[1:4]
        sine, cosine, contact = seen[10:16], seen[16:22], seen[28:34]
        features = [np.ones(6), sine, cosine, contact, pitch * np.ones(6), pitch * PLACE, roll * SIDE, yaw * SIDE]
        for others in (SAME, OTHER):
            s, c = others @ sine, others @ cosine
            features += [s * cosine - c * sine, c * cosine + s * sine]
        return np.asarray(np.tanh(weights @ np.array(features)))

    return act


def by_hand() -> Act:
    """The clock of configs/hexapod.yaml, followed by the motors: its rate, and what makes up for the angle missed."""
    clocks = [Buehler(1.0, np.radians(60.0), 0.0, 0.55, 0.5 * tripod, 0.05) for tripod in TRIPOD]

    return policies.following(clocks, RATES, slice(10, 16), slice(16, 22))


@cache
def env() -> GranularEnv:
    """The environment of a process."""
    return hexapod_env(end_time_s=END)


def walked(act: Act, **options: object) -> float:
    """Way ahead (m) of an episode; options: of its reset."""
    return policies.walked(env(), act, **options)


def score(weights: Vector) -> float:
    """Way ahead (m) under a policy."""
    return walked(policy(weights))


def study(quick: bool = False) -> Outcome:
    """Ways of the gaits, and how the strategy got on."""
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
    ways = {name: [walked(act, **sand) for sand in sands.values()] for name, act in gaits.items()}
    rows = [[name, *(f"{1e3 * one:.0f}" for one in found)] for name, found in ways.items()]
    rows.append(["by hand, followed exactly", f"{1e3 * exact:.0f}", ""])
    table = markdown(["gait", *(f"mm in {END:g} s, {sand}" for sand in sands)], rows)
    best = ", ".join(f"{1e3 * one:.0f}" for one in history)
    tried = f"{generations * population} episodes in {seconds:.0f} s on {PROCESSES} processes; best so far, mm: {best}"
    numbers = ", ".join(f"{one:.3f}" for one in weights)
    ahead = ways["policy"][0] / max(exact, ways["by hand, by the motors"][0])
    claim = Claim("hexapod_policy.it walks farther than the gait set by hand", ahead > 1.0, f"{ahead:.2f} times as far")
    return Outcome(f"{table}\n\n{tried}; seed 1\n\nweights: {numbers}", (claim,))


if __name__ == "__main__":
    sys.exit(script(study))
