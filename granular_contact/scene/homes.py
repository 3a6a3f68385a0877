"""Nearest configuration to the reference configuration of a config in which all loops close.

The homes of joints in a config need not close the loops exactly. Nonlinear least squares (trust region) minimises the
residuals of all closures at once. It starts from the homes of the config, and from scattered configurations where that
leaves a residual. Of the configurations in which the loops close, the one of least change is chosen: with the least sum
of squares of rotations (rad) and of displacements relative to the longest link.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.errors import Fault
from granular_contact.scene.types import Vector

if TYPE_CHECKING:
    from scipy.optimize import OptimizeResult

    from granular_contact.scene.loops import Loops

CLOSED = 1e-9  # (m, rad): residual of a closed loop, round-off once least squares has converged
_SCATTERED = 16  # other starts, if least squares from the homes of the config finds no closed configuration
_MOST_EVALUATIONS = 100  # of residuals in one least squares; ten are enough where the loops can close
_MOST_REDUCTIONS = 30  # Gauss-Newton steps towards the least change
_LEAST_CHANGE = 1e-6  # (rad, or relative to the longest link): smaller changes count as none
_DIGITS = 6  # of a home in degrees or metres, which close a loop to some 1e-8 of the links' length


@dataclass(frozen=True)
class HomeNote(Fault):
    """Note that the home of a joint was changed. home: the new one in the unit of its key; None without a key."""

    home: float | None = None


def nearest_closed(loops: Loops, written: Mapping[str, Any]) -> dict[str, Any]:
    """States of least change in which all loops close; states of least residual if no closed ones are found.

    Parameters
    ----------
    loops : Loops
    written : mapping of str to states
        States of the joints at the homes of the config.
    """
    from scipy.optimize import least_squares

    scale = _scale(loops)

    def states(x: Vector) -> dict[str, Any]:
        return {name: written[name].displaced((scale * x)[part]) for name, part in loops.slices.items()}

    def residual(x: Vector) -> Vector:
        pose = loops.pose_of(states(x))
        return np.concatenate([loops.residual(name, pose) for name in loops.model.closures])

    def solve_from(x: Vector) -> OptimizeResult:
        return least_squares(residual, x, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=_MOST_EVALUATIONS)

    solution = solve_from(np.zeros(loops.size))
    if not _closes(solution):
        draw = np.random.default_rng(0)
        others = [solve_from(draw.uniform(-math.pi, math.pi, loops.size)) for _ in range(_SCATTERED)]
        if closed := [other for other in others if _closes(other)]:
            solution = min(closed, key=_change)
        else:
            solution = min([solution, *others], key=lambda result: float(result.cost))
    return states(_reduce_change(solve_from, solution).x)


def _reduce_change(solve_from: Callable[[Vector], OptimizeResult], solution: OptimizeResult) -> OptimizeResult:
    """Reduce the change of a closed configuration by Gauss-Newton steps, with the loops closed again after each."""
    for _ in range(_MOST_REDUCTIONS if _closes(solution) else 0):
        nearest = np.linalg.pinv(solution.jac, rcond=1e-9) @ (solution.jac @ solution.x - solution.fun)
        step = nearest - solution.x
        if np.abs(step).max(initial=0.0) < _LEAST_CHANGE:
            break
        trials = (solve_from(solution.x + share * step) for share in (1.0, 0.3, 0.1, 0.03))
        nearer = next((trial for trial in trials if _closes(trial) and _change(trial) < _change(solution)), None)
        if nearer is None:
            break
        solution = nearer
    return solution


def _closes(solution: OptimizeResult) -> bool:
    return bool(np.abs(solution.fun).max(initial=0.0) < CLOSED)


def _change(solution: OptimizeResult) -> float:
    return float(np.linalg.norm(solution.x))


def _scale(loops: Loops) -> Vector:
    """Units (size,) in which changes of the degrees of freedom are measured: 1 rad, or the length (m) of the longest
    link.
    """
    joints = [*loops.joints.values(), *loops.model.closures.values()]
    points = [point for joint in joints for point in (joint.parent_point_m, joint.child_point_m)]
    length = max(float(np.linalg.norm(point)) for point in points) or 1.0
    scale = np.ones(loops.size)
    for name, joint in loops.joints.items():
        first, (displacements, _) = loops.slices[name].start, loops.freedoms[joint.type]
        scale[first : first + displacements] = length
    return scale


def home_notes(loops: Loops, written: Mapping[str, Any], states: Mapping[str, Any]) -> Iterator[HomeNote]:
    """Notes on hinges and sliders whose home had to change, and on other joints that had to move."""
    for name, joint in loops.joints.items():
        if joint.type not in ("hinge", "slider"):
            if _differ(written[name], states[name]):
                words = "the loops do not close with its child at the home pose; they close at the pose that is taken"
                yield HomeNote("", None, f"model.joints.{name}", words)
            continue
        before, after = written[name].coordinate, states[name].coordinate
        if abs(after - before) < _LEAST_CHANGE:
            continue
        key, unit, factor = ("home_deg", "deg", math.degrees(1.0)) if joint.type == "hinge" else ("home_m", "m", 1.0)
        home = round(factor * after, _DIGITS)
        words = f"the loops do not close at {factor * before:g} {unit}; {home:.10g} is taken, the nearest at which they"
        yield HomeNote("", None, f"model.joints.{name}.{key}", f"{words} do", home)


def _differ(first: Any, second: Any) -> bool:
    """Whether two states of a joint differ by more than `_LEAST_CHANGE` in a coordinate."""
    parts = [part for part in ("value", "position", "turn") if hasattr(first, part)]
    return any(np.abs(getattr(first, part) - getattr(second, part)).max(initial=0.0) > _LEAST_CHANGE for part in parts)
