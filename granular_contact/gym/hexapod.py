"""The hexapod, whose six hips an agent turns: as far ahead as it gets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Scenario, load
from granular_contact.gym.environment import GranularEnv
from granular_contact.results.observed import Observations

HIPS = tuple(f"hip_{row}_{side}" for row in ("front", "middle", "rear") for side in ("left", "right"))
# The legs that stand together in an alternating tripod: even ones, and odd ones.
TRIPOD = (0, 1, 1, 0, 0, 1)
# Motors of the hips: rad/s, N m s/rad, N m. The greatest rate is about that of the swing in configs/hexapod.yaml, whose
# gait was set by hand; the limit is that of the robot file.
RATES, GAIN, LIMIT = (0.0, 12.0), 0.1, 2.0
START = (0.0, 180.0)  # deg, of the hips of either tripod, as in that gait
HEIGHT = 0.065  # m
OVER = 60.0  # deg of roll or pitch, by which it has fallen over
SETTINGS = {"solver.accuracy": 0.1}


def scenario(end_time_s: float = 2.0) -> Scenario:
    """The hexapod of configs/hexapod.yaml with rates that are set at its hips, and steps for speed."""
    motor = {"type": "external", "rate_rad_s": 0.0, "range": RATES, "rate_gain_Nm_s_per_rad": GAIN, "limit_Nm": LIMIT}
    start = {hip: {"angle_deg": START[tripod]} for hip, tripod in zip(HIPS, TRIPOD, strict=True)}
    return load("hexapod").scenario.replace(
        SETTINGS
        | {
            "solver.end_time_s": end_time_s,
            "signals": {},
            "drives": dict.fromkeys(HIPS, motor),
            "initial.joints": start | {"trunk": {"z_m": HEIGHT}},
        }
    )


def see(seen: Observations) -> NDArray[np.float64]:
    """Of the trunk height, attitude, velocity and spin, in units of about one; of legs sine, cosine, rate, contact."""
    trunk, hips = seen.seen.bodies.index("trunk"), [seen.seen.joints.index(hip) for hip in HIPS]
    met = [seen.seen.met.index(hip.replace("hip", "leg")) for hip in HIPS]
    angles, velocity = seen.coordinates[hips], seen.velocities[trunk]
    body = [10.0 * seen.poses[trunk, 2:3], seen.poses[trunk, 3:], velocity[:3], 0.1 * velocity[3:]]
    return np.concatenate([*body, np.sin(angles), np.cos(angles), 0.1 * seen.rates[hips], seen.contacts[met]])


def fell(seen: Observations) -> bool:
    """Whether the trunk lies on a side, on its nose or on its tail."""
    return max(abs(seen["trunk_roll_deg"]), abs(seen["trunk_pitch_deg"])) > OVER


def hexapod_env(*, end_time_s: float = 2.0, **options: Any) -> GranularEnv:
    """The environment `granular_contact/Hexapod-v0`; the sum of its rewards is the distance in metres.

    options: as of `GranularEnv`, for example `vary={"initial.joints.trunk.z_m": (0.06, 0.07)}`.
    """
    given: dict[str, Any] = {"observation": see, "reward": "trunk_x_m", "terminated": fell}
    return GranularEnv(scenario(end_time_s), **(given | options))
