"""What a run is worth: the objective, or by how much it breaks the constraints, or that it failed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.report.units import is_number
from granular_contact.results.accuracy import USELESS
from granular_contact.studies.sweep.journal import Row

# Costs that no objective has: one method ranks costs, the other compares them, and both need numbers.
OUTSIDE, WORST = 1e30, 1e40
IMBALANCE = "energy.imbalance_relative"


@dataclass(frozen=True)
class Judged:
    """A run and its worth.

    index: from 0, which is the config as it is; generation: from 1, of that one 0. numbers: of the parameters, empty
    for the config as it is. value: of the objective, None of a run that failed; excess: how far constraints are
    broken, relative to them. failure: why it counts as worst, empty if it does not.
    """

    index: int
    generation: int
    numbers: dict[str, float]
    row: Row
    value: float | None
    excess: float
    failure: str
    cost: float

    @property
    def is_allowed(self) -> bool:
        """Whether it came to an end within all constraints."""
        return not self.failure and self.excess == 0.0


def judged(index: int, generation: int, numbers: Mapping[str, float], row: Row, file: OptimiseFile) -> Judged:
    """The worth of a run; costs are to be small."""
    failure, summary = _failure(row, file), row.summary
    if failure:
        return Judged(index, generation, dict(numbers), row, None, 0.0, failure, WORST)
    value = sum(weight * summary[name] for name, weight in file.objective.weights.items())
    excess = sum(limit.excess(summary[name]) for name, limit in file.constraints.items())
    cost = value if file.objective.sense == "minimise" else -value
    if excess > 0.0:
        cost = OUTSIDE * (1.0 + excess)
    return Judged(index, generation, dict(numbers), row, value, excess, "", cost)


def asked(file: OptimiseFile) -> dict[tuple[str, ...], str]:
    """Numbers of the summary that a search needs, by where in its file each stands."""
    sense = file.objective.sense
    alone = isinstance(getattr(file.objective, sense), str)
    found: dict[tuple[str, ...], str] = {
        ("objective", sense) if alone else ("objective", sense, name): name for name in file.objective.weights
    }
    return found | {("constraints", name): name for name in file.constraints}


def _failure(row: Row, file: OptimiseFile) -> str:
    if row.failed:
        return str(row.summary.get("message") or row.summary["status"])
    if (imbalance := row.summary.get(IMBALANCE)) is not None and not imbalance <= USELESS:
        return f"the energy balance has an error of {imbalance:.0%}: the result is not usable"
    found: dict[str, Any] = {name: row.summary.get(name) for name in asked(file).values()}
    lacking = [name for name, value in found.items() if not (is_number(value) and math.isfinite(value))]
    return f"it has no {lacking[0]}" if lacking else ""
