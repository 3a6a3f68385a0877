"""An assembled system in space: as in the plane, with the bodies and joint loads of space."""

from __future__ import annotations

from dataclasses import dataclass

from granular_contact.multibody.system import System
from granular_contact.scene.space.types import SpatialRigidBody, SpatialScene


@dataclass(frozen=True)
class SpatialHandle:
    """Exudyn numbers of a rigid body, and its body."""

    body: SpatialRigidBody
    node: int
    object: int


@dataclass(frozen=True)
class SpatialSystem(System):
    """As `System`."""

    scene: SpatialScene
    rigid: dict[str, SpatialHandle]  # type: ignore[assignment]
