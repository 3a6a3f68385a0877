"""How far strips that are too long put a motion off: what it departs by with strips of another length.

Forces converge with the square of the strip: a motion is off by a third of what it departs by with strips joined in
pairs, and by four thirds of what it departs by with strips of half the length. Where strips are far too long either may
be a tenth of the error or less, rarely both (`validation/strip_estimates.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from granular_contact.sand.kernels import departure as kernels

if TYPE_CHECKING:
    from granular_contact.sand.load import GranularLoad

Vector = NDArray[np.float64]
OF_JOINED, OF_HALVED = 1.0 / 3.0, 4.0 / 3.0


def departure(own: GranularLoad, other: GranularLoad, motion: kernels.Motion, speed: float) -> Vector:
    """Departure (n, m) of the coordinates of a motion with strips of another length, at its instants.

    own, other: loads on these coordinates, which begin anew; speed (m/s): of the motion.
    """
    n, m, d = motion.W.shape
    out, none = np.zeros((n, m)), np.zeros(m)
    sands = own.places(None, none), other.places(None, none)
    rows = own.table.blank.copy(), other.table.blank.copy()
    room = kernels.Room(other.room_for_tangents, *rows, np.zeros((7, d)), np.zeros((5, m)), *np.zeros((2, d, d)))
    kernels.depart(kernels.called(), *sands, motion, room, speed, out)
    return out
