"""When a mechanism stopped, read out of its trajectory.

A pendulum stops when its mean rate is first zero, whether it stays there or swings back. Of all else only rest is
told: one part of it, or one component of a velocity, may be zero while the rest still falls.
"""

from __future__ import annotations

import numpy as np

from granular_contact.multibody.observe import Observer
from granular_contact.results.stopping import Stop, Touch, find_stop, find_touch
from granular_contact.scene.types import Connection

STAYS = 0.02  # s at rest, where the run does not say how long


def stop_after(observer: Observer, touch: Touch) -> Stop | None:
    """When the mechanism stopped after the touch; None where it did not, or is driven."""
    scene = observer.scene
    if scene.drives or observer.way <= scene.least_way:
        return None
    if scene.pendulum is not None:
        return _stop_about_pivot(observer, scene.pendulum, touch.index)
    return _rest(observer, touch.index)


def _stop_about_pivot(observer: Observer, pivot: Connection, touch: int) -> Stop | None:
    """First zero of the mean rate after the touch, with the pivot's angle there."""
    trajectory = observer.trajectory
    rate, inertia = observer.mean_rate()
    moment = observer.weight_moment()
    if trajectory.load is not None:
        fx, fy, about_origin = trajectory.load.terms.sum(axis=1).T
        x, y = pivot.parent_point
        moment = moment + about_origin - (x * fy - y * fx)
    angle, angle_rate = observer.angle(pivot.child, pivot.child_point)
    after = slice(touch, None)
    return find_stop(trajectory.time[after], rate[after], (-moment / inertia)[after], -angle[after], -angle_rate[after])


def _rest(observer: Observer, touch: int) -> Stop | None:
    """When the fastest point last got slower than the rest speed, after the touch; with the angle of a single body."""
    solver, time, speeds = observer.scene.solver, observer.trajectory.time, observer.speeds
    moving = np.flatnonzero(speeds > solver.rest_speed)
    last = int(moving[-1]) if len(moving) else -1
    if last < max(touch, 1) or last == len(time) - 1:
        return None
    if time[-1] - time[last + 1] < (1.0 - 1e-6) * (solver.rest_time or STAYS):
        return None
    # From the side before: where something stops its speed has a kink.
    step, fast = time[last + 1] - time[last], speeds[last] - solver.rest_speed
    slope = (speeds[last - 1] - speeds[last]) / (time[last] - time[last - 1])
    instant = float(time[last] + (min(step, fast / slope) if slope > 0.0 else step))
    angle = None
    if len(observer.scene.bodies) == 1:
        angle = float(np.interp(instant, time, -observer.angle(*observer.scene.tip)[0]))
    return Stop(instant, angle, None)


def penetration_time(observer: Observer) -> float | None:
    """Time (s) from touch to the first zero of the vertical velocity of the lower end of what falls freely."""
    scene, time = observer.scene, observer.trajectory.time
    if scene.drives or scene.floating is None or observer.way <= scene.least_way:
        return None
    touch = find_touch(time, observer.all_depths())
    if touch is None or len(time) - touch.index < 3:
        return None
    after = slice(touch.index, None)
    body, point = scene.tip
    speed = observer.position(body, point)[1][after, 1]
    angle, rate = observer.angle(body, point)
    # Of the velocity itself, looking back only: at the stop the force of the medium jumps.
    slope = np.diff(speed) / np.diff(time[after])
    before = np.concatenate([slope[:1], slope[:1], slope[1:] + 0.5 * np.diff(slope)])[: len(speed)]
    stop = find_stop(time[after], speed, before, -angle[after], -rate[after], hub=False)
    return None if stop is None else stop.time - touch.time
