"""Second stage: a scenario's names resolved, its geometry laid out and checked."""

from granular_contact.scene.build import build
from granular_contact.scene.types import Scene

__all__ = ["Scene", "build"]
