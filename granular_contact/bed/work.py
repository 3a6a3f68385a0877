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
    and in long steps. The work of the resultant on a body is the mean force of a step times its mean velocity (see
    `energy.work`); of a flexible link only what the forces do in bending it stays as the bed has it. A step in which
    the floor was touched has its difference with the floor, which is far stiffer.
    """
    load = observer.trajectory.load
    assert load is not None
    if not observer.scene.media or observer.scene.method is not None:
        return load.work, load.floor_work  # integrated with the motion
    more = _more(observer, load)
    steps = np.diff(more, prepend=0.0)
    touched = np.diff(load.floor_work, prepend=0.0) != 0.0
    at_floor = np.cumsum(np.where(touched, steps, 0.0))
    return load.work + more - at_floor, load.floor_work + at_floor


def uncertain_work(observer: Observer) -> float:
    """By how much (J) the work on bodies differs at most between the two rules, both of second order.

    It is what the steps leave open of the energy that the medium took: next to nothing where forces and velocities
    change little in a step.
    """
    load = observer.trajectory.load
    return 0.0 if load is None or not observer.scene.media else float(np.abs(_more(observer, load)).max(initial=0.0))


def _more(observer: Observer, load: LoadHistory) -> Vector:
    """What the mean forces on bodies do (n,) J beyond the mean powers."""
    every = [_difference(observer, load, name, load.bodies[:, i]) for i, name in enumerate(load.body_names)]
    more: Vector = np.sum([np.zeros_like(load.time), *every], axis=0)
    return more


def _difference(observer: Observer, load: LoadHistory, name: str, wrench: Vector) -> Vector:
    """By how much (n,) J the work on a body differs from the trapezoidal rule; wrench (n, 3) about the origin."""
    center, velocity = observer.center(name)
    rate = observer.angle(name, np.zeros(2))[1] if name in observer.system.rigid else _spin(observer, name, center)
    moment = wrench[:, 2] - center[:, 0] * wrench[:, 1] + center[:, 1] * wrench[:, 0]
    force, twist = np.column_stack([wrench[:, :2], moment]), np.column_stack([velocity, rate])
    return work(load.time, force, twist) - accumulate(load.time, np.sum(force * twist, axis=1))


def _spin(observer: Observer, name: str, center: Vector) -> Vector:
    """Mean rate (n,) rad/s of a flexible link: its angular momentum over its inertia about its centre of mass."""
    places = np.array(observer.nodes(name)).ravel()
    q, v = observer.trajectory.q[:, places], observer.trajectory.v[:, places]
    mass = observer.trajectory.mass[places][:, places]
    turn = np.empty_like(q)
    turn[:, 0::4], turn[:, 1::4] = center[:, [1]] - q[:, 1::4], q[:, 0::4] - center[:, [0]]
    turn[:, 2::4], turn[:, 3::4] = -q[:, 3::4], q[:, 2::4]
    momenta = turn @ mass
    spin: Vector = np.sum(momenta * v, axis=1) / np.sum(momenta * turn, axis=1)
    return spin
