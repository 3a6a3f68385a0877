"""Spectral radius of generalised-alpha at infinite frequency, and tolerance of Newton's method, for a scene."""

from __future__ import annotations

from granular_contact.mechanics.kernels.numerics import DAMPED_SPECTRAL_RADIUS, OF_ACCURACY, SPECTRAL_RADIUS, TOLERANCE
from granular_contact.scene.types import Scene


def spectral_radius(scene: Scene) -> float:
    """Default spectral radius: lower where the step size is controlled or a signal prescribes a motion.

    A single free-flying body in space keeps the high one, because nothing in it oscillates: the relative energy
    imbalance of a thrown body is 2 to 3e-4 at 0.5, and 1e-5 at 0.9. A body on a hinge gets the low one: the errors of
    constraints make its accelerations alternate from step to step, the more the shorter the steps are. At 0.9 the steps
    went down to the shortest one.
    """
    alone = scene.in_space and [joint.kind for joint in scene.joints if joint.kind != "weld"] == ["free"]
    damped = (scene.solver.accuracy is not None and not alone) or prescribed(scene)
    return DAMPED_SPECTRAL_RADIUS if damped else SPECTRAL_RADIUS


def prescribed(scene: Scene) -> bool:
    """Return whether signals prescribe motions of joints."""
    return any(drive.kind == "motion" for drive in scene.drives)


def tolerance(scene: Scene) -> float:
    """Residual allowed at the end of a step over the forces of the scene: `solver.tolerance`, or the default."""
    given = scene.solver.tolerance
    return TOLERANCE if given is None else given


def tolerance_by_accuracy(scene: Scene) -> float:
    """As `tolerance`, but proportional to the accuracy of step-size control where the config gives no tolerance."""
    solver = scene.solver
    if solver.tolerance is not None or solver.accuracy is None:
        return tolerance(scene)
    return OF_ACCURACY * solver.accuracy
