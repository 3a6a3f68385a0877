"""What every medium says about its numbers: where they come from, what they rest on, where they were measured."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import AfterValidator

from granular_contact.values.strict import Listed, NotNegative, Strict, Text, refusal


def _rising(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise refusal([((), f"got {list(interval)}; the first must not exceed the second")])
    return interval


Interval = Annotated[tuple[NotNegative, NotNegative], Listed, AfterValidator(_rising)]


class Range(Strict):
    """Where the coefficients were measured; null: not stated. A run that leaves it says so in its summary."""

    speed_m_s: Interval | None = None
    depth_m: Interval | None = None
    size_m: Interval | None = None
    """Diameter of bars and balls, width of plates."""


class MediumBase(Strict):
    """Keys that every medium has."""

    name: Text | None = None
    source: Text | None = None
    """Where the coefficients come from."""
    standing: Text | None = None
    """What they rest on, as `two or more independent sources`."""
    provenance: Literal["published", "fitted", "own"] | None = None
    range: Range = Range()
