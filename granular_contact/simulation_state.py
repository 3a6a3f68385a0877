"""State of a simulation at one instant, for `Simulation.restore`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.config.differences import differing_keys
from granular_contact.errors import ControlError
from granular_contact.results import Status
from granular_contact.scene.drives import RangeExcess


@dataclass(frozen=True, repr=False)
class State:
    """State of a simulation at one instant, for `Simulation.restore`. It can be pickled.

    time (s); scenario: scenario of the simulation; solve: state of the solver; controls: values of the controls, in SI
    units; beyond: values outside ranges by joint, see `RangeExcess`; random: state of the random generator; failed:
    status of a run that a controller ended, else None.
    """

    time: float
    scenario: Scenario
    solve: Any
    controls: tuple[float, ...]
    beyond: dict[str, RangeExcess]
    random: dict[str, Any]
    failed: Status | None

    def __repr__(self) -> str:
        return f"<state of {self.scenario.name} at {self.time:g} s>"

    def check_is_of(self, scenario: Scenario) -> None:
        """Raise ControlError if this is a state of another scenario."""
        if self.scenario is not scenario and self.scenario != scenario:
            keys = differing_keys(scenario_to_dict(self.scenario), scenario_to_dict(scenario))
            raise ControlError(f"restore: the state is one of another scene: they differ in {keys}")
