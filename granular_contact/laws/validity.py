"""Where a medium's coefficients were measured, and by how much a run left that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import Listed, NotNegative, refusal


def _rising(interval: tuple[float, float]) -> tuple[float, float]:
    if interval[0] > interval[1]:
        raise refusal([((), f"got {list(interval)}; the first must not exceed the second")])
    return interval


Interval = Annotated[tuple[NotNegative, NotNegative], Listed, AfterValidator(_rising)]


class Validity(Coefficients):
    """Where the coefficients were measured; null: not stated. A run that leaves it says so in its summary.

    Parameters
    ----------
    speed : pair of float, optional
        Least and greatest (m/s).
    depth : pair of float, optional
        Least and greatest (m).
    size : pair of float, optional
        Diameter of bars and balls, width of plates: least and greatest (m).
    """

    speed: Interval | None = Field(None, alias="speed_m_s")
    depth: Interval | None = Field(None, alias="depth_m")
    size: Interval | None = Field(None, alias="size_m")

    def departures(self, speed: float, depth: float, sizes: tuple[float, ...]) -> Iterator[str]:
        """Sentences on what lies outside: greatest speed and depth of a run, sizes of the parts that met the medium.

        A run that stops passes through all speeds and depths below its greatest, inside the range or not, so a low end
        is left only by a run whose greatest does not come up to it.
        """
        yield from _beyond("speed", speed, "m/s", self.speed)
        yield from _beyond("depth", depth, "m", self.depth)
        if sizes:
            yield from _beyond("size", min(sizes), "m", self.size, upper=False)
            yield from _beyond("size", max(sizes), "m", self.size, lower=False)


NOT_STATED = Validity()


def _beyond(
    what: str, value: float, unit: str, interval: Interval | None, *, lower: bool = True, upper: bool = True
) -> Iterator[str]:
    if interval is None:
        return
    low, high = interval
    if upper and value > high:
        yield f"{what} {value:.4g} {unit} is {_share(value, high)} the greatest stated, {high:g} {unit}"
    if lower and value < low:
        yield f"{what} {value:.4g} {unit} is {low - value:.2g} {unit} below the least stated, {low:g} {unit}"


def _share(value: float, limit: float) -> str:
    return f"{value / limit:.2f} times" if limit > 0.0 else "above"
