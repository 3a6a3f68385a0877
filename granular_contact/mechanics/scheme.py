"""Spectral radius of generalised-alpha at infinite frequency, tolerance of Newton's method: what a scene decides."""

from __future__ import annotations

from granular_contact.mechanics.kernels.numerics import DAMPED_SPECTRAL_RADIUS, OF_ACCURACY, SPECTRAL_RADIUS, TOLERANCE
from granular_contact.scene.types import Scene


def spectral_radius(scene: Scene) -> float:
    """Of a scene whose config names none: lower where steps change or a signal prescribes a motion.

    Not of a single body in space that flies free, in which nothing oscillates: at 0.5 a thrown body's energy is out of
    balance by 2 to 3e-4 of it, at 0.9 by 1e-5. On a hinge what constraints leave of accelerations goes to and fro from
    step to step, and grows where steps shrink: at 0.9 steps went down to the shortest there is.
    """
    alone = scene.in_space and [joint.kind for joint in scene.joints if joint.kind != "weld"] == ["free"]
    damped = (scene.solver.accuracy is not None and not alone) or prescribed(scene)
    return DAMPED_SPECTRAL_RADIUS if damped else SPECTRAL_RADIUS


def prescribed(scene: Scene) -> bool:
    """Whether signals say how something moves."""
    return any(drive.kind == "motion" for drive in scene.drives)


def tolerance(scene: Scene) -> float:
    """What a step may leave of a residual, over the forces of the scene, whatever the accuracy."""
    named = scene.solver.tolerance
    return TOLERANCE if named is None else named


def tolerance_by_accuracy(scene: Scene) -> float:
    """`tolerance`, where the config names none by the accuracy for which steps are chosen."""
    solver = scene.solver
    if solver.tolerance is not None or solver.accuracy is None:
        return tolerance(scene)
    return OF_ACCURACY * solver.accuracy
