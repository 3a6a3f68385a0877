"""State of a simulation at one instant, to go back to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from granular_contact.config import Scenario, scenario_to_dict
from granular_contact.config.differences import differing_keys
from granular_contact.errors import ControlError
from granular_contact.results import Status
from granular_contact.scene.drives import Beyond


@dataclass(frozen=True, repr=False)
class State:
    """State of a simulation at one instant, to go back to; it can be pickled.

    time (s); scenario: of whose scene it is; solve: of the solver; controls: what is set, in SI units; beyond: see
    `Beyond`, by joint; random: of the generator; failed: why a controller ended the run, None where none did.
    """

    time: float
    scenario: Scenario
    solve: Any
    controls: tuple[float, ...]
    beyond: dict[str, Beyond]
    random: dict[str, Any]
    failed: Status | None

    def __repr__(self) -> str:
        return f"<state of {self.scenario.name} at {self.time:g} s>"

    def check_is_of(self, scenario: Scenario) -> None:
        """Raise ControlError where it is a state of another scenario."""
        if self.scenario is not scenario and self.scenario != scenario:
            keys = differing_keys(scenario_to_dict(self.scenario), scenario_to_dict(scenario))
            raise ControlError(f"restore: the state is one of another scene: they differ in {keys}")
