"""Inertia tensors: whether a body can have one; rotating, moving and combining them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from granular_contact.robot.types import Inertial, Pose, Vector

ROUNDING = 2e-3  # relative to the largest moment: URDF files give three or four digits
NEGLIGIBLE = 1e-6  # relative to the largest moment


def impossibility(tensor: Vector) -> str | None:
    """Sentence on why no body can have this inertia (3, 3) kg m^2 about its centre of mass; None if one can."""
    low, middle, high = np.linalg.eigvalsh(tensor)
    shown = ", ".join(f"{moment:.4g}" for moment in (low, middle, high))
    if low <= 0.0:
        return f"got the principal moments {shown} kg m^2; allowed are numbers above 0"
    if low + middle < (1.0 - ROUNDING) * high:
        return (
            f"got the principal moments {shown} kg m^2, which no body has: "
            f"the two smaller add to {low + middle:.4g}, and must reach the largest"
        )
    return None


def with_raised_moments(tensor: Vector) -> Vector:
    """Raise the two smaller principal moments of a tensor (3, 3) until their sum is the largest moment.

    Both are multiplied by the same factor. If only the smallest is negligible, it becomes the difference of the other
    two. If both are negligible, each becomes half of the largest, as for a thin plate. The principal axes do not
    change, and a tensor that a body can have is returned unchanged.
    """
    moments, axes = np.linalg.eigh(tensor)
    low, middle, high = moments
    if low > 0.0 and low + middle >= high:
        return tensor
    if low > NEGLIGIBLE * high:
        moments[:2] *= high / (low + middle)
    elif middle > NEGLIGIBLE * high:
        moments[0] = max(high - middle, NEGLIGIBLE * high)
    else:
        moments[:2] = 0.5 * high
    raised: Vector = (axes * moments) @ axes.T
    return 0.5 * (raised + raised.T)


def rotated(tensor: Vector, rotation: Vector) -> Vector:
    """Transform a tensor (3, 3) to another frame; rotation (3, 3) takes vectors to that frame."""
    product: Vector = rotation @ tensor @ rotation.T
    return 0.5 * (product + product.T)


def moved(inertial: Inertial, pose: Pose) -> Inertial:
    """Transform mass properties to another frame, in which their frame has this pose."""
    turn = pose.rotation
    return Inertial(inertial.mass, pose.xyz + turn @ inertial.center, rotated(inertial.tensor, turn), inertial.line)


def combined(parts: Sequence[Inertial]) -> Inertial:
    """Mass properties of several parts together, all in one frame, by the parallel axis theorem."""
    mass = sum(part.mass for part in parts)
    center = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for part in parts:
        arm = part.center - center
        tensor = tensor + part.tensor + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertial(mass, center, tensor, parts[0].line)
