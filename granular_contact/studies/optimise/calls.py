"""A search from Python: a scenario, what may change in it and what is best -> the best numbers."""

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
    """Find the numbers of a scenario that are best, with runs in processes of their own; nothing is saved.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        What all runs start from, as `load` gave or takes it; the first run is of it as it is.
    parameters : mapping
        Ranges by dotted key: `[from, to]`, or a mapping with from, to, scale and keys, as in a file.
    maximise, minimise : str or mapping
        One of them: a number of the summary by its dotted key, or several with their weights.
    constraints : mapping, optional
        Limits, as `{"largest_drive_torque_Nm": {"at_most": 0.05}}`.
    method : {"cma", "differential_evolution"}
        cma needs the package of that name.
    evaluations, population, seed : int
        Runs in all, runs in a generation, and where chance starts: the same seed gives the same runs.
    workers : int, optional
        Processes, one a core unless given; they do not change the outcome.

    Returns
    -------
    Outcome
        The `best` run with its `numbers`, the `scenario` that has them, the `gain`, and all `runs` (`rows` as plain
        data).

    Raises
    ------
    ConfigError
        With every fault of what was given, before anything runs; or no run has a number that is asked for.
    MissingPackageError
        There is no package cma.

    Examples
    --------
    In a script these lines stand below `if __name__ == "__main__":`, since the processes import it.

    >>> runner = load("runner", solver={"accuracy": 1e-2})
    >>> found = optimise(runner, {"signals.stride.frequency_Hz": [1, 6], "signals.stride.duty_factor": [0.3, 0.7]},
    ...                  maximise="forward_speed_m_s")
    >>> found.numbers, found.gain
    """
    goals = {"maximise": maximise, "minimise": minimise}
    root = file_of(
        scenario,
        "optimise",
        parameters=parameters,
        objective={key: one for key, one in goals.items() if one is not None},
        constraints=constraints,
        method=method,
        evaluations=evaluations,
        population=population,
        seed=seed,
    )
    study = study_of(root, Path("optimise"), [], scene.build)
    with WorkerPool(workers) as pool:
        return search(study, pool)
