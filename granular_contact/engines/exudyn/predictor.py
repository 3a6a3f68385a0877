"""Where Newton's method begins in a step, how its later iterations go on from those before, when its Jacobian is old.

It begins with the accelerations and multipliers of the last step. The engine begins with none at all (Arnold and Bruels
2007), which costs an iteration, and more where bristles are: a foot in sand is then first seen some micrometres away
from where it will be, beyond what its bristles yield at.

Each later one is led on by Anderson's acceleration (1965; Walker and Ni 2011): with the change g of an iteration and x
where it led to, and the differences G and E of such changes and places between iterations, the next one starts from

    x - E c,    where c makes |g - G c|^2 least,

which is where changes would be least were they linear. The last DEPTH differences serve, over steps as well, for as
long as the Jacobian and the step stay what they are: a Jacobian of an earlier step then serves longer, and an iteration
that goes to and fro over the narrow range of directions in which a face of a foot begins to lead is led into it.

The Jacobian is renewed once a change is more than `gain` times the one before. The engine's own rule looks at
residuals, from the third iteration on. Where bristles begin to yield or to hold, these grow for an iteration or two,
and the engine then begins the step anew, and computes a Jacobian for each iteration that is left of it.

The equations that a step solves are the same. They count as solved by what is left of them, where the Jacobian is
renewed so, and no more by being small beside an earlier residual of the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from granular_contact.engines.exudyn.views import Views
from granular_contact.scene.types import Vector

GIVEN = 8  # arrays of `mechanics.kernels.iterations` that are the engine's, or stay as they are
LATE = 3  # iterations by which links that bend are led on later


class Patience(NamedTuple):
    """Absolute tolerance of Newton's method in a step: the least, which grows with each iteration after some.

    least, greatest; iterations: how many residuals are held against the least; factor: by which it grows. round_off:
    residual that is little more than that and leads nowhere, as of a robot that stands; 0 where the least is far above.
    """

    least: float
    greatest: float
    iterations: int
    factor: float
    round_off: float = 0.0

    def after(self, iterations: int) -> float:
        """The tolerance once so many have come before."""
        more = iterations + 1 - self.iterations
        return min(self.greatest, self.least * self.factor**more) if more > 0 else self.least


class Predictor:
    """Function that the engine calls before each residual.

    lever (m,): factors from coordinate rates to speeds (m/s), by which changes are compared; None where iterations go
    on as the engine does. bends: whether all that moves is a link that bends. Its stiff elements leave round-off in
    changes, so that iterations are led on only where they have not ended after some. alone: whether iterations are led
    on by those of their step only: of one body they would end as soon as the tolerance lets them, all on one side.
    gain: see above; infinite where the engine's rule holds. fixed: whether steps are.

    held: speed (m/s) up to which bristles may hold in a step of a length (s); None where there are none, or steps are
    chosen. apply: called with t (s) once the place of an iteration is known, and sets the forces there.

    tolerances: absolute tolerance of Newton's method where steps are chosen, least and greatest, and the step (s) at
    which it is the least. What it leaves in the constraints of joints puts accelerations off by as much over the square
    of the step, so that the tolerance grows with that square.

    patience: how the tolerance grows within a step; None where it does not. In space constraints are met to round-off
    by a few iterations. What is left then are forces on facets that rest at the edge of yielding, hundreds under a
    robot that stands, between which the iteration goes to and fro. Of rigid links that sand stops see `settings`.
    """

    def __init__(
        self,
        solver: Any,
        lever: Vector | None,
        tolerances: tuple[float, float, float] | None,
        patience: Patience | None = None,
        *,
        bends: bool = False,
        alone: bool = False,
        gain: float = math.inf,
        fixed: bool = False,
        held: Callable[[float], float] | None = None,
        apply: Callable[[float], None] | None = None,
    ) -> None:
        self._it, self._conv, self._newton = solver.it, solver.conv, solver.newton  # the solver's own, no copies
        self.gain = gain
        self.solver, self.lever = solver, lever
        self.tolerances, self.patience = tolerances, patience
        self._round_off = 0.0 if patience is None else patience.round_off
        self._grown = True  # whether the tolerance may be another than the least
        self.views: Views | None = None  # given before the first step
        self._late, self._alone, self._fixed = LATE if bends else 0, alone, fixed and not alone
        self._held, self._apply = held, apply
        self._found: Views | None = None  # those of which the following is known
        self._of_square, self._of_step = 0.0, 0.0  # see `_look`
        self._start: Callable[..., Any] | None = None  # compiled, as is the next
        self._go_on: Callable[..., Any] | None = None
        self._words = np.zeros(0, np.int64)  # where their arrays are
        self._where: tuple[int, ...] = ()  # the engine's of them
        self._arrays: tuple[NDArray[Any], ...] = ()

    def __call__(self, mbs: Any, t: float, iteration: int, discontinuous: int) -> None:
        """Before the residual of an iteration of the step to t (s)."""
        patience = self.patience
        if patience is not None and iteration >= patience.iterations:
            self._newton.absoluteTolerance, self._grown = patience.after(iteration), True
        if discontinuous:
            pass
        elif not iteration:
            self._begin(self.views or Views(mbs))
        elif self._go_on is not None and iteration >= self._late:
            leads = iteration > self._late and not (self._round_off and self._conv.residual < self._round_off)
            if self._go_on(self._words, self._it.newtonJacobiCount, self.gain, leads):
                self._conv.jacobianUpdateRequested = True
        if self._apply is not None:
            self._apply(t)

    def _begin(self, views: Views) -> None:
        """Begin a step, or another try of one, with what the last one ended with."""
        if views is not self._found:
            self._look(views)
        step = self._it.currentStepSize
        if self.patience is not None and self._grown:
            self._newton.absoluteTolerance, self._grown = self.patience.least, False
        if self.tolerances is not None:
            least, greatest, at = self.tolerances
            self._newton.absoluteTolerance = max(least, min(greatest, least * (step / at) ** 2))
        of_q, of_v = self._of_square * step * step, self._of_step * step
        if self._start is not None:
            jacobians = self._it.newtonJacobiCount
            held = 0.0 if self._held is None else self._held(step)
            if self._start(self._words, of_q, of_v, self._alone, jacobians, self._fixed, held):
                self._conv.jacobianUpdateRequested = True
            return
        before = views.a_before
        views.q += of_q * before
        views.v += of_v * before
        views.a += before
        views.multipliers[:] = views.multipliers_before

    def _look(self, views: Views) -> None:
        """Learn from the engine what stays the same for all steps of a part of the solve."""
        self._found, solver = views, self.solver
        # With an acceleration further by one go so much of a coordinate and its rate, as the scheme says.
        share = (1.0 - solver.alphaF) / (1.0 - solver.alphaM)
        self._of_square, self._of_step = solver.newmarkBeta * share, solver.newmarkGamma * share
        if self.lever is not None:
            self.load(views)

    @property
    def kept(self) -> tuple[NDArray[Any], ...]:
        """What the iterations to come depend on, of those before."""
        return tuple(array.copy() for array in self._arrays[GIVEN:])

    def restore(self, kept: tuple[NDArray[Any], ...]) -> None:
        """Go back to what was kept."""
        for array, old in zip(self._arrays[GIVEN:], kept, strict=True):
            array[:] = old

    def load(self, views: Views) -> None:
        """Load the kernels that begin steps and lead iterations on, for the engine's vectors."""
        if self.lever is None or self._where == views.where:
            return
        self._where = views.where
        from granular_contact.jit.lending import places
        from granular_contact.mechanics.kernels import iterations as of

        size, constraints = len(views.q), len(views.multipliers)
        before = views.v_before, views.a_before, views.multipliers_before
        now = views.q, views.v, views.a, views.multipliers
        kept = np.zeros((4, size)), np.zeros((2, constraints)), np.zeros(2)
        pairs = (np.zeros((rows, of.DEPTH)) for rows in (size, constraints, size, of.DEPTH))
        numbers = np.zeros(of.NUMBERS, np.int64), np.zeros(of.LINE)
        way = np.zeros((2, size)), np.zeros((2, constraints))
        self._arrays = *now, *before, self.lever, *kept, *pairs, *numbers, *way
        self._words = places(*self._arrays)
        self._start, self._go_on = _compiled()


@cache
def _compiled() -> tuple[Callable[..., Any], Callable[..., Any]]:
    """`begin` and `go_on` of `mechanics.kernels.anderson`: finding them takes as long as some steps."""
    from granular_contact.jit.compiled import ready
    from granular_contact.mechanics.kernels import anderson

    words = np.zeros(1, np.int64)
    return (
        ready(anderson.begin, words, 0.0, 0.0, False, 0, False, 0.0),
        ready(anderson.go_on, words, 0, 0.5, True),
    )
