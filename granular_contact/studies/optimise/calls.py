"""Optimise a scenario from Python."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from granular_contact import scene
from granular_contact.config import Given
from granular_contact.config.optimise import study_of
from granular_contact.studies.optimise.outcome import Outcome
from granular_contact.studies.optimise.search import search
from granular_contact.studies.sweep.calls import file_of
from granular_contact.studies.sweep.executor import WorkerPool


def optimise(
    scenario: Given,
    parameters: Mapping[str, Any],
    *,
    maximise: str | Mapping[str, float] | None = None,
    minimise: str | Mapping[str, float] | None = None,
    constraints: Mapping[str, Mapping[str, float]] | None = None,
    method: Literal["cma", "differential_evolution"] = "cma",
    evaluations: int = 300,
    population: int | None = None,
    seed: int = 0,
    workers: int | None = None,
) -> Outcome:
    """Find the parameters of a scenario that optimise an objective, with runs in worker processes; nothing is saved.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        Result or argument of `load`. The first run is the scenario as it is.
    parameters : mapping
        Ranges by dotted key: `[from, to]`, or a mapping with from, to, scale and keys, as in a file.
    maximise, minimise : str or mapping
        The objective, given to one of the two: dotted key of a number of the summary, or several keys with weights.
    constraints : mapping, optional
        Limits, as `{"largest_drive_torque_Nm": {"at_most": 0.05}}`.
    method : {"cma", "differential_evolution"}
        cma needs the package cma.
    evaluations, population, seed : int
        Number of runs in all, number of runs in a generation, and seed of the random numbers. The same seed gives the
        same runs.
    workers : int, optional
        Number of processes, by default one per core; the outcome does not depend on it.

    Returns
    -------
    Outcome
        The `best` run, its parameters `numbers` and its `scenario`, the `gain`, and all `runs` (`rows` as plain data).

    Raises
    ------
    ConfigError
        With every fault of the arguments, before the first run; or no run has a number of the objective or a
        constraint.
    MissingPackageError
        The package cma is not installed.

    Examples
    --------
    In a script these lines stand below `if __name__ == "__main__":`, because every process imports the script.

    >>> runner = load("runner", solver={"accuracy": 1e-2})
    >>> outcome = optimise(runner, {"signals.stride.frequency_Hz": [1, 6], "signals.stride.duty_factor": [0.3, 0.7]},
    ...                    maximise="forward_speed_m_s")
    >>> outcome.numbers, outcome.gain
    """
    goals = {"maximise": maximise, "minimise": minimise}
    root = file_of(
        scenario,
        "optimise",
        parameters=parameters,
        objective={sense: goal for sense, goal in goals.items() if goal is not None},
        constraints=constraints,
        method=method,
        evaluations=evaluations,
        population=population,
        seed=seed,
    )
    study = study_of(root, Path("optimise"), [], scene.build)
    with WorkerPool(workers) as pool:
        return search(study, pool)
