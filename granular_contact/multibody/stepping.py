"""Steps chosen by an estimate of their error, for a generalised-alpha solve under way.

The scheme lets the acceleration a vary over a step h as its coefficient beta says; were it to vary linearly, beta would
be 1/6. So a step that takes it from a_0 to a_1 puts positions off by about |beta - 1/6| h^2 |a_1 - a_0| (Zienkiewicz
and Xie, 1991). That is held below accuracy V h, where V is the greatest speed so far: positions are then off by no more
than about `accuracy` times the way, and vibration that moves nothing visibly does not count. Where the force jumps (a
flat touch, a reversal, a bristle that sticks), a_1 - a_0 does not shrink with h, and the step goes down as accuracy V.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from granular_contact.multibody.system import System
from granular_contact.scene.types import Vector

SAFETY, MOST, LEAST = 0.85, 2.0, 0.2
KEEP = 0.8, 1.25  # within these factors of the last step its Jacobian serves, and no longer one is taken
REFUSED = 2.0  # what the engine takes for a step to be repeated: above its tolerance of 1
LONGEST = 0.05  # of the run, and of the swing of a pendulum as long as the mechanism, over 2 pi
SLOWEST = 0.02  # of the speed that such a swing has; below it what starts from rest counts as moving so fast


class StepControl:
    """Post-Newton function that refuses steps, and the choice of the next one; `refused` counts.

    lever (m,): factors from coordinate rates to speeds (m/s).
    """

    def __init__(self, system: System, solver: Any, lever: Vector, accuracy: float) -> None:
        scene = system.scene
        self.system, self.solver, self.lever, self.accuracy = system, solver, lever, accuracy
        self.size = max(scene.length, 1e-3)
        swing = math.sqrt(self.size / max(abs(scene.gravity), 0.1))
        self.speed = max(scene.speed, SLOWEST * self.size / swing)
        self.longest = LONGEST * min(scene.solver.end_time, swing)
        if scene.solver.rest_time is not None:
            self.longest = min(self.longest, 0.5 * scene.solver.rest_time)
        self.next = min(scene.solver.step, self.longest)
        self.start: Vector | None = None
        self.refused = 0

    def __call__(self, mbs: Any, t: float) -> list[float]:  # noqa: ARG002
        """Error of the step just solved, as the engine wants it, and a step to take instead."""
        if self.start is None:
            return [0.0, -1.0]
        it, solver = self.solver.it, self.solver
        step = it.currentStepSize
        change = np.abs(self.lever * (mbs.systemData.GetODE2Coordinates_tt() - self.start)).max()
        ratio = abs(solver.newmarkBeta - 1.0 / 6.0) * step * change / (self.accuracy * self.speed)
        factor = min(MOST, max(LEAST, SAFETY / math.sqrt(max(ratio, 1e-12)))) if math.isfinite(ratio) else LEAST
        if ratio > 1.0 and step > it.minStepSize:
            self.refused += 1
            solver.conv.jacobianUpdateRequested = True
            return [REFUSED, factor * step]
        self.next = min(factor * step, self.longest)
        return [0.0, -1.0]

    def accept(self, mbs: Any, v: Vector) -> None:
        """Set the step to come; after the accepted step that ended with the rates v (m,)."""
        self.start = mbs.systemData.GetODE2Coordinates_tt()
        self.speed = max(self.speed, float(np.abs(self.lever * v).max()))
        it = self.solver.it
        step = max(min(self.next, self._until_touch()), it.minStepSize)
        factor = step / it.currentStepSize
        if factor < 1.0 or factor > KEEP[1]:
            it.currentStepSize = step
        if not KEEP[0] < factor < KEEP[1]:
            self.solver.conv.jacobianUpdateRequested = True

    def _until_touch(self) -> float:
        """Time (s) until the next part above the surface may be in it, so that a step ends there.

        At least as long as the deepest it can get in that time does not matter.
        """
        if self.system.bed is None:
            return math.inf
        least = self.accuracy * self.size / self.speed
        above = [
            (-depth, speed)
            for group in self.system.bed.groups
            for depth, speed in group.nearing()
            if depth < 0.0 < speed
        ]
        return max(least, min((height / speed for height, speed in above), default=math.inf))
