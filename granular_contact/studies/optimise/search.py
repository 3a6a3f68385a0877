"""Study and pool -> outcome: generations asked for, run, judged and given back, until all runs are taken.

All parameters run from 0 to 1 here, over their ranges and on their scales.
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
from granular_contact.studies.optimise.outcome import Judged, Outcome, asked, judged
from granular_contact.studies.sweep.checkpoint import FolderRefused
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.journal import Journal, Row
from granular_contact.studies.sweep.runner import CaseRunner
from granular_contact.studies.sweep.worker import Simulate, Task, simulate

SPREAD = 0.25  # of the first generation of CMA, a quarter of each range
MISSING = "method: cma needs the package cma: pip install 'granular-contact[optimise]', or take differential_evolution"
Generation = Sequence[Sequence[float]]
Evaluate = Callable[[Generation], list[float]]


class Spent(Exception):
    """All runs that a search may take are taken."""


def packages(file: OptimiseFile) -> dict[str, str]:
    """Versions of what draws the numbers; another version would draw others.

    Raises
    ------
    MissingPackageError
        The method's package is not there.
    """
    if file.method == "differential_evolution":
        return {"scipy": metadata.version("scipy")}
    try:
        return {"cma": metadata.version("cma")}
    except metadata.PackageNotFoundError:
        raise MissingPackageError(MISSING) from None


def look(file: OptimiseFile, start: Sequence[float], evaluate: Evaluate) -> str:
    """Let the method of a search look from a start, until `evaluate` raises Spent; or why it ended before."""
    method = {"cma": _cma, "differential_evolution": _differential_evolution}[file.method]
    try:
        return method(np.array(start), file.size, file.seed, evaluate)
    except Spent:
        return ""


def _cma(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Covariance matrix adaptation (Hansen & Ostermeier 2001), by the package of its author."""
    cma: Any = importlib.import_module("cma")
    options = {
        "bounds": [0.0, 1.0],
        "popsize": size,
        "seed": seed + 1,  # 0 is the time of day there
        "maxfevals": np.inf,
        "maxiter": np.inf,
        "verbose": -9,
    }
    before = np.random.get_state()  # noqa: NPY002 (the package draws from it)
    try:
        strategy = cma.CMAEvolutionStrategy(start, SPREAD, options)
        while not strategy.stop():
            asked = strategy.ask()
            strategy.tell(asked, evaluate([list(map(float, one)) for one in asked]))
    finally:
        np.random.set_state(before)  # noqa: NPY002
    return f"cma found nothing better to try ({', '.join(strategy.stop())})"


def _differential_evolution(start: Any, size: int, seed: int, evaluate: Evaluate) -> str:
    """Differential evolution (Storn & Price 1997), by scipy; the start is one of the first generation."""
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
    return "all of a generation are worth the same"


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
        Of `granular_contact.config.load_optimise`.
    pool : WorkerPool
        Who works.
    journal : Journal, optional
        Keeps each row; those that are in it are not run again.
    function : callable, optional
        What a run goes through, importable in the workers.
    advance : callable, optional
        Called for each new run.

    Returns
    -------
    Outcome

    Raises
    ------
    ConfigError
        No run has a number that the objective or a constraint asks for.
    FolderRefused
        The journal is of another search.
    MissingPackageError
        The method's package is not installed.
    OSError, WorkerPoolError
        As of `granular_contact.studies.sweep.run`.
    """
    there = {} if journal is None else {row.index: row for row in journal}
    with closing(CaseRunner(study.sweep, pool, journal=journal, function=function)) as cases:
        runs = _Runs(study, cases, there, advance)
        runs([{}])  # the config as it is, by which the objective is checked and the gain is reported
        ended = look(study.file, study.start_fractions(), runs.of_fractions)
    return Outcome(study, tuple(runs.judged), ended)


class _Runs:
    """What was run so far, and what runs more."""

    def __init__(self, study: Study, cases: CaseRunner, there: dict[int, Row], advance: Callable[[], None]) -> None:
        self._study, self._cases, self._there, self._advance = study, cases, there, advance
        self.judged: list[Judged] = []
        self._generation, self._known = 0, False

    def of_fractions(self, generation: Generation) -> list[float]:
        """Costs of the parameters at fractions of their ranges; raises Spent when there are no runs left."""
        left = self._study.file.evaluations - len(self.judged)
        costs = self([self._study.numbers(one) for one in generation[:left]])
        if left <= len(generation):
            raise Spent
        return costs

    def __call__(self, numbers: Sequence[dict[str, float]]) -> list[float]:
        """Costs of runs with these numbers of the parameters."""
        first, rows = len(self.judged), dict[int, Row]()
        tasks = []
        for index, held in enumerate(numbers, first):
            case = self._study.case(index, held)
            if index in self._there:
                rows[index] = self._there[index]
                if any(rows[index].values.get(key) != value for key, value in case.values.items()):
                    words = f"{case.name} in the journal has other numbers than this search asks for"
                    raise FolderRefused(f"{words}: --restart throws it away")
                continue
            sweep = self._study.sweep
            tasks.append(Task(index, case, sweep.scenario(case) if sweep.needs_files(case) else None))
        for row in self._cases.rows(iter(tasks), len(tasks)):
            rows[row.index] = row
            self._advance()
        file = self._study.file
        found = [judged(i, self._generation, held, rows[i], file) for i, held in enumerate(numbers, first)]
        self._generation += 1
        self.judged += found
        self._check([one.row for one in found])
        return [one.cost for one in found]

    def _check(self, rows: Sequence[Row]) -> None:
        """Raise if a number that is asked for is in no summary, or in none of a whole generation."""
        finished = [row for row in rows if not row.failed]
        if self._known or not finished:
            return
        for path, name in asked(self._study.file).items():
            summaries = [row.summary for row in finished]
            numbers = [key for key, value in summaries[0].items() if value is None or is_number(value)]
            if not any(name in summary for summary in summaries) or name not in numbers:
                message = f"got {name!r}, which is no number of a summary; {unknown(name, numbers)}"
                raise self._study.fault(path, message)
            if len(self.judged) > 1 and not any(one.row.summary.get(name) is not None for one in self.judged):
                raise self._study.fault(path, f"none of the first {len(self.judged)} runs has {name}")
        self._known = len(self.judged) > 1
