"""The reference configuration nearest to the one that is written down, in which all loops close.

Homes need not be exact: nonlinear least squares of the gaps of all closures at once (trust region), from the homes that
are written, and from scattered ones where a gap is left there. Of the configurations in which the loops close it is
the one of least change: of the sum of squares of turns (rad) and of displacements, in parts of the longest link.
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

CLOSED = 1e-9  # (m, rad): a gap of round-off, of a solution that least squares brought to the end
_SCATTERED = 16  # starts elsewhere, where the written one leads to no closed configuration
_MOST_STEPS = 100  # of least squares; ten lead to a configuration that closes
_SHORTENED = 30  # steps towards the least change
_ALIKE = 1e-6  # (rad, and parts of the longest link): changes this small are none, nor worth a step
_DIGITS = 6  # of a home in degrees or metres, which close a loop to some 1e-8 of the links' length


@dataclass(frozen=True)
class FoundHome(Fault):
    """A note on a joint whose home is not the one written. home: in the unit of its key; None where it has no key."""

    home: float | None = None


def solved(loops: Loops, written: Mapping[str, Any]) -> dict[str, Any]:
    """States of least change in which all loops close; of least gap where none was found that closes them.

    Parameters
    ----------
    loops : Loops
    written : mapping of str to states
        States of the joints at their homes.
    """
    from scipy.optimize import least_squares

    scale = _scale(loops)

    def states(x: Vector) -> dict[str, Any]:
        return {name: written[name].displaced((scale * x)[at]) for name, at in loops.places.items()}

    def gaps(x: Vector) -> Vector:
        placed = loops.pose(states(x))
        return np.concatenate([loops.gaps(name, placed) for name in loops.model.closures])

    def near(x: Vector) -> OptimizeResult:
        return least_squares(gaps, x, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=_MOST_STEPS)

    found = near(np.zeros(loops.size))
    if not _closes(found):
        draw = np.random.default_rng(0)
        others = [near(draw.uniform(-math.pi, math.pi, loops.size)) for _ in range(_SCATTERED)]
        closing = [one for one in others if _closes(one)]
        found = min(closing, key=_change) if closing else min([found, *others], key=lambda one: float(one.cost))
    return states(_least_change(near, found).x)


def _least_change(near: Callable[[Vector], OptimizeResult], found: OptimizeResult) -> OptimizeResult:
    """The closed configuration of least change near one that is closed: Gauss-Newton steps, each closed again."""
    for _ in range(_SHORTENED if _closes(found) else 0):
        nearest = np.linalg.pinv(found.jac, rcond=1e-9) @ (found.jac @ found.x - found.fun)
        step = nearest - found.x
        if np.abs(step).max(initial=0.0) < _ALIKE:
            break
        tried = (near(found.x + share * step) for share in (1.0, 0.3, 0.1, 0.03))
        shorter = next((one for one in tried if _closes(one) and _change(one) < _change(found)), None)
        if shorter is None:
            break
        found = shorter
    return found


def _closes(found: OptimizeResult) -> bool:
    return bool(np.abs(found.fun).max(initial=0.0) < CLOSED)


def _change(found: OptimizeResult) -> float:
    return float(np.linalg.norm(found.x))


def _scale(loops: Loops) -> Vector:
    """What a change of one of each coordinate (size,) is: 1 rad, or the length (m) of the longest link."""
    joints = [*loops.joints.values(), *loops.model.closures.values()]
    points = [point for joint in joints for point in (joint.parent_point_m, joint.child_point_m)]
    length = max(float(np.linalg.norm(point)) for point in points) or 1.0
    scale = np.ones(loops.size)
    for name, joint in loops.joints.items():
        first, (displacements, _) = loops.places[name].start, loops.freedoms[joint.type]
        scale[first : first + displacements] = length
    return scale


def other_homes(loops: Loops, written: Mapping[str, Any], states: Mapping[str, Any]) -> Iterator[FoundHome]:
    """Notes on hinges and sliders whose home had to change, and on other joints that had to turn."""
    for name, joint in loops.joints.items():
        if joint.type not in ("hinge", "slider"):
            if _differ(written[name], states[name]):
                words = "the loops do not close as it stands at the start; its child is placed where they do"
                yield FoundHome("", None, f"model.joints.{name}", words)
            continue
        was, now = written[name].coordinate, states[name].coordinate
        if abs(now - was) < _ALIKE:
            continue
        key, unit, factor = ("home_deg", "deg", math.degrees(1.0)) if joint.type == "hinge" else ("home_m", "m", 1.0)
        home = round(factor * now, _DIGITS)
        words = f"the loops do not close at {factor * was:g} {unit}; {home:.10g} is taken, the nearest at which they do"
        yield FoundHome("", None, f"model.joints.{name}.{key}", words, home)


def _differ(one: Any, other: Any) -> bool:
    parts = [part for part in ("value", "position", "turn") if hasattr(one, part)]
    return any(np.abs(getattr(one, part) - getattr(other, part)).max(initial=0.0) > _ALIKE for part in parts)
