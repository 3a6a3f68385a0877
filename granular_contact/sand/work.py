"""Work of the medium on bodies from their motion, more accurate than the integral of the power in a history."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from granular_contact.geometry.rotations import vector_products
from granular_contact.results.energy import accumulate, work

if TYPE_CHECKING:
    from granular_contact.sand.history import LoadHistory

Vector = NDArray[np.float64]
# Motion of a body at the instants of a history: centre of mass (n, 2) m, its velocity (n, 2) m/s, and the angular
# velocity (n,) rad/s; in space (n, 3) each.
Motion = tuple[Vector, Vector, Vector]


def wrenches_about(wrench: Vector, center: Vector) -> Vector:
    """Wrenches about given points, from wrenches about the world origin.

    Parameters
    ----------
    wrench : (n, 3) or (n, 6) array
        Force (N), then moment about the origin (N m).
    center : (n, 2) or (n, 3) array
        Points (m).

    Returns
    -------
    array
        Wrenches of the same shape, with moments about the points.
    """
    if center.shape[1] == 3:
        return np.column_stack([wrench[:, :3], wrench[:, 3:] - vector_products(center, wrench[:, :3])])
    (x, y), (fx, fy, about_origin) = center.T, wrench.T
    return np.column_stack([fx, fy, about_origin - x * fy + y * fx])


def work_correction(load: LoadHistory, motions: Mapping[str, Motion]) -> Vector:
    """Difference between the work by mean forces and the integral of the power in a history.

    The history integrates the power by the trapezoidal rule, which has an error where a force jumps within a step, and
    in long steps. The work of the resultant on a body is the mean force of a step times its mean velocity (see
    `energy.work`). For a flexible link only its motion as a whole is corrected; the work of the forces in bending it
    stays as in the history.

    Parameters
    ----------
    load : LoadHistory
        The history.
    motions : mapping of str to Motion
        Motion of each body at the instants of the history.

    Returns
    -------
    (n,) array
        Correction of the work (J) since the start.
    """
    correction = np.zeros_like(load.time)
    for i, name in enumerate(load.body_names):
        force, twist = wrenches_about(load.bodies[:, i], motions[name][0]), np.column_stack(motions[name][1:])
        correction += work(load.time, force, twist) - accumulate(load.time, np.sum(force * twist, axis=1))
    return correction
