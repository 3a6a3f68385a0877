"""Motion that is left when a run ends because the mechanism has come to rest.

A run ends once everything has been slower than `rest_speed_m_s` for `rest_time_s`. A heavily damped mechanism can be as
slow as that long before it reaches its equilibrium. The speeds v_0 and v_1 at both ends of the rest time, t apart, show
how fast they decay. An exponential decay with the time constant T = t / ln(v_0 / v_1) leaves the displacement

    v_1 T (1 - exp(-(end time - now) / T)).

Limits: a speed that changes its sign within the rest time is a vibration, which leaves no displacement. A speed that
grows counts as constant.
"""

from __future__ import annotations

import numpy as np

from granular_contact.mechanics.kinematics import Kinematics
from granular_contact.scene.types import Vector

LEAST_SPEED = 1e-9  # of the rest speed: slower motion is round-off


def motion_left(motion: Kinematics) -> float:
    """Greatest displacement (m) of a point that is left before the end time; 0 unless the run ended at rest."""
    trajectory, rest_time, solver = motion.trajectory, motion.scene.rest_time, motion.scene.solver
    if trajectory.status.code != "rest" or rest_time is None:
        return 0.0
    speeds = trajectory.v * motion.lever
    return displacement_left(trajectory.time, speeds, rest_time, solver.rest_speed_m_s, solver.end_time_s)


def displacement_left(time: Vector, speeds: Vector, rest_time: float, rest_speed: float, end_time: float) -> float:
    """Greatest displacement (m) that is left.

    time (n,) s; speeds (n, k) m/s of points, with their signs; rest_time s, rest_speed m/s, end_time s of the run.
    """
    first = max(0, int(np.searchsorted(time, time[-1] - rest_time, side="right")) - 1)
    lasted, remaining = float(time[-1] - time[first]), end_time - float(time[-1])
    since = speeds[first:]
    one_way = (since >= 0.0).all(axis=0) | (since <= 0.0).all(axis=0)
    creeps = one_way & (np.abs(since[-1]) > LEAST_SPEED * rest_speed)
    if remaining <= 0.0 or lasted <= 0.0 or not creeps.any():
        return 0.0
    now = np.abs(since[-1, creeps])
    before = np.maximum(now, np.abs(since[0, creeps]))
    rate = np.maximum(np.log(before / now) / lasted, 1e-6 / remaining)  # 1/s; with the least rate the speed is constant
    return float(np.max(now / rate * -np.expm1(-rate * remaining)))
