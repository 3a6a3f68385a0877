"""Estimates of the error of a finished solve, and what to change; the worst said first.

Energy that is unaccounted for was put into the motion or taken out of it by the steps. No estimate of positions that
promises less may stand beside it: such estimates look at single steps, the balance at the whole run.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from granular_contact.scene.types import Reduced, Scene

IMBALANCE_LIMIT = 1e-3  # of the largest energy; a run beyond it carries a warning
USELESS = 0.05  # beyond it nothing else is worth saying of its accuracy


@dataclass(frozen=True)
class AccuracyWarning:
    """A sentence, and the error of positions that it states, relative to the distance travelled.

    error: NaN where it states none, infinite where the result is not usable.
    """

    sentence: str
    error: float = math.nan


def usable(imbalance: float, found: Sequence[AccuracyWarning]) -> bool:
    """Whether a result is usable; where not, a warning says why. imbalance: relative to the largest energy."""
    return imbalance <= USELESS and not any(one.error == math.inf for one in found)


def warning_sentences(imbalance: float, found: Sequence[AccuracyWarning], scene: Scene) -> list[str]:
    """Sentences on the accuracy of a run; imbalance: relative to its largest energy."""
    fatal = [one.sentence for one in found if one.error == math.inf]
    said = f"the energy balance has an error of {share(imbalance)}"
    if imbalance > USELESS:
        return [f"{said}: the result is not usable; {remedy(scene)}", *fatal]
    if fatal or not imbalance > IMBALANCE_LIMIT:
        return fatal or [one.sentence for one in found]
    # Half of it: energies go with the square of velocities.
    return [f"{said}: {remedy(scene)}", *(one.sentence for one in found if not one.error < 0.5 * imbalance)]


def share(value: float) -> str:
    """A part of one as a percentage of two digits at the least."""
    return f"{value:.1%}" if value >= 0.01 else f"{value:.2%}"


def remedy(scene: Scene) -> str:
    """What to change for a finer run."""
    if isinstance(scene.method, Reduced):
        return f"take a smaller method.reduced.rtol (now {scene.method.rtol:g})"
    if scene.solver.accuracy is not None:
        return f"take a smaller solver.accuracy (now {scene.solver.accuracy:g})"
    return f"take a smaller solver.step_s (now {scene.solver.step_s:g}) or solver.accuracy: 1e-3"
