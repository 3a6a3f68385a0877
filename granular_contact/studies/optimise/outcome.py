"""Outcome of a search: its evaluated runs, the best of them, and its gain over the config as it is.

The cost of a run is its objective. A run that violates constraints costs more than any that does not, in proportion to
the violation; a failed run costs most.
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

# Costs larger than any objective, so that both methods can rank runs that violate constraints or failed.
OUTSIDE, WORST = 1e30, 1e40
IMBALANCE = "energy.imbalance_relative"


@dataclass(frozen=True)
class Evaluation:
    """A run with its objective and cost.

    index: 0 for the config as it is, then 1, 2, ...; generation: 0 for the config as it is, then 1, 2, ...; numbers: of
    the parameters, empty for the config as it is. value: of the objective, None if the run failed; excess: sum of the
    violations of constraints, relative to their limits. failure: reason of a failure, empty without one.
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
        """Whether the run did not fail and satisfies all constraints."""
        return not self.failure and self.excess == 0.0


def evaluation(index: int, generation: int, numbers: Mapping[str, float], row: Row, file: OptimiseFile) -> Evaluation:
    """Evaluate a run: its objective, violation of constraints, and cost, which the search minimises."""
    failure, summary = _failure(row, file), row.summary
    if failure:
        return Evaluation(index, generation, dict(numbers), row, None, 0.0, failure, WORST)
    value = sum(weight * summary[name] for name, weight in file.objective.weights.items())
    excess = sum(limit.excess(summary[name]) for name, limit in file.constraints.items())
    cost = value if file.objective.sense == "minimise" else -value
    if excess > 0.0:
        cost = OUTSIDE * (1.0 + excess)
    return Evaluation(index, generation, dict(numbers), row, value, excess, "", cost)


def required_numbers(file: OptimiseFile) -> dict[tuple[str, ...], str]:
    """Numbers of the summary that objective and constraints need, by the path of the key that names each."""
    sense = file.objective.sense
    is_single = isinstance(getattr(file.objective, sense), str)
    names: dict[tuple[str, ...], str] = {
        ("objective", sense) if is_single else ("objective", sense, name): name for name in file.objective.weights
    }
    return names | {("constraints", name): name for name in file.constraints}


def _failure(row: Row, file: OptimiseFile) -> str:
    if row.failed:
        return str(row.summary.get("message") or row.summary["status"])
    if row.useless:
        imbalance = row.summary.get(IMBALANCE)
        is_unbalanced = imbalance is not None and not imbalance <= USELESS
        reason = f"the energy balance has an error of {imbalance:.0%}" if is_unbalanced else "see its warnings"
        return f"{reason}: the result is not usable"
    numbers: dict[str, Any] = {name: row.summary.get(name) for name in required_numbers(file).values()}
    missing = [name for name, value in numbers.items() if not (is_number(value) and math.isfinite(value))]
    return f"the run has no {missing[0]}" if missing else ""


@dataclass(frozen=True)
class Outcome:
    """A finished search. runs: in the order of the proposals; ended: reason of an early end, empty without one."""

    study: Study
    runs: tuple[Evaluation, ...]
    ended: str = ""

    def __repr__(self) -> str:
        value = (
            "no run came to an end" if self.best is None else f"{self.study.file.objective.formula} = {self.value:.6g}"
        )
        return f"<search {self.study.name}: {len(self.runs)} runs, {len(self.failed)} failed; best: {value}>"

    @cached_property
    def best(self) -> Evaluation | None:
        """The run of least cost, the first of equal ones; None if all runs failed."""
        best = min(self.runs, key=lambda run: (run.cost, run.index))
        return None if best.cost >= WORST else best

    @property
    def start(self) -> Evaluation:
        """The run of the config as it is."""
        return self.runs[0]

    @property
    def failed(self) -> list[Evaluation]:
        """Runs that failed, or have no usable result."""
        return [run for run in self.runs if run.failure]

    @property
    def value(self) -> float | None:
        """The objective of the best run."""
        return None if self.best is None else self.best.value

    @property
    def gain(self) -> float | None:
        """Improvement of the objective by the best run, relative to the config as it is.

        None if the objective of the config is zero, or if either run failed or violates a constraint.
        """
        start, best = self.start, self.best
        if best is None or not start.value or best.value is None or not (start.is_allowed and best.is_allowed):
            return None
        change = (best.value - start.value) / abs(start.value)
        return change if self.study.file.objective.sense == "maximise" else -change

    @property
    def numbers(self) -> dict[str, float | None]:
        """Parameters of the best run, or of the config if all runs failed or the config itself is best.

        None for a parameter for which the config has no single number.
        """
        if self.best is None or not self.best.numbers:
            return dict(self.study.start)
        return dict(self.best.numbers)

    @cached_property
    def scenario(self) -> Scenario:
        """The config with the parameters of the best run; unchanged if all runs failed."""
        numbers = {} if self.best is None else self.best.numbers
        return self.study.sweep.scenario(self.study.case(0, numbers))

    def simulate(self) -> Results:
        """Repeat the best run, with its time series."""
        return simulate_with_pictures(self.scenario)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """For each run its number and generation, the parameters, the objective, and the summary by dotted key."""
        return [
            {
                "run": run.index,
                "generation": run.generation,
                **(run.numbers or self.study.start),
                "objective": run.value,
                "excess": run.excess,
                "failure": run.failure or None,
                **run.row.summary,
            }
            for run in self.runs
        ]
