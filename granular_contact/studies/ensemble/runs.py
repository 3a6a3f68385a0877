"""What a worker does for one member: the run, and short histories of it beside its key numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.config import Scenario

if TYPE_CHECKING:
    from granular_contact.results.observation import Observation

INSTANTS = 121  # of a history
SERIES = "series"
MOST_JOINTS = 2
_ENDS = ("_drawbar_pull_N", "_sinkage_m")


def observed(scenario: Scenario) -> dict[str, Any]:
    """Key numbers of a run, with histories among them: `series`, by column, at equal steps of the run's time."""
    from granular_contact.run import summary_of
    from granular_contact.scene.build import built

    return summary_of(built(scenario), _histories)


def _histories(seen: Observation) -> dict[str, Any]:
    at = np.linspace(seen.time[0], seen.time[-1], INSTANTS)
    known = {name: values for name, (_, values) in seen.motion.items()}
    if seen.depth is not None:
        known["depth_m"] = seen.depth
    found = {name: np.interp(at, seen.time, known[name]).tolist() for name in _columns(list(known))}
    return {SERIES: {"time_s": at.tolist(), **found}}


def _columns(names: list[str]) -> list[str]:
    """Coordinates of the first joints, depth, and what wheels do."""
    joints = [name for name in names if name.endswith(("_angle_deg", "_position_m"))]
    depth = [name for name in names if name == "depth_m"]
    return [*joints[:MOST_JOINTS], *depth, *(name for name in names if name.endswith(_ENDS))]
