"""Range in which the coefficients of a medium were measured, and by how much a run leaves it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import AfterValidator, Field

from granular_contact.laws.coefficients import Coefficients
from granular_contact.values.strict import Listed, NotNegative, refusal


def _rising(interval: tuple[float, float]) -> tuple[float, float]:
    """Refuse an interval whose first number exceeds the second."""
    if interval[0] > interval[1]:
        raise refusal([((), f"got {list(interval)}; the first must not exceed the second")])
    return interval


Interval = Annotated[tuple[NotNegative, NotNegative], Listed, AfterValidator(_rising)]


class Validity(Coefficients):
    """Range in which the coefficients were measured; null: not stated. The summary of a run says if the run leaves it.

    Parameters
    ----------
    speed : pair of float, optional
        Least and greatest speed (m/s).
    depth : pair of float, optional
        Least and greatest depth (m).
    size : pair of float, optional
        Least and greatest diameter of bars and balls, or width of plates (m).
    """

    speed: Interval | None = Field(None, alias="speed_m_s")
    depth: Interval | None = Field(None, alias="depth_m")
    size: Interval | None = Field(None, alias="size_m")

    def departures(self, speed: float, depth: float, sizes: tuple[float, ...]) -> Iterator[str]:
        """Sentences on the quantities of a run that lie outside the range.

        A run that stops passes through all speeds and depths below its greatest ones, inside the range or not. So a
        lower bound counts as left only if the greatest value of the run does not reach it.

        Parameters
        ----------
        speed : float
            Greatest speed of the run (m/s).
        depth : float
            Greatest depth of the run (m).
        sizes : tuple of float
            Sizes (m) of the parts that met the medium.

        Yields
        ------
        str
            One sentence for each bound that the run leaves.
        """
        yield from _beyond("speed", speed, "m/s", self.speed)
        yield from _beyond("depth", depth, "m", self.depth)
        if sizes:
            yield from _beyond("size", min(sizes), "m", self.size, upper=False)
            yield from _beyond("size", max(sizes), "m", self.size, lower=False)


NOT_STATED = Validity()


def _beyond(
    quantity: str, value: float, unit: str, interval: Interval | None, *, lower: bool = True, upper: bool = True
) -> Iterator[str]:
    """Sentences on a value outside its interval; lower, upper: which of the two bounds are looked at."""
    if interval is None:
        return
    low, high = interval
    if upper and value > high:
        yield f"{quantity} {value:.4g} {unit} is {_share(value, high)} the greatest stated, {high:g} {unit}"
    if lower and value < low:
        yield f"{quantity} {value:.4g} {unit} is {low - value:.2g} {unit} below the least stated, {low:g} {unit}"


def _share(value: float, limit: float) -> str:
    """Ratio of a value to a limit, in words."""
    return f"{value / limit:.2f} times" if limit > 0.0 else "above"
