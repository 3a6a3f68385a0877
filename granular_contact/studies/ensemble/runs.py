"""One member of an ensemble, in a worker: its key numbers and short histories."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from granular_contact.config import Scenario

if TYPE_CHECKING:
    from granular_contact.results.observation import Observation

INSTANTS = 121  # number of instants of a history
SERIES = "series"
MOST_JOINTS = 2
_ENDS = ("_drawbar_pull_N", "_sinkage_m")


def observed(scenario: Scenario) -> dict[str, Any]:
    """Run a scenario, and return its key numbers and short histories.

    Parameters
    ----------
    scenario : Scenario
        A checked scenario.

    Returns
    -------
    dict
        The summary of the run, with a further entry `series`: lists of `INSTANTS` values by column. `time_s` is evenly
        spaced over this run. The other columns are the coordinates of at most two joints (deg or m), the depth (m) of
        the deepest point, and drawbar pull (N) and sinkage (m) of wheels, in the signs of the results.

    Raises
    ------
    SceneError, SolveError
        The scene is contradictory, or its solve could not be started.
    """
    from granular_contact.run import summary_of
    from granular_contact.scene.build import build_checked

    return summary_of(build_checked(scenario), _histories)


def _histories(observation: Observation) -> dict[str, Any]:
    at = np.linspace(observation.time[0], observation.time[-1], INSTANTS)
    columns = {name: values for name, (_, values) in observation.motion.items()}
    if observation.depth is not None:
        columns["depth_m"] = observation.depth
    histories = {name: np.interp(at, observation.time, columns[name]).tolist() for name in _columns(list(columns))}
    return {SERIES: {"time_s": at.tolist(), **histories}}


def _columns(names: list[str]) -> list[str]:
    """Columns to keep: coordinates of the first joints, depth, drawbar pull and sinkage of wheels."""
    joints = [name for name in names if name.endswith(("_angle_deg", "_position_m"))]
    depth = [name for name in names if name == "depth_m"]
    return [*joints[:MOST_JOINTS], *depth, *(name for name in names if name.endswith(_ENDS))]
