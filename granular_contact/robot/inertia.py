"""Tensors of inertia: whether a body can have one; turned and moved to another frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from granular_contact.robot.types import Inertial, Pose, Vector

ROUNDING = 2e-3  # of the largest moment: URDF files give three or four digits
NEGLIGIBLE = 1e-6  # of the largest moment


def impossible(tensor: Vector) -> str | None:
    """Why no body has this inertia (3, 3) kg m^2 about its centre of mass, as a sentence; None if one can."""
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


def raised(tensor: Vector) -> Vector:
    """The tensor (3, 3) with its two smaller principal moments raised until they reach the largest, where they do not.

    Both are multiplied by the same number; where one is not above 0 it gets what the other lacks, and where both are
    nothing each gets half, as of a thin plate. Its axes stay, and a tensor that a body can have stays as it is.
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
    found: Vector = (axes * moments) @ axes.T
    return 0.5 * (found + found.T)


def turned(tensor: Vector, rotation: Vector) -> Vector:
    """A tensor (3, 3) of one frame in another, of which `rotation` takes vectors from the first."""
    found: Vector = rotation @ tensor @ rotation.T
    return 0.5 * (found + found.T)


def moved(inertial: Inertial, pose: Pose) -> Inertial:
    """Mass properties in the frame in which their own has a pose."""
    turn = pose.rotation
    return Inertial(inertial.mass, pose.xyz + turn @ inertial.center, turned(inertial.tensor, turn), inertial.line)


def added(parts: Sequence[Inertial]) -> Inertial:
    """Mass properties of several parts in one frame together, by Steiner's theorem."""
    mass = sum(part.mass for part in parts)
    center = sum((part.mass * part.center for part in parts), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for part in parts:
        arm = part.center - center
        tensor = tensor + part.tensor + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertial(mass, center, tensor, parts[0].line)
