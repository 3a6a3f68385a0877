"""Static equilibrium under gravity before t = 0: the mechanism is lowered slowly onto the sand.

A body that overshoots its equilibrium stays too deep in sand, so nothing is dropped. The mechanism is lowered with a
hundredth of its weight until it stands. Then the weight rises to its full value in small steps. The supporting parts
only ever penetrate deeper, and static resistance is fully mobilised at the end, as under a body that is lowered at
vanishing speed. Torques and forces of drives rise with the weight; springs, stops and controls act in full; time does
not advance.

In space the weight rises to 1 + OVERLOAD of its value and then returns to it. If all bristles under a body are exactly
at their yield, the tangent stiffness is zero downward, and that of all bristles upward; round-off decides which of the
two applies. Newton's method would alternate between them in every step of the following run, and its residuals would
add up. After the overload the bristles are below their yield by that share, and the body rests on their springs. It
stands deeper by about that share of its depth.

Inertial forces do not act. In a step from q to q + d the mass of each body resists the displacement d,

    M d / s = F(q + d) + G^T mu,    g(q + d) = 0,

with all forces at rest F (see `balance`), the constraints of the joints g, their gradients G and their multipliers mu.
This is the implicit Euler step of an overdamped motion, which does not overshoot its equilibrium. s (s^2) is the pace:
a free body moves by its acceleration times s. The pace is chosen so that nothing moves far in a step. It grows without
bound once the mechanism stands, so that the last steps are those of Newton's method for equilibrium.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

import exudyn as exu
import numpy as np

from granular_contact.engines.exudyn.balance import Balance
from granular_contact.engines.exudyn.recorder import Recorder
from granular_contact.errors import OutOfTimeError, SolveError
from granular_contact.laws.static_friction import Smooth
from granular_contact.mechanics.mass_and_gravity import SPARSE_FROM, mass_matrix
from granular_contact.mechanics.system import System
from granular_contact.scene.types import Vector

MOST_STEPS = 4000  # a mechanism that needs more steps has no equilibrium
FIRST_WEIGHT = 0.01  # share of the weight with which the mechanism is lowered
GROWTH, RISE = 1.25, 0.05  # largest factor of the weight in a step, and largest increase of its share
OVERLOAD = 1e-3  # share of the weight; a tenth of it is too small for tangents that are found by finite differences
LONGEST_STEP = 0.05  # largest displacement in a step, over the mechanism's length; a body may turn by twice that (rad)
STANDING_ACCELERATION = 0.02  # of gravity: with a smaller one the mechanism stands, and the weight may rise
RESTING_ACCELERATION = 1e-6  # of gravity: with a smaller one the mechanism rests
RESIDUAL_AT_REST = 1e-10  # of the mechanism's length: correction at which Newton's method has converged
RESIDUAL_OF_STEP = 1e-4  # of the distance moved in the step: the same
MOST_ITERATIONS, FEW_ITERATIONS = 25, 5  # of a step: it fails with more; with at most FEW the pace may grow
CREEPS = "smooth friction creeps under any load: take load.friction: {type: elastoplastic}"
SLOWEST_PACE = 1e-12  # of the first pace: below it the descent has failed
FASTEST_PACE = 1e6  # of the square of a pendulum's time: at this pace only a body without support moves far


@dataclass(frozen=True)
class _StepEnd:
    """End of a step: coordinates, forces there, multipliers of the joints, number of iterations."""

    q: Vector
    force: Vector
    multipliers: Vector
    iterations: int


class _Descent:
    """Descent of a system to its static equilibrium.

    share: share of the weight that acts. pace (s^2): see above; pace_taken: that of the last accepted step. steps:
    number of steps so far. rests: whether equilibrium is reached. goals: shares of the weight to reach one after
    another. q (m,): coordinates; force (m,): generalised forces there. turning (m, m): derivatives of the forces of
    joints, see `Balance.turning`.
    """

    def __init__(self, system: System, recorder: Recorder) -> None:
        scene = system.scene
        self.recorder = recorder
        self.balance = Balance(system, MOST_STEPS)
        mass = mass_matrix(system)
        self.mass: Vector = mass if isinstance(mass, np.ndarray) else mass.toarray()
        self.size, self.gravity = max(scene.length, 1e-3), max(abs(scene.gravity), 0.1)
        self.lever = recorder.lever.copy()
        for rigid in system.rigid.values():
            angles = np.array(system.mbs.systemData.GetNodeLTGODE2(rigid.node))[list(rigid.body.rotation_indices)]
            self.lever[angles] = np.maximum(self.lever[angles], 0.5 * self.size)  # so that small bodies do not turn far
        self.share, self.steps, self.rests = FIRST_WEIGHT, 0, False
        self.goals = [1.0 + OVERLOAD, 1.0] if scene.in_space and system.bed is not None else [1.0]
        self.pace = self.pace_taken = 0.25 * LONGEST_STEP * self.size / (FIRST_WEIGHT * self.gravity)
        self.q: Vector = system.mbs.systemData.GetODE2Coordinates()
        self.last_step = np.zeros_like(self.q)  # displacement of the last step
        self.turning = np.zeros_like(self.mass)
        self.force, _ = self.balance.at(self.q, self.share)
        wall = scene.solver.max_wall_s
        self.deadline = math.inf if wall is None else time.perf_counter() + wall - system.building_s

    def run(self) -> None:
        """Take steps until the mechanism rests, a step fails at the slowest pace, or a limit is reached."""
        acceleration, slowest_pace = math.inf, SLOWEST_PACE * self.pace
        goals = iter(self.goals)
        goal = next(goals)
        while not self.rests and self.steps < MOST_STEPS and self.pace > slowest_pace:
            if self.recorder.reason or time.perf_counter() > self.deadline:
                return
            share = self.share
            if acceleration <= STANDING_ACCELERATION * share * self.gravity:
                share = min(goal, GROWTH * share, share + RISE)
            distance = self._step(share)
            self.steps += 1
            if distance is None:
                self.pace *= 0.25
                continue
            acceleration = distance / self.pace_taken
            if self.share == goal and acceleration <= RESTING_ACCELERATION * self.gravity:
                goal = next(goals, goal)
                self.rests = self.share == goal

    def _step(self, share: float) -> float | None:
        """Take a step with a share of the weight; returns the greatest displacement (m) of any point.

        None, and no step, if Newton's method fails, the displacement is too large, or it does work against the forces.
        """
        end = self._newton(share)
        if end is None:
            return None
        step = end.q - self.q
        distance = float(np.abs(self.lever * step).max())
        work = float((self.force + (share - self.share) * self.balance.rising(self.q)) @ step)
        if distance > LONGEST_STEP * self.size or (distance > 1e-6 * self.size and work < 0.0):
            return None
        self.q, self.force, self.last_step, self.share = end.q, end.force, step, share
        self.balance.accept(end.q)
        self.pace_taken = self.pace
        if end.iterations > FEW_ITERATIONS:
            self.turning = self.balance.turning(end.q, end.multipliers)
        if end.iterations <= FEW_ITERATIONS and distance < 0.4 * LONGEST_STEP * self.size:
            self.pace = min(2.0 * self.pace, FASTEST_PACE * self.size / self.gravity)
        return distance

    def _newton(self, share: float) -> _StepEnd | None:
        """End of a step with a share of the weight; None if Newton's method does not converge."""
        n, last_size, factor = len(self.q), math.inf, 1.0
        q = self.q + min(1.0, self.pace / self.pace_taken) * self.last_step  # extrapolated from the last step
        for iteration in range(1, MOST_ITERATIONS + 1):
            force, gap = self.balance.at(q, share)
            matrix = self.balance.tangent()
            residual = np.concatenate([force - self.mass @ (q - self.q) / self.pace, gap])
            # The unknowns are the multipliers themselves, not their corrections: the multipliers in the engine are
            # zero.
            matrix[:n, :n] += self.turning - self.mass / self.pace
            solution = _solution(matrix, -residual)
            if solution is None:
                return None
            correction, multipliers = solution[:n], solution[n:]
            size = float(np.abs(self.lever * correction).max())
            if not size < 1e3 * self.size:
                return None
            # Full corrections can oscillate between elastic and yielding friction.
            factor = max(0.25, 0.5 * factor) if size > 0.7 * last_size and iteration > 4 else 1.0
            q = q + min(factor, LONGEST_STEP * self.size / max(size, 1e-300)) * correction
            distance = float(np.abs(self.lever * (q - self.q)).max())
            if size <= max(RESIDUAL_AT_REST * self.size, RESIDUAL_OF_STEP * distance):
                return _StepEnd(q, force, multipliers, iteration)
            last_size = size
        return None


