"""What a search found: its runs, the best of them, and what that gains over the config as it was."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from granular_contact.config import Scenario, Study
from granular_contact.results import Results
from granular_contact.studies.optimise.judging import WORST, Judged
from granular_contact.studies.sweep.worker import simulate_with_pictures


@dataclass(frozen=True)
class Outcome:
    """A finished search. runs: in the order in which they were asked for; ended: why before all runs were taken."""

    study: Study
    runs: tuple[Judged, ...]
    ended: str = ""

    def __repr__(self) -> str:
        value = (
            "no run came to an end" if self.best is None else f"{self.study.file.objective.words} = {self.value:.6g}"
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
        return self.study.load(self.study.case(0, numbers)).scenario

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
