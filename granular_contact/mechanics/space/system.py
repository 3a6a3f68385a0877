"""A mechanism in space in the generalised coordinates of an engine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from granular_contact.mechanics.system import RigidHandle, System, Trajectory
from granular_contact.scene.space.types import SpatialRigidBody, SpatialScene

if TYPE_CHECKING:
    from granular_contact.mechanics.sensors import Sensors
    from granular_contact.mechanics.space.kinematics import SpatialKinematics
    from granular_contact.results.observation import Observation
    from granular_contact.sand.space.elements import Elements
    from granular_contact.sand.space.load import SpatialLoad


@dataclass(frozen=True)
class SpatialSystem(System):
    """System in space, see `System`. elements: of the parts on which the medium acts."""

    scene: SpatialScene
    rigid: dict[str, RigidHandle[SpatialRigidBody]]  # type: ignore[assignment]
    elements: Sequence[Elements] = ()

    @cached_property
    def facets(self) -> SpatialLoad:
        """Load with the facets of the bodies, for estimates of their error: see `facet_departure.load_with`."""
        from granular_contact.mechanics.space.facet_departure import load_with

        return load_with(self)

    def sensors(self) -> Sensors:
        """Sensors that read the state in the pauses of a solve."""
        from granular_contact.mechanics.space.sensors import SpatialSensors

        return SpatialSensors(self, None if self.bed is None else self.bed.load)

    def kinematics(self, trajectory: Trajectory) -> SpatialKinematics:
        """Kinematics of the system along a trajectory."""
        from granular_contact.mechanics.space.kinematics import SpatialKinematics

        return SpatialKinematics(self, trajectory)

    def observe(self, trajectory: Trajectory) -> Observation:
        """Observation of a run, from which its results are made."""
        from granular_contact.mechanics.space.observe import observe

        return observe(self, trajectory)
