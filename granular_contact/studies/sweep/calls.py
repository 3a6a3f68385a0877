"""Run a sweep from Python."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from granular_contact.config import Given, scenario_given, scenario_to_dict, tree
from granular_contact.config.given import plain_data
from granular_contact.config.sweep import sweep_of
from granular_contact.scene.variants import Builder
from granular_contact.studies.sweep.executor import WorkerPool
from granular_contact.studies.sweep.runner import run


def file_of(scenario: Given, name: str, **keys: Any) -> tree.Mapping:
    """Tree of a study file with the scenario as its config, and the given keys that are not None."""
    config = scenario_to_dict(scenario_given(scenario))
    given = {key: value for key, value in {"config": config, **keys}.items() if value is not None}
    at = tree.Position(name, None)
    return tree.mapping({key: tree.from_plain(plain_data(value), at) for key, value in given.items()}, at)


def sweep(
    scenario: Given,
    vary: Mapping[str, Any] | None = None,
    *,
    sample: Mapping[str, Any] | None = None,
    combine: str | None = None,
    workers: int | None = None,
) -> list[dict[str, Any]]:
    """Run a scenario with many values in worker processes; nothing is saved.

    Parameters
    ----------
    scenario : Scenario, Loaded, str, path or mapping
        Result or argument of `load`; the basis of all cases.
    vary : mapping, optional
        Values by dotted key: a list or an array, or a range `{"from": 1, "to": 9, "count": 5, "scale": "log"}`.
    sample : mapping, optional
        In place of `vary`: a random sample of cases, as under `sample` in a sweep file.
    combine : str, optional
        grid (the default), all combinations of the values, or zip, the values side by side.
    workers : int, optional
        Number of processes, by default one per core.

    Returns
    -------
    list of dict
        A row for each case, in order: `case`, the varied values, and the summary by dotted key. A failed case has the
        `status` failed or error, and a `message`.

    Raises
    ------
    ConfigError
        With every fault of the values, before the first run.

    Examples
    --------
    In a script these lines stand below `if __name__ == "__main__":`, because every process imports the script.

    >>> rows = sweep(load("pendulum"), {"medium.eta_d": [4, 5, 6]})
    >>> [row["stopping_time_s"] for row in rows]

    Many runs of the reduced model, with values and key numbers as arrays. A compiled call integrates many of them
    together; a few hundred runs are computed in threads of this process.

    >>> speeds, angles = np.random.default_rng(0).uniform([[2], [22]], [[9], [60]], (2, 10_000))
    >>> values = {"initial.impact_speed_rad_s": speeds, "initial.impact_angle_deg": angles}
    >>> rows = sweep(load("pendulum", method={"reduced": {"modes": 1}}), values, combine="zip")
    >>> depths = np.array([row["max_depth_m"] for row in rows])
    """
    root = file_of(scenario, "sweep", vary=vary, sample=sample, combine=combine)
    cases = sweep_of(root, Path("sweep"), [], Builder())
    with WorkerPool(workers) as pool:
        rows = sorted(run(cases, pool), key=lambda row: row.index)
    return [{"case": row.name, **row.values, **row.summary} for row in rows]
