"""Where Newton's method begins in a step: with the accelerations and multipliers of the last one.

The engine begins with none at all (Arnold and Bruels 2007), which costs an iteration, and more where bristles are: a
foot in sand is then first seen some micrometres away from where it will be, beyond what its bristles yield at. Nothing
else changes: the equations that a step solves, and when they count as solved, are the same.
"""

from __future__ import annotations

from typing import Any

import exudyn as exu

PATIENT, EASING = 4, 4.0  # iterations with the least tolerance, and the factor by which it grows with each one after
START = exu.ConfigurationType.StartOfStep


class Predictor:
    """Function that the engine calls before each residual; it acts before the first of a step.

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
        tolerances: tuple[float, float, float] | None,
        patience: tuple[float, float] | None = None,
    ) -> None:
        self.solver, self.tolerances, self.patience = solver, tolerances, patience

    def __call__(self, mbs: Any, t: float, iteration: int, discontinuous: int) -> None:  # noqa: ARG002
        """Before the residual of an iteration of the step to t (s)."""
        if self.patience is not None and iteration >= PATIENT:
            least, greatest = self.patience
            self.solver.newton.absoluteTolerance = min(greatest, least * EASING ** (iteration + 1 - PATIENT))
        if iteration or discontinuous:
            return
        if self.patience is not None:
            self.solver.newton.absoluteTolerance = self.patience[0]
        solver, data = self.solver, mbs.systemData
        step, inertia = solver.it.currentStepSize, (1.0 - solver.alphaM) / (1.0 - solver.alphaF)
        if self.tolerances is not None:
            least, greatest, at = self.tolerances
            solver.newton.absoluteTolerance = max(least, min(greatest, least * (step / at) ** 2))
        a = data.GetODE2Coordinates_tt(START, copy=False)
        # By how much the scheme's coordinates and rates change with the acceleration at the end of the step.
        further = a * (step * step * solver.newmarkBeta / inertia)
        data.GetODE2Coordinates(copy=False)[:] += further
        data.GetODE2Coordinates_t(copy=False)[:] += further * (solver.newmarkGamma / (step * solver.newmarkBeta))
        data.GetODE2Coordinates_tt(copy=False)[:] = a
        data.GetAECoordinates(copy=False)[:] = data.GetAECoordinates(START, copy=False)
