"""Environment of the hexapod: an agent sets the rates of its six hips; the reward is its distance ahead."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Scenario, load
from granular_contact.gym.environment import GranularEnv
from granular_contact.results.observed import Observations

HIPS = tuple(f"hip_{row}_{side}" for row in ("front", "middle", "rear") for side in ("left", "right"))
# Alternating tripod gait: the tripod of each leg, in the order of HIPS; legs of one tripod stand together.
TRIPOD = (0, 1, 1, 0, 0, 1)
# Motors of the hips: range of rates (rad/s), gain (N m s/rad), limit (N m). The greatest rate is about that of the
# swing in configs/hexapod.yaml, whose gait was set by hand; the limit is that of the robot file.
RATES, GAIN, LIMIT = (0.0, 12.0), 0.1, 2.0
START = (0.0, 180.0)  # deg, initial angles of the hips of both tripods, as in that gait
HEIGHT = 0.065  # m, of the trunk at the start
FALLEN = 60.0  # deg of roll or pitch, beyond which it has fallen over
SETTINGS = {"solver.accuracy": 0.1}


def scenario(end_time_s: float = 2.0) -> Scenario:
    """The hexapod of configs/hexapod.yaml with motors whose rates are set, and a coarser accuracy for speed."""
    motor = {"type": "external", "rate_rad_s": 0.0, "range": RATES, "rate_gain_Nm_s_per_rad": GAIN, "limit_Nm": LIMIT}
    start = {hip: {"angle_deg": START[tripod]} for hip, tripod in zip(HIPS, TRIPOD, strict=True)}
    undriven = load("hexapod").scenario.replace({"drives": None, "signals": None})
    return undriven.replace(
        SETTINGS
        | {
            "solver.end_time_s": end_time_s,
            "drives": dict.fromkeys(HIPS, motor),  # actions are in the order of HIPS, as is the observation
            "initial.joints": start | {"trunk": {"z_m": HEIGHT}},
        }
    )


def observation(observations: Observations) -> NDArray[np.float64]:
    """Observation of the agent, in units of about one.

    Height, attitude, velocity and angular velocity of the trunk; sine and cosine of the angle, rate and contact of each
    leg.
    """
    names = observations.seen
    trunk, hips = names.bodies.index("trunk"), [names.joints.index(hip) for hip in HIPS]
    legs = [names.met.index(hip.replace("hip", "leg")) for hip in HIPS]
    angles, rates, contacts = observations.coordinates[hips], observations.rates[hips], observations.contacts[legs]
    pose, velocity = observations.poses[trunk], observations.velocities[trunk]
    body = [10.0 * pose[2:3], pose[3:], velocity[:3], 0.1 * velocity[3:]]
    return np.concatenate([*body, np.sin(angles), np.cos(angles), 0.1 * rates, contacts])


def has_fallen(observations: Observations) -> bool:
    """Whether the trunk lies on a side, on its nose or on its tail."""
    return max(abs(observations["trunk_roll_deg"]), abs(observations["trunk_pitch_deg"])) > FALLEN


def hexapod_env(*, end_time_s: float = 2.0, **options: Any) -> GranularEnv:
    """Create the environment `granular_contact/Hexapod-v0`; the sum of its rewards is the distance in metres.

    Parameters
    ----------
    end_time_s : float, optional
        Duration (s) of an episode, after which it is truncated.
    **options
        Keyword arguments of `GranularEnv`, for example `vary={"initial.joints.trunk.z_m": (0.06, 0.07)}`. They also
        replace the observation, the reward and the termination of this environment.

    Returns
    -------
    GranularEnv
        Its action (6,) sets the rates of the hips: -1 is the least and 1 the greatest of `RATES` (rad/s, right-handed).
        The hips of the action and of the observation (34,), which `observation` makes, are in the order of `HIPS`. The
        reward is the increase of `trunk_x_m`. An episode is terminated when `has_fallen` is true.

    Raises
    ------
    ConfigError
        `end_time_s` is not allowed in a config.
    ControlError, KeyError, SceneError, SolveError
        As `GranularEnv`.
    """
    defaults: dict[str, Any] = {"observation": observation, "reward": "trunk_x_m", "terminated": has_fallen}
    return GranularEnv(scenario(end_time_s), **(defaults | options))
