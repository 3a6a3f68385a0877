"""Spectral radius of generalised-alpha at infinite frequency, and what of a scene decides on it."""

from __future__ import annotations

from granular_contact.mechanics.kernels.numerics import DAMPED_SPECTRAL_RADIUS, SPECTRAL_RADIUS
from granular_contact.scene.types import Scene


def spectral_radius(scene: Scene) -> float:
    """Of a scene whose config names none: lower where steps change or a signal prescribes a motion."""
    damped = scene.solver.accuracy is not None or prescribed(scene)
    return DAMPED_SPECTRAL_RADIUS if damped else SPECTRAL_RADIUS


def prescribed(scene: Scene) -> bool:
    """Whether signals say how something moves."""
    return any(drive.kind == "motion" for drive in scene.drives)
