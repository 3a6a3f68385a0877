"""Anderson acceleration of the engine's modified Newton, and the start of each step with the last accelerations.

What both are, with sources and limits: `mechanics.kernels.anderson`. The engine by itself starts with no acceleration
at all, and iterates without acceleration. The equations that a step solves are the same, and so is what ends them: the
engine's tolerances, of which that of forces may depend on the step, and its rule for a new Jacobian.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.views import Views
from granular_contact.scene.types import Vector

# Arrays of `mechanics.kernels.iterations` that are the engine's.
OF_ENGINE = "q", "v", "a", "multipliers", "v_before", "a_before", "multipliers_before"


class Predictor:
    """Function that the engine calls before each residual.

    Parameters
    ----------
    solver:
        The engine's, of which steps and counts are read.
    lever:
        (m,) factors from coordinate rates to speeds (m/s), by which changes are compared; None: no acceleration of the
        iterations, as where no forces are but those of the engine itself.
    apply:
        Called with t (s) once the place of an iteration is known; it sets the forces there. None: the engine asks for
        them by itself.
    allowed:
        Residual (N) that a step of a length (s) may leave. None: that of the settings.
    """

    def __init__(
        self,
        solver: Any,
        lever: Vector | None,
        apply: Callable[[float], None] | None = None,
        allowed: Callable[[float], float] | None = None,
    ) -> None:
        self.solver, self.lever, self._apply, self._allowed = solver, lever, apply, allowed
        self._it, self._conv = solver.it, solver.conv  # the solver's own, no copies
        self.views: Views | None = None  # given before the first step
        self._known: Views | None = None  # those for which the following is set
        self._of_square, self._of_step = 0.0, 0.0  # see `_look`
        self._begin_step: Callable[..., Any] | None = None  # compiled, as is the next
        self._accelerate: Callable[..., Any] | None = None
        self._addresses = np.zeros(0, np.int64)  # of their arrays
        self._where: tuple[int, ...] = ()  # the engine's of them
        self._room: dict[str, NDArray[Any]] = {}  # the other arrays of an iteration, but for the lever

    def __call__(self, mbs: Any, t: float, iteration: int, discontinuous: int) -> None:
        """Before the residual of an iteration of the step to t (s)."""
        if not discontinuous:
            if not iteration:
                self._begin(self.views or Views(mbs))
            elif self._accelerate is not None:
                self._accelerate(self._addresses, self._it.newtonJacobiCount)
        if self._apply is not None:
            self._apply(t)

    def _begin(self, views: Views) -> None:
        """Begin a step, or another try of one, with what the last one ended with."""
        if views is not self._known:
            self._look(views)
        if not math.isfinite(self._conv.residual):
            # The try before ran away. Its last Jacobian could not be factorised, and the engine would go on with it.
            self._conv.jacobianUpdateRequested = True
        step = self._it.currentStepSize
        if self._allowed is not None:
            self.solver.newton.absoluteTolerance = self._allowed(step)
        of_q, of_v = self._of_square * step * step, self._of_step * step
        if self._begin_step is not None:
            self._begin_step(self._addresses, of_q, of_v)
            return
        before = views.a_before
        views.q += of_q * before
        views.v += of_v * before
        views.a += before
        views.multipliers[:] = views.multipliers_before

    def _look(self, views: Views) -> None:
        """Learn from the engine what stays the same for all steps of a part of the solve."""
        self._known, solver = views, self.solver
        # With an acceleration further by one go so much of a coordinate and its rate, as the scheme says.
        share = (1.0 - solver.alphaF) / (1.0 - solver.alphaM)
        self._of_square, self._of_step = solver.newmarkBeta * share, solver.newmarkGamma * share
        if self.lever is not None:
            self.load(views)

    @property
    def kept(self) -> tuple[NDArray[Any], ...]:
        """What the iterations to come depend on, of those before."""
        return tuple(array.copy() for array in self._room.values())

    def restore(self, kept: tuple[NDArray[Any], ...]) -> None:
        """Go back to what was kept."""
        for array, old in zip(self._room.values(), kept, strict=True):
            array[:] = old

    def load(self, views: Views) -> None:
        """Load the kernels that begin steps and accelerate iterations, for the engine's vectors."""
        if self.lever is None or self._where == views.where:
            return
        self._where = views.where
        from granular_contact.mechanics.kernels.iterations import ITERATIONS, room

        own = {name: getattr(views, name) for name in OF_ENGINE} | {"lever": self.lever}
        self._room = room(len(views.q), len(views.multipliers))
        self._addresses = ITERATIONS.addresses(own | self._room)
        self._begin_step, self._accelerate = _compiled()


@cache
def _compiled() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """`begin` and `accelerate` of `mechanics.kernels.anderson`: finding them takes as long as some steps."""
    from granular_contact.jit.compiled import ready
    from granular_contact.mechanics.kernels import anderson

    addresses = np.zeros(1, np.int64)
    return ready(anderson.begin, addresses, 0.0, 0.0), ready(anderson.accelerate, addresses, 0)
