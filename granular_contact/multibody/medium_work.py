"""Work of the media and of the floor over a run, as the motion has it (see `bed.work`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.bed.work import Motion, beyond
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.multibody.kinematics import Kinematics


def medium_works(observer: Kinematics) -> tuple[Vector, Vector]:
    """Work (n,) J of all media, and of the floor, since the start.

    A step in which the floor was touched has its difference with the floor, which is far stiffer.
    """
    load = observer.trajectory.load
    assert load is not None
    if not observer.scene.media or observer.scene.method is not None:
        return load.work, load.floor_work  # integrated with the motion
    more = observer.work_beyond
    steps = np.diff(more, prepend=0.0)
    touched = np.diff(load.floor_work, prepend=0.0) != 0.0
    at_floor = np.cumsum(np.where(touched, steps, 0.0))
    return load.work + more - at_floor, load.floor_work + at_floor


def uncertain_work(observer: Kinematics) -> float:
    """By how much (J) the work on bodies differs at most between the two rules, both of second order.

    It is the uncertainty of the dissipated energy by the steps: small where forces and velocities change little in a
    step.
    """
    return float(np.abs(observer.work_beyond).max(initial=0.0)) if observer.scene.media else 0.0


def work_beyond(observer: Kinematics) -> Vector:
    """What the media and the floor did (n,) J beyond what the history has, see `bed.work.beyond`."""
    load = observer.trajectory.load
    return np.zeros(1) if load is None else beyond(load, {name: _motion(observer, name) for name in load.body_names})


def _motion(observer: Kinematics, name: str) -> Motion:
    center, velocity = observer.center(name)
    if name in observer.system.rigid:
        return center, velocity, observer.spin(name)
    return center, velocity, _spin(observer, name, center)


def _spin(observer: Kinematics, name: str, center: Vector) -> Vector:
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