def _solution(matrix: Vector, right_side: Vector) -> Vector | None:
    """Solution of linear equations, None for a singular matrix; large matrices are solved as sparse ones."""
    if len(right_side) <= SPARSE_FROM:
        try:
            return np.asarray(np.linalg.solve(matrix, right_side), float)
        except np.linalg.LinAlgError:
            return None
    from scipy import sparse
    from scipy.sparse import linalg

    try:
        return np.asarray(linalg.splu(sparse.csc_matrix(matrix)).solve(right_side), float)
    except RuntimeError:  # the matrix is exactly singular
        return None


def settle(system: System, recorder: Recorder) -> None:
    """Find the static equilibrium of an assembled system, and make it the initial state at t = 0.

    recorder: of the run; its `reason` reports Ctrl-C.

    Raises
    ------
    SolveError
        The system has no equilibrium; OutOfTimeError if `solver.max_wall_s` is too short to find it.
    KeyboardInterrupt
        Ctrl-C was pressed; there are no results to keep.
    """
    descent = _Descent(system, recorder)
    descent.run()
    if recorder.reason == "interrupted":
        raise KeyboardInterrupt
    if not descent.rests and time.perf_counter() >= descent.deadline:
        allowed = f"solver.max_wall_s ({system.scene.solver.max_wall_s:g}) was over"
        raise OutOfTimeError(
            f"initial.settle: {allowed} before the mechanism rested; nothing was saved: take a larger one"
        )
    creeping = system.bed if isinstance(system.scene.static, Smooth) else None
    if not descent.rests or (creeping is not None and creeping.load.history.depth[-1] > 0.0):
        remedy = CREEPS if creeping is not None else "give the initial state without it"
        still = "nothing holds it in the sand" if descent.rests else f"it still moves after {descent.steps} steps"
        raise SolveError(f"initial.settle: the mechanism finds no rest: {still}; {remedy}")
    _begin(system, descent.q)


def _begin(system: System, q: Vector) -> None:
    """Make q (m,) the system's initial coordinates, with all rates zero."""
    data, initial = system.mbs.systemData, exu.ConfigurationType.Initial
    data.SetODE2Coordinates(q, configuration=initial)
    data.SetODE2Coordinates_t(np.zeros_like(q), configuration=initial)
    for load in system.loads.values():
        load.first_anchor = load.anchor
