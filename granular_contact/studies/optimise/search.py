"""Search loop: the method proposes a generation, its runs are evaluated, and the method receives the costs.

The methods see each parameter as a fraction from 0 to 1 of its range, on its scale.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from contextlib import closing
from importlib import metadata
from typing import Any

import numpy as np

from granular_contact.config import Study
from granular_contact.config.messages import unknown
from granular_contact.config.schema.optimise import OptimiseFile
from granular_contact.errors import MissingPackageError
from granular_contact.report.units import is_number
from granular_contact.studies.optimise.outcome import Evaluation, Outcome, evaluation, required_numbers
from granular_contact.studies.sweep.checkpoint import FolderRefused
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.runner import CaseRunner
from granular_contact.studies.sweep.worker import Simulate, Task, simulate

SPREAD = 0.25  # initial step size of CMA, as a fraction of each range
MISSING = "method: cma needs the package cma: pip install 'granular-contact[optimise]', or take differential_evolution"
Generation = Sequence[Sequence[float]]
Evaluate = Callable[[Generation], list[float]]


class BudgetSpent(Exception):
    """The number of evaluations of the search is used up."""


def packages(file: OptimiseFile) -> dict[str, str]:
    """Version of the package of the method, on which the proposals depend.

    Raises
    ------
    MissingPackageError
        The package of the method is not installed.
    """
    if file.method == "differential_evolution":
        return {"scipy": metadata.version("scipy")}
    try:
        return {"cma": metadata.version("cma")}
    except metadata.PackageNotFoundError:
        raise MissingPackageError(MISSING) from None


def iterate(file: OptimiseFile, start: Sequence[float], evaluate: Evaluate) -> str:
    """Run the method from a start until `evaluate` raises BudgetSpent; return the reason if it ends earlier, or ''."""
    method = {"cma": _cma, "differential_evolution": _differential_evolution}[file.method]
    try:
        return method(np.array(start), file.size, file.seed, evaluate)
    except BudgetSpent:
        return ""


def _cma(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Covariance matrix adaptation (Hansen & Ostermeier 2001), by the package of its author."""
    cma: Any = importlib.import_module("cma")
    options = {
        "bounds": [0.0, 1.0],
        "popsize": size,
        "seed": seed + 1,  # the package takes 0 for the time of day
        "maxfevals": np.inf,
        "maxiter": np.inf,
        "verbose": -9,
    }
    before = np.random.get_state()  # noqa: NPY002 (the package uses the global generator)
    try:
        strategy = cma.CMAEvolutionStrategy(start, SPREAD, options)
        while not strategy.stop():
            generation = strategy.ask()
            strategy.tell(generation, evaluate([list(map(float, point)) for point in generation]))
    finally:
        np.random.set_state(before)  # noqa: NPY002
    return f"cma stopped by its own criteria ({', '.join(strategy.stop())})"


def _differential_evolution(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Differential evolution (Storn & Price 1997), by scipy; the first generation contains the start."""
    from scipy.optimize import differential_evolution
    from scipy.stats import qmc

    random = np.random.default_rng(seed)
    first = qmc.LatinHypercube(len(start), rng=random).random(size)
    first[0] = start
    differential_evolution(
        lambda columns: np.array(evaluate(columns.T.tolist())),
        [(0.0, 1.0)] * len(start),
        init=first,
        maxiter=10**9,
        tol=0.0,
        polish=False,
        updating="deferred",
        vectorized=True,
        rng=random,
    )
    return "all runs of a generation have the same cost"


def search(
    study: Study,
    pool: WorkerPool,
    *,
    journal: Journal | None = None,
    function: Simulate = simulate,
    advance: Callable[[], None] = lambda: None,
) -> Outcome:
    """Run a search to its end.

    Parameters
    ----------
    study : Study
        From `granular_contact.config.load_optimise`.
    pool : WorkerPool
        The workers.
    journal : Journal, optional
        Stores each row; runs whose rows it already has are not repeated.
    function : callable, optional
        Function from a scenario to its results or summary, importable in the workers.
    advance : callable, optional
        Called after each new run.

    Returns
    -------
    Outcome

    Raises
    ------
    ConfigError
        No run has a number that the objective or a constraint needs.
    FolderRefused
        The journal belongs to another search.
    MissingPackageError
        The package of the method is not installed.
    OSError, WorkerPoolError
        As `granular_contact.studies.sweep.run`.
    """
    stored = {} if journal is None else {row.index: row for row in journal}
    with closing(CaseRunner(study.sweep, pool, journal=journal, function=function)) as cases:
        runs = _Runs(study, cases, stored, advance)
        runs([{}])  # the config as it is: checks the numbers of the objective, and is the reference of the gain
        ended = iterate(study.file, study.start_fractions(), runs.costs_of)
    return Outcome(study, tuple(runs.evaluations), ended)


class _Runs:
    """The runs of a search so far, and the function that evaluates further generations."""

    def __init__(self, study: Study, cases: CaseRunner, stored: dict[int, Row], advance: Callable[[], None]) -> None:
        self._study, self._cases, self._stored, self._advance = study, cases, stored, advance
        self.evaluations: list[Evaluation] = []
        self._generations, self._checked = 0, False

    def costs_of(self, generation: Generation) -> list[float]:
        """Costs of points given as fractions of the ranges; raises BudgetSpent when no runs are left."""
        left = self._study.file.evaluations - len(self.evaluations)
        costs = self([self._study.numbers(point) for point in generation[:left]])
        if left <= len(generation):
            raise BudgetSpent
        return costs

    def __call__(self, generation: Sequence[dict[str, float]]) -> list[float]:
        """Run and evaluate a generation, given by its parameters; return the costs."""
        first, rows = len(self.evaluations), dict[int, Row]()
        tasks = []
        for index, numbers in enumerate(generation, first):
            case = self._study.case(index, numbers)
            if index in self._stored:
                rows[index] = self._stored[index]
                if any(rows[index].values.get(key) != value for key, value in case.values.items()):
                    fault = f"{case.name} in the journal has other numbers than this search asks for"
                    raise FolderRefused(f"{fault}; --restart discards the journal")
                continue
            sweep = self._study.sweep
            tasks.append(Task(index, case, sweep.scenario(case) if sweep.needs_files(case) else None))
        for row in self._cases.rows(iter(tasks), len(tasks)):
            rows[row.index] = row
            self._advance()
        file = self._study.file
        evaluations = [
            evaluation(i, self._generations, numbers, rows[i], file) for i, numbers in enumerate(generation, first)
        ]
        self._generations += 1
        self.evaluations += evaluations
        self._check([run.row for run in evaluations])
        return [run.cost for run in evaluations]

    def _check(self, rows: Sequence[Row]) -> None:
        """Raise if no summary has a number that the search needs, or no run of the first generations has a value."""
        finished = [row for row in rows if not row.failed]
        if self._checked or not finished:
            return
        for path, name in required_numbers(self._study.file).items():
            summaries = [row.summary for row in finished]
            numbers = [key for key, value in summaries[0].items() if value is None or is_number(value)]
            if not any(name in summary for summary in summaries) or name not in numbers:
                message = f"got {name!r}, which is no number of a summary; {unknown(name, numbers)}"
                raise self._study.fault(path, message)
            if len(self.evaluations) > 1 and not any(run.row.summary.get(name) is not None for run in self.evaluations):
                raise self._study.fault(path, f"none of the first {len(self.evaluations)} runs has {name}")
        self._checked = len(self.evaluations) > 1
