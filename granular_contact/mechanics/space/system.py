"""An assembled system in space: as in the plane, with the bodies and joint loads of space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from granular_contact.mechanics.system import RigidHandle, System
from granular_contact.scene.space.types import SpatialRigidBody, SpatialScene

if TYPE_CHECKING:
    from granular_contact.mechanics.senses import Senses


@dataclass(frozen=True)
class SpatialSystem(System):
    """As `System`."""

    scene: SpatialScene
    rigid: dict[str, RigidHandle[SpatialRigidBody]]  # type: ignore[assignment]

    def senses(self) -> Senses:
        """As of `System`."""
        from granular_contact.mechanics.space.senses import SpatialSenses

        return SpatialSenses(self, None if self.bed is None else self.bed.load)
