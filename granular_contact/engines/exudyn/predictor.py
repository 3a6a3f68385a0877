"""Start value of each step, and Anderson acceleration of the engine's modified Newton method.

`mechanics.kernels.anderson` has the equations, sources and limits of both. The engine alone starts a step with zero
accelerations of the bodies, and does not accelerate its iterations. The equations of a step do not change, nor do the
criteria that end the iterations and renew the Jacobian: they are the engine's, with a tolerance of forces that may
depend on the length of the step.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.views import Views
from granular_contact.scene.types import Vector

EPSILON = float(np.finfo(float).eps)
# Arrays of `mechanics.kernels.iterations` in the engine's memory.
ENGINE_ARRAYS = "q", "v", "a", "multipliers", "a_before", "multipliers_before"


class Predictor:
    """Function that the engine calls before each residual.

    Parameters
    ----------
    solver:
        The engine's solver, from which step lengths and counts are read.
    lever:
        (m,) factors from rates of coordinates to speeds (m/s), by which changes are compared. None: iterations are not
        accelerated, as in systems without other forces than the engine's own.
    apply:
        Called with t (s) when the coordinates of an iteration are set; sends the forces at these coordinates. None: the
        engine calls the force functions itself.
    allowed:
        Tolerance (N) of the residual by the length of the step (s). None: the tolerance of the settings.
    """

    def __init__(
        self,
        solver: Any,
        lever: Vector | None,
        apply: Callable[[float], None] | None = None,
        allowed: Callable[[float], float] | None = None,
    ) -> None:
        self.solver, self.lever, self._apply, self._allowed = solver, lever, apply, allowed
        self._it, self._conv = solver.it, solver.conv  # handles of the solver's own numbers, no copies
        self.views: Views | None = None  # of the present part of the solve
        self._bound_views: Views | None = None  # to which the following attributes belong
        self._q_factor, self._v_factor = 0.0, 0.0  # see `_bind`
        self._begin_step: Callable[..., Any] | None = None  # compiled `anderson.begin`
        self._accelerate: Callable[..., Any] | None = None  # compiled `anderson.accelerate`
        self._addresses = np.zeros(0, np.int64)  # of the arrays of both
        self._memory: tuple[int, ...] = ()  # `Views.memory` of the engine's arrays
        self._iteration_arrays: dict[str, NDArray[Any]] = {}  # arrays of an iteration that are not the engine's

    def __call__(self, mbs: Any, t: float, iteration: int, discontinuous: int) -> None:
        """Set start value or accelerated coordinates, and the forces, before a residual of the step to t (s).

        iteration: number of Newton's iteration, 0 at the start of the step. discontinuous: number of the engine's
        iteration over discontinuities; only its first one, 0, changes coordinates.
        """
        if not discontinuous:
            if not iteration:
                self._begin(self.views or Views(mbs))
            elif self._accelerate is not None:
                self._accelerate(self._addresses, self._it.newtonJacobiCount)
        if self._apply is not None:
            self._apply(t)

    def _begin(self, views: Views) -> None:
        """Start a step, or a new attempt, with the accelerations and multipliers of the end of the last step."""
        if views is not self._bound_views:
            self._bind(views)
        if not EPSILON * self._conv.residual < self.solver.newton.absoluteTolerance:
            # The last attempt diverged: round-off of its residual alone exceeds the tolerance, or it is not finite. Its
            # Jacobian may have no factors, and the engine would reuse it.
            self._conv.jacobianUpdateRequested = True
        step = self._it.currentStepSize
        if self._allowed is not None:
            self.solver.newton.absoluteTolerance = self._allowed(step)
        q_per_a, v_per_a = self._q_factor * step * step, self._v_factor * step
        if self._begin_step is not None:
            self._begin_step(self._addresses, q_per_a, v_per_a)
            return
        a_before = views.a_before
        views.q += q_per_a * a_before
        views.v += v_per_a * a_before
        views.a += a_before
        views.multipliers[:] = views.multipliers_before

    def _bind(self, views: Views) -> None:
        """Take over what is constant in a part of a solve: the factors of the time scheme and the vectors' addresses.

        In a step of h, an acceleration a (m,) adds _q_factor h^2 a to the coordinates and _v_factor h a to the rates:
        Newmark's formulas of the generalised-alpha method.
        """
        self._bound_views, solver = views, self.solver
        share = (1.0 - solver.alphaF) / (1.0 - solver.alphaM)
        self._q_factor, self._v_factor = solver.newmarkBeta * share, solver.newmarkGamma * share
        if self.lever is not None:
            self.load(views)

    @property
    def kept(self) -> tuple[NDArray[Any], ...]:
        """Copies of the arrays of past iterations, on which later iterations depend."""
        return tuple(array.copy() for array in self._iteration_arrays.values())

    def restore(self, kept: tuple[NDArray[Any], ...]) -> None:
        """Return to arrays that `kept` gave."""
        for array, saved in zip(self._iteration_arrays.values(), kept, strict=True):
            array[:] = saved

    def load(self, views: Views) -> None:
        """Load the compiled kernels, and give them the addresses of the engine's vectors."""
        if self.lever is None or self._memory == views.memory:
            return
        self._memory = views.memory
        from granular_contact.mechanics.kernels.iterations import ITERATIONS, room

        engine_arrays = {name: getattr(views, name) for name in ENGINE_ARRAYS} | {"lever": self.lever}
        self._iteration_arrays = room(len(views.q), len(views.multipliers))
        self._addresses = ITERATIONS.addresses(engine_arrays | self._iteration_arrays)
        self._begin_step, self._accelerate = _compiled()


@cache
def _compiled() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """`begin` and `accelerate` of `mechanics.kernels.anderson`, cached: loading them takes as long as a few steps."""
    from granular_contact.jit.compiled import ready
    from granular_contact.mechanics.kernels import anderson

    addresses = np.zeros(1, np.int64)
    return ready(anderson.begin, addresses, 0.0, 0.0), ready(anderson.accelerate, addresses, 0)
