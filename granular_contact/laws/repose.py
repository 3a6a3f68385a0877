"""Slopes that a medium does not keep: those steeper than its angle of repose.

On a slope without end the grains at any depth slide where it is steeper, whatever the gravity; so this holds for every
layer, as layers follow the surface.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from granular_contact.laws.law import Law

ROUND_OFF = 1e-6  # deg


def gentlest(media: Iterable[Law]) -> Law | None:
    """The medium with the least angle of repose; None where none states its own."""
    known = [medium for medium in media if medium.angle_of_repose is not None]
    return min(known, key=lambda medium: medium.angle_of_repose or 0.0, default=None)


def steeper(media: Iterable[Law], slope: float) -> Iterator[str]:
    """Why media do not lie on a slope (deg), if they do not."""
    medium = gentlest(media)
    if medium is not None and medium.angle_of_repose is not None and abs(slope) > medium.angle_of_repose + ROUND_OFF:
        yield (
            f"got {abs(slope):.4g} deg, but the angle of repose of {medium.name} is {medium.angle_of_repose:g} deg: "
            "allowed is no more, or the angle_of_repose_deg of your own in the medium; null: it is not known"
        )


def steep_places(media: Iterable[Law], slopes: Iterable[tuple[float, float]]) -> Iterator[str]:
    """What is steeper than media lie of a surface of pieces; slopes: rise per length, and length or area of each."""
    medium = gentlest(media)
    if medium is None or medium.angle_of_repose is None:
        return
    pieces = [(math.degrees(math.atan(abs(rise))), size) for rise, size in slopes]
    steep = [one for one in pieces if one[0] > medium.angle_of_repose + ROUND_OFF]
    if steep:
        share = sum(size for _, size in steep) / sum(size for _, size in pieces)
        yield (
            f"{100.0 * share:.2g} % of the surface is up to {max(steep)[0]:.4g} deg steep, but the angle of repose of "
            f"{medium.name} is {medium.angle_of_repose:g} deg: there it would slide, which is left out"
        )
