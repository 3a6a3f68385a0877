"""An environment from a config: an agent sets hip and knee of a leg; the distance of its carriage is the reward."""

from __future__ import annotations

import math

import numpy as np
from common import panels, save

from granular_contact import load
from granular_contact.gym import GranularEnv


def motor(least: float, greatest: float) -> dict[str, object]:
    """A PD control whose target (deg) the agent sets."""
    gains = {"gain_Nm_per_rad": 4, "rate_gain_Nm_s_per_rad": 0.04, "limit_Nm": 2}
    return {"type": "external", "angle_deg": 60.0, "range": [least, greatest]} | gains


env = GranularEnv(
    load("stepping_leg", drives={"swing": motor(40, 80), "knee": motor(40, 80)}, solver={"end_time_s": 2.0}),
    observation=("swing_angle_deg", "knee_angle_deg", "carriage_vx_m_s"),
    reward="carriage_x_m",  # its increase; or a function of what is seen before and after a step
    control_rate_Hz=50,
    vary={"medium.zeta": (0.9, 1.1)},
)
# The policy is a clock: once a second, the knee a quarter of a period behind the hip.
seen, _ = env.reset(seed=1)
time, paid, ended = [0.0], [0.0], False
while not ended:
    phase = 2.0 * math.pi * time[-1]
    seen, reward, fallen, cut, info = env.step(np.array([math.sin(phase), -math.cos(phase)], np.float32))
    time.append(time[-1] + 0.02)
    paid.append(paid[-1] + reward)
    ended = fallen or cut
print(f"{1e3 * paid[-1]:.0f} mm in {time[-1]:.1f} s, {info['status']}")

figure, axes = panels(1)
axes.plot(time, 1e3 * np.array(paid))
axes.set(xlabel="time (s)", ylabel="sum of rewards (mm)")
save(figure)
