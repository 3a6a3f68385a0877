"""How far strips that are too long put the motion off, estimated from the accepted steps of a run.

At every accepted step the power P and the resultant F of the medium are also computed with the strips joined in pairs,
from the same friction state. Forces converge with the square of the strip, so that a third of the difference is what
they are off by. An error of the power is one of the speed, in the sense of the mass: dv / v = dP dt / (2 T) with the
kinetic energy T. An error of the resultant is one of the momentum of all bodies together, which the power does not see
across the motion. Either fades with v / a, the time that the motion lasts; such errors are added without their sign.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from granular_contact.bed.history import LoadHistory

Vector = NDArray[np.float64]
SLOW = 0.02  # m/s: below it bristles carry what the strips are off by, and nothing of it moves on


def displacement(load: LoadHistory, v: Vector, mass: Any, fastest: Vector, floating: float | None = None) -> float:
    """Error of positions (m) by the power of the medium, or by its resultant on a floating mass (kg) if one is given.

    v (n, m): rates of all coordinates, with their mass matrix; fastest (n,) m/s: greatest speed of any point.
    """
    steps, change, fast = np.diff(load.time), load.coarser[1:] / 3.0, fastest[1:] >= SLOW
    twice = np.sum((v @ mass) * v, axis=1)[1:]  # 2 T (J)
    mean = np.diff(v, axis=0) / steps[:, None]
    fade = np.exp(-steps * np.sqrt(_over(np.sum((mean @ mass) * mean, axis=1), twice)))
    fade[~fast] = 0.0
    if floating is None:
        return travelled(steps, (_over(steps * np.abs(change[:, 0]), twice) * fastest[1:] * fast)[:, None], fade)
    return travelled(steps, steps[:, None] * change[:, 1:] / floating * fast[:, None], fade)


def _over(part: Vector, twice: Vector) -> Vector:
    """A part (n,) of twice the kinetic energy (n,), 0 at rest."""
    ratio: Vector = np.divide(part, twice, out=np.zeros_like(twice), where=twice > 0.0)
    return ratio


def travelled(steps: Vector, kicks: Vector, fade: Vector) -> float:
    """Greatest displacement (m) by changes of the velocity (n, k) m/s, each of which fades from step to step."""
    velocity, off, most = np.zeros(kicks.shape[1]), np.zeros(kicks.shape[1]), 0.0
    for step, kick, factor in zip(steps, kicks, fade, strict=True):
        velocity = velocity * factor + kick
        off = off + step * velocity
        most = max(most, float(np.linalg.norm(off)))
    return most
