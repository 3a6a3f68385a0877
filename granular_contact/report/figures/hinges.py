"""The hinges of a run, by its columns."""

from __future__ import annotations

from dataclasses import dataclass

from granular_contact.results import Results

_ANGLE, _RATE = "_angle_deg", "_rate_rad_s"


@dataclass(frozen=True)
class Hinge:
    """A hinge by name; `reference` is the body that its angle and rate are relative to, None if that is the ground."""

    name: str
    reference: str | None

    @property
    def angle(self) -> str:
        """Column of its angle."""
        return self.name + _ANGLE

    @property
    def rate(self) -> str:
        """Column of its angular rate."""
        return self.name + _RATE

    @property
    def label(self) -> str:
        """Its name and, if it is not the ground, what it is relative to."""
        return self.name if self.reference is None else f"{self.name}, relative to {self.reference}"


def hinges_of(results: Results) -> list[Hinge]:
    """The hinges, in the order of the columns."""
    names = {column.name for column in results.columns}
    found = []
    for column in results.columns:
        name = column.name.removesuffix(_ANGLE)
        if name != column.name and name + _RATE in names:
            _, _, reference = column.description.partition("relative to ")
            found.append(Hinge(name, reference.split(",")[0] or None))
    return found
