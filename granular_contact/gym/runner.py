"""The runner, whose four hips an agent turns: as far to the right as it gets."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.config import Scenario, load
from granular_contact.gym.environment import GranularEnv
from granular_contact.results.observed import Observations

HIPS = ("hip_front_a", "hip_rear_a", "hip_front_b", "hip_rear_b")
# Motors of the hips: rad/s, N m s/rad, N m. The greatest rate is about that of the swing in configs/runner.yaml, whose
# gait was set by hand: two strides a second, half of whose time the swing takes for three quarters of a turn. That gait
# needs 0.03 N m.
RATES, GAIN, LIMIT = (0.0, 20.0), 5e-3, 0.1
START = {"a": 90.0, "b": 270.0}  # deg, of the hips of either side: half a turn apart, as in that gait
OVER = 90.0  # deg, by which the trunk has fallen over
SETTINGS = {"solver.accuracy": 0.05, "load.strips_per_rigid_part": 8}


def scenario(end_time_s: float = 2.0) -> Scenario:
    """The runner of configs/runner.yaml with rates that are set at its hips, and steps for speed."""
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


def see(seen: Observations) -> NDArray[np.float64]:
    """Of the trunk height, angle and rates, in units of about one; of each leg angle (sine, cosine), rate, contact."""
    trunk = [10.0 * seen["trunk_y_m"], seen["trunk_orientation_rad"], seen["trunk_vx_m_s"], seen["trunk_vy_m_s"]]
    hips = [seen.seen.joints.index(hip) for hip in HIPS]
    met = [seen.seen.met.index(hip.removeprefix("hip_")) for hip in HIPS]
    angles, rates, contacts = seen.coordinates[hips], seen.rates[hips], seen.contacts[met]
    spin = 0.1 * seen["trunk_spin_rad_s"]
    return np.concatenate([trunk, [spin], np.sin(angles), np.cos(angles), 0.1 * rates, contacts])


def fell(seen: Observations) -> bool:
    """Whether the trunk stands on its end."""
    return abs(seen["trunk_orientation_deg"]) > OVER


def runner_env(*, end_time_s: float = 2.0, **options: Any) -> GranularEnv:
    """The environment `granular_contact/Runner-v0`; the sum of its rewards is the distance in metres.

    options: as of `GranularEnv`, for example `vary={"medium.zeta": (0.4, 0.6)}`.
    """
    given: dict[str, Any] = {"observation": see, "reward": "trunk_x_m", "terminated": fell}
    return GranularEnv(scenario(end_time_s), **(given | options))
