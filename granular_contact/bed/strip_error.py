"""How far strips that are too long put the motion off, estimated from the accepted steps of a run.

At every accepted step the power P and the resultant F of the medium are also computed with the strips joined in pairs,
from the same friction state. Forces converge with the square of the strip, so that a third of the difference is what
they are off by. An error of the power is one of the speed, in the sense of the mass: dv / v = dP dt / (2 T) with the
kinetic energy T. An error of the resultant is one of the momentum of all bodies together, which the power does not see
across the motion; of one floating body alone the moment counts likewise. Each fades with v / a, the time that the
motion lasts; such errors are added without their sign.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from granular_contact.bed.history import LoadHistory

Vector = NDArray[np.float64]
SLOW = 0.02  # m/s: below it bristles carry what the strips are off by, and nothing of it moves on


@dataclass(frozen=True)
class Pace:
    """How long errors of the velocity last, at the ends of steps (n,) s.

    fade (n,): what a step leaves of them; fast (n,): whether anything moves fast enough to count; twice (n,) J: 2 T;
    fastest (n,) m/s: greatest speed of any point.
    """

    steps: Vector
    fade: Vector
    fast: NDArray[np.bool_]
    twice: Vector
    fastest: Vector

    @classmethod
    def of(cls, time: Vector, v: Vector, mass: Any, fastest: Vector) -> Pace:
        """At times (n + 1,) s from the rates v (n + 1, m) of all coordinates with their mass matrix."""
        steps, fast = np.diff(time), fastest[1:] >= SLOW
        twice = np.sum((v @ mass) * v, axis=1)[1:]
        mean = np.diff(v, axis=0) / steps[:, None]
        fade = np.exp(-steps * np.sqrt(_over(np.sum((mean @ mass) * mean, axis=1), twice)))
        fade[~fast] = 0.0
        return cls(steps, fade, fast, twice, fastest[1:])

    def displacement(self, kicks: Vector) -> float:
        """Greatest displacement (m) by errors (n, k) m/s that the velocity gets in each step."""
        return travelled(self.steps, kicks * self.fast[:, None], self.fade)


def by_power(load: LoadHistory, pace: Pace) -> float:
    """Error of positions (m) by the power of the medium."""
    kicks = _over(pace.steps * np.abs(load.coarser[1:, 0]) / 3.0, pace.twice) * pace.fastest
    return pace.displacement(kicks[:, None])


def by_resultant(load: LoadHistory, pace: Pace, mass: float) -> float:
    """Error of positions (m) by the resultant of the medium on a floating mass (kg)."""
    return pace.displacement(pace.steps[:, None] * load.coarser[1:, 1:3] / 3.0 / mass)


def by_moment(load: LoadHistory, pace: Pace, center: Vector, inertia: float, reach: float) -> float:
    """Error of positions (m) by the moment on one floating body, at its point farthest from the centre of mass.

    center (n + 1, 2) m: path of the centre of mass; inertia kg m2 about it; reach m.
    """
    x, y = center.T
    moment = (load.coarser[:, 3] - x * load.coarser[:, 2] + y * load.coarser[:, 1])[1:] / 3.0
    kicks = pace.steps * moment / inertia * reach
    return pace.displacement(kicks[:, None])


def _over(part: Vector, twice: Vector) -> Vector:
    """A part (n,) of twice the kinetic energy (n,), 0 at rest."""
    ratio: Vector = np.divide(part, twice, out=np.zeros_like(twice), where=twice > 0.0)
    return ratio


def travelled(steps: Vector, kicks: Vector, fade: Vector) -> float:
    """Greatest displacement (m) by changes of the velocity (n, k) m/s, each of which fades from step to step."""
    off = np.empty(kicks.shape)
    times, factors = steps.tolist(), fade.tolist()
    for i, column in enumerate(kicks.T.tolist()):  # plain numbers: arrays of one or three cost ten times as much
        velocity, path, paths = 0.0, 0.0, []
        for step, kick, factor in zip(times, column, factors, strict=True):
            velocity = velocity * factor + kick
            path += step * velocity
            paths.append(path)
        off[:, i] = paths
    return float(np.sqrt(np.max(np.sum(off * off, axis=1), initial=0.0)))
