"""Warnings on the accuracy of a finished solve, with what to change; the most serious one first.

The imbalance of energy is energy that the time steps added to the motion or removed from it. It counts over the whole
run, whereas estimates of the error of positions count single steps. So an estimate of positions that is much smaller
than the imbalance implies is not reported beside the imbalance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from granular_contact.scene.types import Reduced, Scene

IMBALANCE_LIMIT = 1e-3  # of the largest energy; above it a run has a warning
USELESS = 0.05  # of the largest energy; above it the result is not usable and other estimates are meaningless


@dataclass(frozen=True)
class AccuracyWarning:
    """A warning, with the error of positions that it reports, relative to the distance travelled.

    error: NaN if the warning reports no error of positions, infinite if it says that the result is not usable.
    """

    sentence: str
    error: float = math.nan


def usable(imbalance: float, accuracy: Sequence[AccuracyWarning]) -> bool:
    """Return whether a result is usable; if not, a warning says why. imbalance: relative to the largest energy."""
    return imbalance <= USELESS and not any(warning.error == math.inf for warning in accuracy)


def warning_sentences(imbalance: float, accuracy: Sequence[AccuracyWarning], scene: Scene) -> list[str]:
    """Warnings on the accuracy of a run, as sentences; imbalance: relative to the largest energy."""
    fatal = [warning.sentence for warning in accuracy if warning.error == math.inf]
    balance = f"the energy balance has an error of {share(imbalance)}"
    if imbalance > USELESS:
        return [f"{balance}: the result is not usable; {remedy(scene)}", *fatal]
    if fatal or not imbalance > IMBALANCE_LIMIT:
        return fatal or [warning.sentence for warning in accuracy]
    # Energy is proportional to the square of velocity, so a relative error of velocities is half that of energy.
    large = [warning.sentence for warning in accuracy if not warning.error < 0.5 * imbalance]
    return [f"{balance}: {remedy(scene)}", *large]


def share(value: float) -> str:
    """Format a fraction as a percentage with one decimal place, or two below 1 %."""
    return f"{value:.1%}" if value >= 0.01 else f"{value:.2%}"


def remedy(scene: Scene) -> str:
    """Advice on which setting of the scene makes the run more accurate."""
    if isinstance(scene.method, Reduced):
        return f"take a smaller method.reduced.rtol (now {scene.method.rtol:g})"
    if scene.solver.accuracy is not None:
        return f"take a smaller solver.accuracy (now {scene.solver.accuracy:g})"
    return f"take a smaller solver.step_s (now {scene.solver.step_s:g}) or solver.accuracy: 1e-3"
