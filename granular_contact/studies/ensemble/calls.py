"""A run with scatter -> the sweep over its seeds, and an ensemble from Python."""

from __future__ import annotations

from numbers import Integral
from pathlib import Path

from granular_contact.config import Given, Scenario, Sweep, scenario_given
from granular_contact.config.sweep import case_faults, sweep_of
from granular_contact.errors import ConfigError, Fault, of_type
from granular_contact.laws.scatter import SEEDS
from granular_contact.scene.again import Builder
from granular_contact.studies.ensemble.runs import observed
from granular_contact.studies.ensemble.statistics import Summary, of_rows
from granular_contact.studies.sweep.calls import file_of
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.runner import run

LEAST = 2


def cases(scenario: Scenario, count: int, first: int | None = None, name: str = "ensemble") -> Sweep:
    """The sweep of a run over `count` seeds, from `first` or the run's own on.

    Raises
    ------
    ConfigError
        No medium of the run scatters, or there are too few or too many runs.
    """
    several = isinstance(scenario.medium, tuple)
    at = {f"medium.{i}" if several else "medium": one for i, one in enumerate(scenario.media)}
    scattering = {key: one.scatter for key, one in at.items() if one.scatter is not None and one.scatters}
    if not scattering:
        words = "is missing, or its relative is 0, so that all runs would be the same; give one, as "
        example = "--set 'medium.scatter={relative: 0.15, length_m: 0.003}'"
        raise ConfigError([Fault(name, None, "medium.scatter", words + example)])
    start = next(iter(scattering.values())).seed if first is None else first
    if count < LEAST or start < 0 or start + count > SEEDS:
        words = f"got {count} runs from the seed {start} on; allowed are {LEAST} runs or more, with seeds from 0"
        raise ConfigError([Fault(name, None, "count", words)])
    seeds = list(range(start, start + count))
    root = file_of(scenario, name, vary={f"{key}.scatter.seed": seeds for key in scattering}, combine="zip")
    # They differ in their seed alone, so what is true of one is true of all.
    return sweep_of(root, Path(name), [], Builder(), lambda found, all_, probe: case_faults(found, all_[:1], probe))


def ensemble(scenario: Given, count: int = 200, *, workers: int | None = None) -> Summary:
    """Run a scenario with many seeds of its medium's scatter in worker processes; nothing is saved.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        What `load` gave, or takes; of a medium with `scatter`; its seed is the first one.
    count : int, optional
        Runs.
    workers : int, optional
        Processes, one a core unless given; the result does not depend on it.

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
    In a script these lines stand below `if __name__ == "__main__":`, since the processes import it.

    >>> found = ensemble(load("pendulum", medium={"scatter": {"relative": 0.15, "length_m": 0.003}}), 50)
    >>> found.numbers["stopping_time_s"].mean
    """
    of_type("count", count, Integral, "a whole number")
    sweep = cases(scenario_given(scenario), count)
    with WorkerPool(workers) as pool:
        return of_rows(run(sweep, pool, function=observed))
