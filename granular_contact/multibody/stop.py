"""When a mechanism stopped, read out of its trajectory with the measure that fits it."""

from __future__ import annotations

import numpy as np

from granular_contact.multibody.observe import Observer
from granular_contact.scene.types import Connection
from granular_contact.stopping import Stop, find_stop


def stop_after(observer: Observer, touch: int) -> Stop | None:
    """When the mechanism stopped after the touch (index of that instant); None where there is none."""
    scene = observer.scene
    if scene.drives or observer.way <= scene.least_way:
        return None
    if scene.pivot is not None:
        return _stop_about_pivot(observer, scene.pivot, touch)
    return _stop_of_fall(observer, touch) if scene.floating is not None else None


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


def _stop_of_fall(observer: Observer, touch: int) -> Stop | None:
    """First zero of the vertical velocity of the lower end after the touch, with the angle of its body there."""
    time, after = observer.trajectory.time, slice(touch, None)
    if len(time[after]) < 3:
        return None
    body, point = observer.scene.tip
    speed = observer.position(body, point)[1][after, 1]
    angle, rate = observer.angle(body, point)
    # Of the velocity itself, looking back only: at the stop the force of the medium jumps.
    slope = np.diff(speed) / np.diff(time[after])
    before = np.concatenate([slope[:1], slope[:1], slope[1:] + 0.5 * np.diff(slope)])[: len(speed)]
    return find_stop(time[after], speed, before, -angle[after], -rate[after], hub=False)
