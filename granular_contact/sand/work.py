"""Work of the medium on bodies, as their motion has it, beyond what a history integrates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from granular_contact.results.energy import accumulate, work

if TYPE_CHECKING:
    from granular_contact.sand.history import LoadHistory

Vector = NDArray[np.float64]
# Of a body at the instants of a history: centre of mass (n, 2) m, its velocity (n, 2) m/s, and the rate (n,) rad/s; in
# space (n, 3) each.
Motion = tuple[Vector, Vector, Vector]


def about(wrench: Vector, center: Vector) -> Vector:
    """Wrenches (n, 3) about points (n, 2) m, in space (n, 6) about (n, 3), of those about the origin; moment last."""
    if center.shape[1] == 3:
        return np.column_stack([wrench[:, :3], wrench[:, 3:] - np.cross(center, wrench[:, :3])])
    (x, y), (fx, fy, about_origin) = center.T, wrench.T
    return np.column_stack([fx, fy, about_origin - x * fy + y * fx])


def beyond(load: LoadHistory, motions: Mapping[str, Motion]) -> Vector:
    """What the mean forces on bodies that moved so do (n,) J beyond the mean powers.

    The history integrates the power by the trapezoidal rule, which is off where a force jumps within a step, and in
    long steps. The work of the resultant on a body is the mean force of a step times its mean velocity (see
    `energy.work`); of a flexible link only what the forces do in bending it stays as the history has it.
    """
    more = np.zeros_like(load.time)
    for i, name in enumerate(load.body_names):
        force, twist = about(load.bodies[:, i], motions[name][0]), np.column_stack(motions[name][1:])
        more += work(load.time, force, twist) - accumulate(load.time, np.sum(force * twist, axis=1))
    return more
