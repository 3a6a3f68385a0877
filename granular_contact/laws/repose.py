"""Slopes that are steeper than the angle of repose of a medium.

On an infinite slope steeper than that the grains slide at any depth, whatever the gravity. Layers follow the surface,
so the condition holds for every layer.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from granular_contact.laws.law import Law

ROUND_OFF = 1e-6  # deg


def least_repose(media: Iterable[Law]) -> Law | None:
    """Medium with the smallest angle of repose.

    Parameters
    ----------
    media : iterable of Law
        The media of a bed.

    Returns
    -------
    Law or None
        None if no medium states its angle.
    """
    known = [medium for medium in media if medium.angle_of_repose is not None]
    return min(known, key=lambda medium: medium.angle_of_repose or 0.0, default=None)


def slope_faults(media: Iterable[Law], slope: float) -> Iterator[str]:
    """Fault of a bed whose slope is steeper than the angle of repose.

    Parameters
    ----------
    media : iterable of Law
        The media of the bed.
    slope : float
        Slope (deg); its sign does not matter.

    Yields
    ------
    str
        One sentence if the media do not rest on the slope.
    """
    medium = least_repose(media)
    if medium is not None and medium.angle_of_repose is not None and abs(slope) > medium.angle_of_repose + ROUND_OFF:
        yield (
            f"got {abs(slope):.4g} deg, but the angle of repose of {medium.name} is {medium.angle_of_repose:g} deg: "
            "allowed is no more, or the angle_of_repose_deg of your own in the medium; null: it is not known"
        )


def slope_notes(media: Iterable[Law], slopes: Iterable[tuple[float, float]]) -> Iterator[str]:
    """Note on the pieces of a surface that are steeper than the angle of repose.

    Parameters
    ----------
    media : iterable of Law
        The media of the bed.
    slopes : iterable of tuple of float
        Rise per length of each piece, and its length (m) or area (m2).

    Yields
    ------
    str
        One sentence if a piece is too steep.
    """
    medium = least_repose(media)
    if medium is None or medium.angle_of_repose is None:
        return
    pieces = [(math.degrees(math.atan(abs(rise))), size) for rise, size in slopes]
    steep = [piece for piece in pieces if piece[0] > medium.angle_of_repose + ROUND_OFF]
    if steep:
        share = sum(size for _, size in steep) / sum(size for _, size in pieces)
        yield (
            f"{100.0 * share:.2g} % of the surface is up to {max(steep)[0]:.4g} deg steep, but the angle of repose of "
            f"{medium.name} is {medium.angle_of_repose:g} deg: there it would slide, which is left out"
        )
