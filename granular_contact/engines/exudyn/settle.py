"""Static equilibrium under gravity before t = 0: the mechanism is set down on the sand slowly.

Sand keeps every overshoot, so nothing is dropped. The mechanism is lowered with a hundredth of its weight until it
stands; then the weight rises to its full value, in small steps. The supporting parts only ever penetrate deeper, and
static resistance is fully mobilised at the end, as under a body that is lowered at vanishing speed. Torques and forces
of drives rise with the weight; springs, stops and controls act in full, and time stands still.

In space the weight rises by OVERLOAD above its value before it comes back to it. A body that stands with all its
bristles exactly at their yield meets no stiffness downward and that of all bristles upward, and which of the two is
decided by round-off: Newton's method goes to and fro between them in every step of the run that follows, and what it
leaves adds up. After the overload the bristles are inside their yield by that share, where the body rests on springs.
It stands deeper by about that share of its depth.

Inertia plays no part. In a step from q to q + d every body is held back by its mass,

    M d / s = F(q + d) + G^T mu,    g(q + d) = 0,

F: all forces at rest (see `balance`); g: constraints of the joints. This is the implicit Euler step of an overdamped
motion, which never overshoots its equilibrium. s (s^2) is the pace: a free body moves by its acceleration times s. The
pace is chosen so that nothing moves far in a step, and grows without bound once the mechanism stands: the last steps
are those of Newton's method.
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

MOST_STEPS = 4000  # a mechanism that needs more is taken to find no rest
FIRST_WEIGHT = 0.01  # share of the weight with which the mechanism is lowered
GROWTH, RISE = 1.25, 0.05  # of the weight in a step: largest factor, largest increase of its share
OVERLOAD = 1e-3  # of the weight, put on and taken off again: a tenth as much is within what differences step over
LONGEST_STEP = 0.05  # of the mechanism's length; a body may turn by twice that, in radians
STANDING_ACCELERATION = 0.02  # of gravity: with less the mechanism stands and can take more weight
RESTING_ACCELERATION = 1e-6  # of gravity: with less it rests
RESIDUAL_AT_REST = 1e-10  # of the mechanism's length: correction at which Newton's method has converged
RESIDUAL_OF_STEP = 1e-4  # of the distance moved in the step: the same
MOST_ITERATIONS, FEW_ITERATIONS = 25, 5  # of a step: more have failed, with fewer the pace may grow
CREEPS = "smooth friction creeps under any load: take load.friction: {type: elastoplastic}"
SLOWEST_PACE = 1e-12  # of the first pace: below it the descent has failed
FASTEST_PACE = 1e6  # of a swing's time squared: only what nothing holds moves far at this pace


@dataclass(frozen=True)
class _Found:
    """End of a step: coordinates, forces there, multipliers of the joints, number of iterations."""

    q: Vector
    force: Vector
    multipliers: Vector
    iterations: int


class _Descent:
    """Descent of a system to its rest; `share` of the weight, `pace` (s^2), `steps` so far, `rests` once there."""

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
            self.lever[angles] = np.maximum(self.lever[angles], 0.5 * self.size)  # so that nothing turns far, either
        self.share, self.steps, self.rests = FIRST_WEIGHT, 0, False
        self.goals = [1.0 + OVERLOAD, 1.0] if scene.in_space and system.bed is not None else [1.0]
        self.pace = self.pace_taken = 0.25 * LONGEST_STEP * self.size / (FIRST_WEIGHT * self.gravity)
        self.q: Vector = system.mbs.systemData.GetODE2Coordinates()
        self.last = np.zeros_like(self.q)  # displacement of the last step
        self.turning = np.zeros_like(self.mass)  # of the forces of joints, see `Balance.turning`
        self.force, _ = self.balance.at(self.q, self.share)
        wall = scene.solver.max_wall_s
        self.deadline = math.inf if wall is None else time.perf_counter() + wall - system.building_s

    def run(self) -> None:
        """Go on to rest, or as far as one gets."""
        left, shortest = math.inf, SLOWEST_PACE * self.pace
        goals = iter(self.goals)
        goal = next(goals)
        while not self.rests and self.steps < MOST_STEPS and self.pace > shortest:
            if self.recorder.reason or time.perf_counter() > self.deadline:
                return
            share = self.share
            if left <= STANDING_ACCELERATION * share * self.gravity:
                share = min(goal, GROWTH * share, share + RISE)
            moved = self._step(share)
            self.steps += 1
            if moved is None:
                self.pace *= 0.25
                continue
            left = moved / self.pace_taken
            if self.share == goal and left <= RESTING_ACCELERATION * self.gravity:
                goal = next(goals, goal)
                self.rests = self.share == goal

    def _step(self, share: float) -> float | None:
        """One step with a share of the weight; greatest displacement (m) of any point; None: too long."""
        found = self._newton(share)
        if found is None:
            return None
        step = found.q - self.q
        moved = float(np.abs(self.lever * step).max())
        downhill = float((self.force + (share - self.share) * self.balance.rising(self.q)) @ step)
        if moved > LONGEST_STEP * self.size or (moved > 1e-6 * self.size and downhill < 0.0):
            return None
        self.q, self.force, self.last, self.share = found.q, found.force, step, share
        self.balance.accept(found.q)
        self.pace_taken = self.pace
        if found.iterations > FEW_ITERATIONS:
            self.turning = self.balance.turning(found.q, found.multipliers)
        if found.iterations <= FEW_ITERATIONS and moved < 0.4 * LONGEST_STEP * self.size:
            self.pace = min(2.0 * self.pace, FASTEST_PACE * self.size / self.gravity)
        return moved

    def _newton(self, share: float) -> _Found | None:
        """Where a step ends; None if Newton's method does not converge."""
        n, before, factor = len(self.q), math.inf, 1.0
        q = self.q + min(1.0, self.pace / self.pace_taken) * self.last  # extrapolated from the last step
        for iteration in range(1, MOST_ITERATIONS + 1):
            force, gap = self.balance.at(q, share)
            matrix = self.balance.tangent()
            residual = np.concatenate([force - self.mass @ (q - self.q) / self.pace, gap])
            # The multipliers themselves are unknowns, not their changes: the engine's stay zero.
            matrix[:n, :n] += self.turning - self.mass / self.pace
            found = _solution(matrix, -residual)
            if found is None:
                return None
            change, multipliers = found[:n], found[n:]
            size = float(np.abs(self.lever * change).max())
            if not size < 1e3 * self.size:
                return None
            # Between elastic and yielding friction full steps can oscillate.
            factor = max(0.25, 0.5 * factor) if size > 0.7 * before and iteration > 4 else 1.0
            q = q + min(factor, LONGEST_STEP * self.size / max(size, 1e-300)) * change
            moved = float(np.abs(self.lever * (q - self.q)).max())
            if size <= max(RESIDUAL_AT_REST * self.size, RESIDUAL_OF_STEP * moved):
                return _Found(q, force, multipliers, iteration)
            before = size
        return None


def _solution(matrix: Vector, right: Vector) -> Vector | None:
    """Solution of linear equations, None where there is none; what is large is sparse."""
    if len(right) <= SPARSE_FROM:
        try:
            return np.asarray(np.linalg.solve(matrix, right), float)
        except np.linalg.LinAlgError:
            return None
    from scipy import sparse
    from scipy.sparse import linalg

    try:
        return np.asarray(linalg.splu(sparse.csc_matrix(matrix)).solve(right), float)
    except RuntimeError:  # is exactly singular
        return None


def settle(system: System, recorder: Recorder) -> None:
    """Bring an assembled system to rest, and make that its initial state at t = 0.

    recorder: that of the run, which hears of Ctrl-C.

    Raises
    ------
    SolveError
        It does not come to rest; OutOfTimeError where it is not given the time.
    KeyboardInterrupt
        It was asked for; there is nothing to keep.
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
    """Make a place the system's initial state, at rest."""
    data, initial = system.mbs.systemData, exu.ConfigurationType.Initial
    data.SetODE2Coordinates(q, configuration=initial)
    data.SetODE2Coordinates_t(np.zeros_like(q), configuration=initial)
    for load in system.loads.values():
        load.first_anchor = load.anchor
