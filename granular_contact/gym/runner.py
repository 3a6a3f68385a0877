"""Environment of the runner: an agent sets the rates of its four hips; the reward is its distance to the right."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Scenario, load
from granular_contact.gym.environment import GranularEnv
from granular_contact.results.observed import Observations

HIPS = ("hip_front_a", "hip_rear_a", "hip_front_b", "hip_rear_b")
# Motors of the hips: range of rates (rad/s), gain (N m s/rad), limit (N m). The greatest rate is about that of the
# swing in configs/runner.yaml, whose gait was set by hand: it has two strides per second, and the swing takes half of a
# stride for three quarters of a turn. That gait needs 0.03 N m.
RATES, GAIN, LIMIT = (0.0, 20.0), 5e-3, 0.1
START = {"a": 90.0, "b": 270.0}  # deg, initial angles of the hips of both sides: half a turn apart, as in that gait
FALLEN = 90.0  # deg, angle of the trunk beyond which it has fallen over
SETTINGS = {"solver.accuracy": 0.05, "load.strips_per_rigid_part": 8}


def scenario(end_time_s: float = 2.0) -> Scenario:
    """The runner of configs/runner.yaml with motors whose rates are set, and coarser steps and strips for speed."""
    shipped = load("runner").scenario
    motor = {"type": "external", "rate_rad_s": 0.0, "range": RATES, "rate_gain_Nm_s_per_rad": GAIN, "limit_Nm": LIMIT}
    start = {"trunk": {"x_m": 0.0, "y_m": 0.045}} | {hip: {"angle_deg": START[hip[-1]]} for hip in HIPS}
    return shipped.replace(
        SETTINGS
        | {
            "solver.end_time_s": end_time_s,
            "signals": {},
            "drives": dict.fromkeys(HIPS, motor),
            "initial.joints": start,
        }
    )


def observation(observations: Observations) -> NDArray[np.float64]:
    """Observation of the agent, in units of about one.

    Height, angle, velocity and angular velocity of the trunk; sine and cosine of the angle, rate and contact of each
    leg.
    """
    trunk = [10.0 * observations["trunk_y_m"], observations["trunk_orientation_rad"]]
    trunk += [observations["trunk_vx_m_s"], observations["trunk_vy_m_s"], 0.1 * observations["trunk_spin_rad_s"]]
    names = observations.seen
    hips = [names.joints.index(hip) for hip in HIPS]
    legs = [names.met.index(hip.removeprefix("hip_")) for hip in HIPS]
    angles, rates, contacts = observations.coordinates[hips], observations.rates[hips], observations.contacts[legs]
    return np.concatenate([trunk, np.sin(angles), np.cos(angles), 0.1 * rates, contacts])


def has_fallen(observations: Observations) -> bool:
    """Whether the trunk has turned by more than `FALLEN`, onto its end."""
    return abs(observations["trunk_orientation_deg"]) > FALLEN


def runner_env(*, end_time_s: float = 2.0, **options: Any) -> GranularEnv:
    """Create the environment `granular_contact/Runner-v0`; the sum of its rewards is the distance in metres.

    Parameters
    ----------
    end_time_s : float, optional
        Duration (s) of an episode, after which it is truncated.
    **options
        Keyword arguments of `GranularEnv`, for example `vary={"medium.zeta": (0.4, 0.6)}`. They also replace the
        observation, the reward and the termination of this environment.

    Returns
    -------
    GranularEnv
        Its action (4,) sets the rates of the hips in the order of `HIPS`: -1 is the least and 1 the greatest of `RATES`
        (rad/s, clockwise). `observation` makes its observation (21,). The reward is the increase of `trunk_x_m`. An
        episode is terminated when `has_fallen` is true.

    Raises
    ------
    ConfigError
        `end_time_s` is not allowed in a config.
    ControlError, KeyError, SceneError, SolveError
        As `GranularEnv`.
    """
    defaults: dict[str, Any] = {"observation": observation, "reward": "trunk_x_m", "terminated": has_fallen}
    return GranularEnv(scenario(end_time_s), **(defaults | options))
