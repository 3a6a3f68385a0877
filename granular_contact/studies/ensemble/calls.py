"""Make a sweep over the seeds of a scenario with scatter; run an ensemble from Python."""

from __future__ import annotations

from numbers import Integral
from pathlib import Path

from granular_contact.config import Given, Scenario, Sweep, scenario_given
from granular_contact.config.sweep import case_faults, sweep_of
from granular_contact.errors import ConfigError, Fault, of_type
from granular_contact.laws.scatter import SEEDS
from granular_contact.scene.variants import Builder
from granular_contact.studies.ensemble.runs import observed
from granular_contact.studies.ensemble.statistics import Summary, of_rows
from granular_contact.studies.sweep.calls import file_of
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.runner import run

LEAST = 2


def cases(scenario: Scenario, count: int, first: int | None = None, name: str = "ensemble") -> Sweep:
    """Return the sweep of a scenario over seeds of the scatter of its media.

    Parameters
    ----------
    scenario : Scenario
        At least one of its media scatters. Several such media have the same seed in each run.
    count : int
        Number of runs, 2 or more.
    first : int, optional
        Seed of the first run, from 0; by default that of the first medium that scatters. Each run adds 1.
    name : str, optional
        Name of the sweep, which also stands for its file in messages.

    Returns
    -------
    Sweep
        With a case for each seed.

    Raises
    ------
    ConfigError
        No medium of the scenario scatters, there are too few or too many runs, or the first run is not valid.
    """
    several = isinstance(scenario.medium, tuple)
    media = {f"medium.{i}" if several else "medium": medium for i, medium in enumerate(scenario.media)}
    scatters = {key: medium.scatter for key, medium in media.items() if medium.scatter is not None and medium.scatters}
    if not scatters:
        fault = "is missing, or its relative is 0, so that all runs would be the same; give one, as "
        example = "--set 'medium.scatter={relative: 0.15, length_m: 0.003}'"
        raise ConfigError([Fault(name, None, "medium.scatter", fault + example)])
    start = next(iter(scatters.values())).seed if first is None else first
    if count < LEAST or start < 0 or start + count > SEEDS:
        fault = f"got {count} runs from the seed {start} on; allowed are {LEAST} runs or more, with seeds from 0"
        raise ConfigError([Fault(name, None, "count", fault)])
    seeds = list(range(start, start + count))
    root = file_of(scenario, name, vary={f"{key}.scatter.seed": seeds for key in scatters}, combine="zip")
    # The cases differ in their seed alone, so checking the first one is enough.
    return sweep_of(root, Path(name), [], Builder(), lambda sweep, all_, probe: case_faults(sweep, all_[:1], probe))


def ensemble(scenario: Given, count: int = 200, *, workers: int | None = None) -> Summary:
    """Run a scenario with many seeds of its medium's scatter in worker processes; nothing is saved.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        Result or argument of `load`; its medium has a `scatter`, whose seed is the first one.
    count : int, optional
        Number of runs.
    workers : int, optional
        Number of processes, by default one per core; the result does not depend on it.

    Returns
    -------
    Summary
        Mean, standard deviation and quantiles of every key number, and bands of histories.

    Raises
    ------
    ConfigError
        No medium scatters, or there are too few runs.

    Examples
    --------
    In a script these lines stand below `if __name__ == "__main__":`, because every process imports the script.

    >>> summary = ensemble(load("pendulum", medium={"scatter": {"relative": 0.15, "length_m": 0.003}}), 50)
    >>> summary.numbers["stopping_time_s"].mean
    """
    of_type("count", count, Integral, "a whole number")
    sweep = cases(scenario_given(scenario), count)
    with WorkerPool(workers) as pool:
        return of_rows(run(sweep, pool, function=observed))
