"""Work of the media and of the floor over a run: `bed.work` with the motion of the run's bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from granular_contact.bed import work
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from granular_contact.bed.history import LoadHistory
    from granular_contact.multibody.observe import Observer


def medium_works(observer: Observer) -> tuple[Vector, Vector]:
    """Work (n,) J of all media, and of the floor, since the start."""
    load = observer.trajectory.load
    assert load is not None
    if not observer.scene.media or observer.scene.method is not None:
        return load.work, load.floor_work  # integrated with the motion
    return work.works(load, _motions(observer, load))


def uncertain_work(observer: Observer) -> float:
    """What the steps leave open (J) of the energy that the medium took."""
    load = observer.trajectory.load
    return 0.0 if load is None or not observer.scene.media else work.uncertain_work(load, _motions(observer, load))


def _motions(observer: Observer, load: LoadHistory) -> dict[str, work.Motion]:
    """Motion of every body that the medium may act on."""
    motions = {}
    for name in load.body_names:
        center, velocity = observer.center(name)
        rigid = name in observer.system.rigid
        rate = observer.angle(name, np.zeros(2))[1] if rigid else _spin(observer, name, center)
        motions[name] = center, velocity, rate
    return motions


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
