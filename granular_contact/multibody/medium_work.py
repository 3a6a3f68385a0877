"""Work of the media and of the floor over a run, as the motion has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.energy import accumulate, work
from granular_contact.multibody.history import LoadHistory
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.multibody.observe import Observer


def medium_works(observer: Observer) -> tuple[Vector, Vector]:
    """Work (n,) J of all media, and of the floor, since the start.

    The bed integrates the power of its forces by the trapezoidal rule, which is off where a force jumps within a step,
    and in long steps. On a rigid body the forces have a resultant, whose work is the mean force of a step times its
    mean velocity (see `energy.work`). Of a flexible link the bed's own integral stays. A step in which the floor was
    touched has its difference with the floor, which is far stiffer.
    """
    load = observer.trajectory.load
    assert load is not None
    if not observer.scene.media or observer.scene.method is not None:
        return load.work, load.floor_work  # integrated with the motion
    more = np.zeros_like(load.time)
    for i, name in enumerate(load.body_names):
        if name in observer.system.rigid:
            more += _difference(observer, load, name, load.bodies[:, i])
    steps = np.diff(more, prepend=0.0)
    touched = np.diff(load.floor_work, prepend=0.0) != 0.0
    at_floor = np.cumsum(np.where(touched, steps, 0.0))
    return load.work + more - at_floor, load.floor_work + at_floor


def _difference(observer: Observer, load: LoadHistory, name: str, wrench: Vector) -> Vector:
    """By how much (n,) J the work on a rigid body differs from the trapezoidal rule; wrench (n, 3) about the origin."""
    center, velocity = observer.center(name)
    rate = observer.angle(name, np.zeros(2))[1]
    moment = wrench[:, 2] - center[:, 0] * wrench[:, 1] + center[:, 1] * wrench[:, 0]
    force, twist = np.column_stack([wrench[:, :2], moment]), np.column_stack([velocity, rate])
    return work(load.time, force, twist) - accumulate(load.time, np.sum(force * twist, axis=1))
