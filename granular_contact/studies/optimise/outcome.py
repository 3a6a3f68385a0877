"""What a search found: its runs, the best of them, and what that gains over the config as it was.

A run is worth its objective; or it breaks the constraints by so much; or it failed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from granular_contact.config import Scenario, Study
from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.report.units import is_number
from granular_contact.results import Results
from granular_contact.results.accuracy import USELESS
from granular_contact.studies.sweep.journal import Row
from granular_contact.studies.sweep.worker import simulate_with_pictures

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
    if row.useless:
        imbalance = row.summary.get(IMBALANCE)
        of_energy = imbalance is not None and not imbalance <= USELESS
        why = f"the energy balance has an error of {imbalance:.0%}" if of_energy else "see its warnings"
        return f"{why}: the result is not usable"
    found: dict[str, Any] = {name: row.summary.get(name) for name in asked(file).values()}
    lacking = [name for name, value in found.items() if not (is_number(value) and math.isfinite(value))]
    return f"it has no {lacking[0]}" if lacking else ""


@dataclass(frozen=True)
class Outcome:
    """A finished search. runs: in the order in which they were asked for; ended: why before all runs were taken."""

    study: Study
    runs: tuple[Judged, ...]
    ended: str = ""

    def __repr__(self) -> str:
        value = (
            "no run came to an end" if self.best is None else f"{self.study.file.objective.formula} = {self.value:.6g}"
        )
        return f"<search {self.study.name}: {len(self.runs)} runs, {len(self.failed)} failed; best: {value}>"

    @cached_property
    def best(self) -> Judged | None:
        """The best run, the earliest of equal ones; None if all failed."""
        best = min(self.runs, key=lambda one: (one.cost, one.index))
        return None if best.cost >= WORST else best

    @property
    def start(self) -> Judged:
        """The run of the config as it is."""
        return self.runs[0]

    @property
    def failed(self) -> list[Judged]:
        """Runs that count as worst."""
        return [one for one in self.runs if one.failure]

    @property
    def value(self) -> float | None:
        """The objective of the best run."""
        return None if self.best is None else self.best.value

    @property
    def gain(self) -> float | None:
        """What the best is better by, relative to the config as it is; None if that failed or broke a constraint."""
        before, after = self.start, self.best
        if after is None or not before.value or after.value is None or not (before.is_allowed and after.is_allowed):
            return None
        change = (after.value - before.value) / abs(before.value)
        return change if self.study.file.objective.sense == "maximise" else -change

    @property
    def numbers(self) -> dict[str, float | None]:
        """The parameters of the best run; None where all failed, or the config has no single number."""
        if self.best is None or not self.best.numbers:
            return dict(self.study.start)
        return dict(self.best.numbers)

    @cached_property
    def scenario(self) -> Scenario:
        """The config with the best numbers; as it is if all runs failed."""
        numbers = {} if self.best is None else self.best.numbers
        return self.study.sweep.scenario(self.study.case(0, numbers))

    def simulate(self) -> Results:
        """The best run once more, with its series."""
        return simulate_with_pictures(self.scenario)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One for each run: its number and generation, the parameters, the objective, and the summary by dotted key."""
        return [
            {
                "run": one.index,
                "generation": one.generation,
                **(one.numbers or self.study.start),
                "objective": one.value,
                "excess": one.excess,
                "failure": one.failure or None,
                **one.row.summary,
            }
            for one in self.runs
        ]
