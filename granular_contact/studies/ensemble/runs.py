"""What a worker does for one member: the run, and short histories of it beside its key numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from granular_contact.config import Scenario
from granular_contact.results import Results
from granular_contact.studies.sweep.worker import simulate_whole

INSTANTS = 121  # of a history
SERIES = "series"
MOST_JOINTS = 2
_ENDS = ("_drawbar_pull_N", "_sinkage_m")


def observed(scenario: Scenario) -> Results:
    """Results of a run whose summary has histories, too: `series`, by column, at equal steps of the run's time."""
    results = simulate_whole(scenario)
    time = results["time_s"]
    at = np.linspace(time[0], time[-1], INSTANTS)
    found = {name: np.interp(at, time, results[name]).tolist() for name in _columns(results.names)}
    return replace(results, summary=results.summary | {SERIES: {"time_s": at.tolist(), **found}})


def _columns(names: list[str]) -> list[str]:
    """Coordinates of the first joints, depth, and what wheels do."""
    joints = [name for name in names if name.endswith(("_angle_deg", "_position_m"))]
    depth = [name for name in names if name == "depth_m"]
    return [*joints[:MOST_JOINTS], *depth, *(name for name in names if name.endswith(_ENDS))]
