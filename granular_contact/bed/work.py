"""Work of the media and of the floor over a history, as the motion has it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from granular_contact.results.energy import accumulate, work

if TYPE_CHECKING:
    from granular_contact.bed.history import LoadHistory

Vector = NDArray[np.float64]
# Of a body at the instants of a history: centre of mass (n, 2) m, its velocity (n, 2) m/s, and the rate (n,) rad/s.
Motion = tuple[Vector, Vector, Vector]


def works(load: LoadHistory, motions: Mapping[str, Motion]) -> tuple[Vector, Vector]:
    """Work (n,) J of all media, and of the floor, since the start, on bodies that moved so.

    The history integrates the power of the forces by the trapezoidal rule, which is off where a force jumps within a
    step, and in long steps. The work of the resultant on a body is the mean force of a step times its mean velocity
    (see `energy.work`); of a flexible link only what the forces do in bending it stays as the history has it. A step in
    which the floor was touched has its difference with the floor, which is far stiffer.
    """
    more = _more(load, motions)
    steps = np.diff(more, prepend=0.0)
    touched = np.diff(load.floor_work, prepend=0.0) != 0.0
    at_floor = np.cumsum(np.where(touched, steps, 0.0))
    return load.work + more - at_floor, load.floor_work + at_floor


def uncertain_work(load: LoadHistory, motions: Mapping[str, Motion]) -> float:
    """By how much (J) the work on bodies differs at most between the two rules, both of second order.

    It is what the steps leave open of the energy that the medium took: next to nothing where forces and velocities
    change little in a step.
    """
    return float(np.abs(_more(load, motions)).max(initial=0.0))


def _more(load: LoadHistory, motions: Mapping[str, Motion]) -> Vector:
    """What the mean forces on bodies do (n,) J beyond the mean powers."""
    wrenches = zip(load.body_names, np.moveaxis(load.bodies, 1, 0), strict=True)
    every = [_difference(load.time, wrench, *motions[name]) for name, wrench in wrenches]
    more: Vector = np.sum([np.zeros_like(load.time), *every], axis=0)
    return more


def _difference(time: Vector, wrench: Vector, center: Vector, velocity: Vector, rate: Vector) -> Vector:
    """By how much (n,) J the work on a body differs from the trapezoidal rule; wrench (n, 3) about the origin."""
    moment = wrench[:, 2] - center[:, 0] * wrench[:, 1] + center[:, 1] * wrench[:, 0]
    force, twist = np.column_stack([wrench[:, :2], moment]), np.column_stack([velocity, rate])
    return work(time, force, twist) - accumulate(time, np.sum(force * twist, axis=1))
