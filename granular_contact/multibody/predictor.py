"""Where Newton's method begins in a step, and how its later iterations go on from the two before.

It begins with the accelerations and multipliers of the last step. The engine begins with none at all (Arnold and Bruels
2007), which costs an iteration, and more where bristles are: a foot in sand is then first seen some micrometres away
from where it will be, beyond what its bristles yield at.

From the third iteration on, Anderson's acceleration of depth one (1965; Walker and Ni 2011): with the change g of an
iteration, g' that of the one before, and x, x' where they led to, the next one starts from

    x - theta (x - x'),    theta = (g - g') . g / |g - g'|^2,    |theta| <= 1,

where changes that vary linearly would be least. A Jacobian of an earlier step then serves longer, and an iteration that
goes to and fro over the narrow range of directions in which a face of a foot begins to lead is led into it.

Nothing else changes: the equations that a step solves, and when they count as solved, are the same.
"""

from __future__ import annotations

from typing import Any

import exudyn as exu
import numpy as np

from granular_contact.scene.types import Vector

PATIENT, EASING = 4, 4.0  # iterations with the least tolerance, and the factor by which it grows with each one after
SECOND = 2  # iteration from which on changes are kept: the first one is that of the prediction
START = exu.ConfigurationType.StartOfStep


class Predictor:
    """Function that the engine calls before each residual.

    lever (m,): factors from coordinate rates to speeds (m/s), by which changes are compared; None where iterations go
    on as the engine does, as for links that bend, whose stiff elements leave round-off in accelerations.

    tolerances: absolute tolerance of Newton's method where steps are chosen, least and greatest, and the step (s) at
    which it is the least. What it leaves in the constraints of joints puts accelerations off by as much over the square
    of the step, so that the tolerance grows with that square.

    patience: least and greatest absolute tolerance in space. There constraints are met to round-off by a few
    iterations. What is left then are forces on facets that rest at the edge of yielding, hundreds under a robot that
    stands, between which the iteration goes to and fro; so the tolerance grows from then on, to the greatest.
    """

    def __init__(
        self,
        solver: Any,
        lever: Vector | None,
        tolerances: tuple[float, float, float] | None,
        patience: tuple[float, float] | None = None,
    ) -> None:
        self.solver, self.lever, self.tolerances, self.patience = solver, lever, tolerances, patience
        # Accelerations that the iteration under way began with; those that the one before led to, with multipliers; its
        # change, in m/s2.
        self._from = self._led = self._multipliers = self._change = np.zeros(0)

    def __call__(self, mbs: Any, t: float, iteration: int, discontinuous: int) -> None:  # noqa: ARG002
        """Before the residual of an iteration of the step to t (s)."""
        if self.patience is not None and iteration >= PATIENT:
            least, greatest = self.patience
            self.solver.newton.absoluteTolerance = min(greatest, least * EASING ** (iteration + 1 - PATIENT))
        if discontinuous:
            return
        if iteration:
            if self.lever is not None:
                self._go_on(mbs.systemData, self.lever, iteration)
            return
        if self.patience is not None:
            self.solver.newton.absoluteTolerance = self.patience[0]
        if self.tolerances is not None:
            least, greatest, at = self.tolerances
            step = self.solver.it.currentStepSize
            self.solver.newton.absoluteTolerance = max(least, min(greatest, least * (step / at) ** 2))
        data = mbs.systemData
        self._move(data, data.GetODE2Coordinates_tt(START, copy=False))
        data.GetAECoordinates(copy=False)[:] = data.GetAECoordinates(START, copy=False)

    def _move(self, data: Any, further: Vector) -> None:
        """Add to the accelerations at the end of the step; coordinates and rates follow as the scheme says."""
        solver = self.solver
        step, inertia = solver.it.currentStepSize, (1.0 - solver.alphaM) / (1.0 - solver.alphaF)
        moved = further * (step * step * solver.newmarkBeta / inertia)
        data.GetODE2Coordinates(copy=False)[:] += moved
        data.GetODE2Coordinates_t(copy=False)[:] += moved * (solver.newmarkGamma / (step * solver.newmarkBeta))
        data.GetODE2Coordinates_tt(copy=False)[:] += further

    def _go_on(self, data: Any, lever: Vector, iteration: int) -> None:
        """Go on from where the last two iterations led to, once there are two."""
        led = data.GetODE2Coordinates_tt()
        if iteration < SECOND:
            self._from = led
            return
        multipliers, change = data.GetAECoordinates(), lever * (led - self._from)
        self._from = led
        if iteration > SECOND:
            bend = change - self._change
            size = bend.dot(bend)
            back = -min(1.0, max(-1.0, bend.dot(change) / size)) if size > 0.0 else 0.0
            further = back * (led - self._led)
            self._move(data, further)
            data.GetAECoordinates(copy=False)[:] += back * (multipliers - self._multipliers)
            self._from = led + further
        self._led, self._multipliers, self._change = led, multipliers, change
