"""An assembled system in space: as in the plane, with the bodies and joint loads of space."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from granular_contact.mechanics.system import RigidHandle, System, Trajectory
from granular_contact.scene.space.types import SpatialRigidBody, SpatialScene

if TYPE_CHECKING:
    from granular_contact.mechanics.sensors import Sensors
    from granular_contact.mechanics.space.kinematics import SpatialKinematics
    from granular_contact.results.observation import Observation
    from granular_contact.sand.space.load import SpatialLoad


@dataclass(frozen=True)
class SpatialSystem(System):
    """As `System`."""

    scene: SpatialScene
    rigid: dict[str, RigidHandle[SpatialRigidBody]]  # type: ignore[assignment]

    @cached_property
    def facets(self) -> SpatialLoad:
        """The load with the facets of its bodies, by which their error is found: see `facet_departure.load_with`."""
        from granular_contact.mechanics.space.facet_departure import load_with

        return load_with(self, 1.0)

    def sensors(self) -> Sensors:
        """As of `System`."""
        from granular_contact.mechanics.space.sensors import SpatialSensors

        return SpatialSensors(self, None if self.bed is None else self.bed.load)

    def kinematics(self, trajectory: Trajectory) -> SpatialKinematics:
        """As of `System`."""
        from granular_contact.mechanics.space.kinematics import SpatialKinematics

        return SpatialKinematics(self, trajectory)

    def observe(self, trajectory: Trajectory) -> Observation:
        """As of `System`."""
        from granular_contact.mechanics.space.observe import observe

        return observe(self, trajectory)
